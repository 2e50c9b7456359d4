/// What the tests of the composition share: a shipped scenario, ready to run.
#pragma once

#include "plant_sim/endurance/endurance_setup.hpp"
#include "plant_sim/endurance/test_cell.hpp"

namespace endurance_test {

inline endurance::EnduranceSetup setup(const std::string& scenario) {
    return endurance::load_setup("config/scenarios/" + scenario + ".toml", "config");
}

inline endurance::TestCell cell(const endurance::EnduranceSetup& s, std::uint64_t seed = 1) {
    return {s.scenario, s.controller, s.layout, s.machinery, seed};
}

/// How far off the prescribed speed brake-on may come: the tolerance, by a reading that is noisy.
inline double held_to_mps(const endurance::EnduranceSetup& s, const rig::Plan& plan) {
    return plan.speed_tolerance_mps + 3.0 * s.machinery.machinery.gauges.speed.noise;
}

}  // namespace endurance_test
