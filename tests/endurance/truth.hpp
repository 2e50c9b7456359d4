/// What the tests of the composition share: a shipped scenario, ready to run.
#pragma once

#include "plant_sim/endurance/setup.hpp"
#include "plant_sim/endurance/test_cell.hpp"

namespace endurance_test {

inline endurance::Setup setup(const std::string& scenario) {
    return endurance::load_setup("config/scenarios/" + scenario + ".toml", "config");
}

inline endurance::TestCell cell(const endurance::Setup& s, std::uint64_t seed = 1) {
    return {s.scenario, s.controller, s.layout, s.machinery, seed};
}

/// How far off the prescribed speed brake-on may come: the tolerance, by a reading that is noisy.
inline double held_to_mps(const endurance::Setup& s, const sequencer::Plan& plan) {
    return plan.speed_tolerance_mps + 3.0 * s.machinery.machinery.gauges.speed.noise;
}

}  // namespace endurance_test
