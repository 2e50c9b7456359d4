#pragma once

#include <string>

#include "plant_sim/scenario/stop_options.hpp"

namespace margins_test {

[[nodiscard]] inline plant_sim::StopInputs scenario(const std::string& surface, const std::string& maneuver = "light") {
    plant_sim::StopOptions o;
    o.choice.surface = surface;
    o.choice.maneuver = maneuver;
    return plant_sim::load_scenario(o);
}

}  // namespace margins_test
