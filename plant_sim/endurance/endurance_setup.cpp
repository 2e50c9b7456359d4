#include "plant_sim/endurance/endurance_setup.hpp"

#include <vector>

#include "firmware/can/load_layout.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/settings/hash.hpp"
#include "plant_sim/plc/load_served_rig.hpp"

namespace endurance {

EnduranceSetup load_setup(const std::filesystem::path& scenario, const std::filesystem::path& config) {
    const rig::Scenario loaded = rig::load_scenario(scenario, config);
    const auto dbc = config / "antiskid.dbc";
    const auto binding = config / "antiskid_binding.toml";
    std::vector<std::filesystem::path> files = loaded.files;
    plc::ServedRigOptions machinery = plc::load_served_rig(config, loaded.endurance() ? plc::Bench::endurance : plc::Bench::landing);
    machinery.brake.emplace(loaded.rig.wear, wear::ConditionalRule{}, wear::BrakeState{});
    files.insert(files.end(), {loaded.controller, plc::machinery_file(config), dbc, binding});
    return {.scenario = loaded,
            .controller = antiskid::load_controller_config(loaded.controller),
            .layout = antiskid::can::load_layout(dbc, binding),
            .machinery = machinery,
            .config_hash = settings::hash(files)};
}

}  // namespace endurance
