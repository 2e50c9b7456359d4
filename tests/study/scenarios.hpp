/// The 32 reference scenarios (8 surfaces x 4 maneuvers) from config/, and how the tests run one.
#pragma once

#include <string>
#include <vector>

#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/in_process.hpp"

namespace scenarios {

inline const std::filesystem::path kConfig = "config";

struct Name {
    std::string surface;
    std::string maneuver;
};

inline std::vector<Name> all() {
    std::vector<Name> names;
    for (const std::string& surface : rig::surface_names(kConfig)) {
        for (const std::string& maneuver : rig::maneuver_names(kConfig)) names.push_back({surface, maneuver});
    }
    return names;
}

inline plant_sim::StopOptions options(const Name& name, const std::string& law = "slip") {
    plant_sim::StopOptions o;
    o.config = kConfig;
    o.choice.surface = name.surface;
    o.choice.maneuver = name.maneuver;
    o.law = law;
    return o;
}

inline study::RunResult run(const plant_sim::StopOptions& o, study::Link link = study::Link::rounded, const study::StepObserver& on_step = {},
                            const study::FrameObserver& on_frame = {}) {
    const plant_sim::StopInputs s = plant_sim::load_scenario(o);
    return study::run_in_process(s.controller, s.layout, s.plant.rig, s.session, link, on_step, on_frame);
}

}  // namespace scenarios
