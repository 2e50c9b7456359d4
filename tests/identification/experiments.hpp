/// Experiments of the virtual rig, in process, as the identification reads them.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "firmware/can/layout.hpp"
#include "plant_sim/study/identification/recording.hpp"
#include "tests/endurance/truth.hpp"

namespace identification_test {

/// With a brake of nominal friction: that is the truth to find.
inline endurance::EnduranceSetup setup(const std::string& scenario) {
    endurance::EnduranceSetup s = endurance_test::setup(scenario);
    s.machinery.brake.reset();
    return s;
}

/// Rounded as the frames would; load cells every 10 ms, in the third period as the schedule has it.
inline identification::Recording record(const endurance::EnduranceSetup& setup, std::uint64_t seed) {
    const antiskid::can::Layout& layout = setup.layout;
    identification::Recording out{.name = setup.scenario.name, .period_s = static_cast<double>(setup.controller.period_s), .samples = {}};
    endurance::TestCell cell = endurance_test::cell(setup, seed);
    const auto seconds = [](antiskid::control::Time t) {
        constexpr double kResolution_s = 1e-7;
        return std::floor(static_cast<double>(t.count()) * 1e-9 / kResolution_s) * kResolution_s;
    };
    std::int64_t periods = 0;
    const endurance::Outcome outcome = cell.run(rig::plan(setup.scenario, seed, 1), [&](const endurance::Period& p) {
        identification::Sample s{.time_s = p.time_s,
                                 .phase = p.sample.maneuver_state.phase,
                                 .current_mA = p.current_mA,
                                 .pressure_Pa = layout.pressure_Pa.rounded(static_cast<double>(p.sample.pressure_Pa)),
                                 .wheel = {p.sample.wheel.edge_count, seconds(p.sample.wheel.edge_time)},
                                 .flywheel = {p.sample.flywheel.edge_count, seconds(p.sample.flywheel.edge_time)}};
        if (periods++ % 10 == 2) {
            s.cells_new = true;
            s.vertical_N = layout.load_cells.vertical_N.rounded(static_cast<double>(p.sample.load_cells.vertical_N));
            s.longitudinal_N = layout.load_cells.longitudinal_N.rounded(static_cast<double>(p.sample.load_cells.longitudinal_N));
        } else if (!out.samples.empty()) {
            s.vertical_N = out.samples.back().vertical_N;
            s.longitudinal_N = out.samples.back().longitudinal_N;
        }
        out.samples.push_back(s);
    });
    if (outcome.phase != rig::Phase::finished) throw std::runtime_error(setup.scenario.name + " was aborted");
    return out;
}

inline identification::KnownRig known(const endurance::EnduranceSetup& setup) {
    const rig::RigParameters& rig = setup.scenario.rig.rig;
    identification::KnownRig known{.wheel_teeth = rig.wheel_encoder.teeth,
                                   .flywheel_teeth = rig.flywheel_encoder.teeth,
                                   .flywheel_radius_m = rig.flywheel_radius_m,
                                   .mass_kg = rig.wheel.mass_kg,
                                   .stiffness_Npm = rig.wheel.stiffness_Npm,
                                   .brake_gain_m3 = rig.brake.gain_m3(),
                                   .gauge_range_Pa = rig.transducer.range_Pa,
                                   .map_currents = {}};
    for (const auto& point : rig.pressure_map.points()) known.map_currents.push_back(point.current_mA);
    return known;
}

}  // namespace identification_test
