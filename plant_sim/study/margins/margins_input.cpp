#include "plant_sim/study/margins/margins_input.hpp"

#include "firmware/host/settings/hash.hpp"

namespace study::margins {

MarginsInput load_margins_input(const plant_sim::StopOptions& options) {
    const std::filesystem::path file = options.config / "margins.toml";
    MarginsInput input{.settings = load_margins_settings(file), .scenarios = {}, .cases = {}, .config_hash = {}};
    for (const std::string& surface : rig::surface_names(options.config)) {
        for (const std::string& maneuver : rig::maneuver_names(options.config)) {
            plant_sim::StopOptions one = options;
            one.choice.surface = surface;
            one.choice.maneuver = maneuver;
            plant_sim::StopInputs& s = input.scenarios.emplace_back(plant_sim::load_scenario(one));
            input.cases.push_back({.surface = surface,
                                   .maneuver = maneuver,
                                   .rig = s.plant.rig,
                                   .drop_out_mps = s.plant.drop_out_mps,
                                   .full_pressure_Pa = s.plant.full_pressure_Pa});
        }
    }
    std::vector<std::filesystem::path> files = input.scenarios.front().plant.files;
    files.push_back(options.controller.empty() ? options.config / "controller.toml" : options.controller);
    files.push_back(file);
    input.config_hash = settings::hash(files);
    return input;
}

}  // namespace study::margins
