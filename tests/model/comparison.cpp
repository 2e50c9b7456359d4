#include "tests/model/comparison.hpp"

#include <algorithm>
#include <cmath>

namespace {

double radius_m(const plant::RigParameters& rig, double v) {
    const double F_z = rig.load.base_N - rig.load.lift_Ns2pm2 * v * v;
    return rig.wheel.free_radius_m - F_z / rig.wheel.stiffness_Npm;
}

}  // namespace

Comparison compare(const plant::RigParameters& parameters, reference::Input input,
                   const reference::Profile& profile, double step_s, const reference::Options& options) {
    plant::RigParameters direct = parameters;
    // The reference knows static pressures; here current means pressure, 1 mA a pascal.
    direct.pressure_map = plant::PressureMap({{0.0, 0.0}, {1e8, 1e8}});
    plant::Rig rig(direct, step_s, 1);
    if (options.from_rest)
        rig.touch_down();
    else
        rig.start_rolling();
    if (input == reference::Input::pressure) rig.start_pressure(profile.front().value);
    const double start_J = rig.kinetic_energy_J();
    const auto relative = [](double value, double truth) {
        return std::abs(value - truth) / std::abs(truth);
    };

    Comparison worst;
    double before_s = 0.0;
    reference::Options every_step = options;
    every_step.output_s = step_s;
    const auto judge = [&](const reference::Motion& truth) {
        if (truth.time_s > 0.0) {
            const double from = reference::value_after(profile, before_s);
            const double to = reference::value_before(profile, truth.time_s);
            if (input == reference::Input::pressure)
                rig.advance_pressure(from, to);
            else
                rig.advance_current(from, to);
        }
        before_s = truth.time_s;
        const plant::WheelState& w = rig.wheel();
        const double rolling = truth.v_mps / radius_m(parameters, truth.v_mps);
        worst.v = std::max(worst.v, relative(w.v_mps, truth.v_mps));
        worst.omega = std::max(worst.omega, std::abs(w.omega_radps - truth.omega_radps) / rolling);
        worst.energy = std::max({worst.energy, std::abs(w.energy_brake_J - truth.energy_brake_J) / start_J,
                                 std::abs(w.energy_tyre_J - truth.energy_tyre_J) / start_J});
        const double lost_J = start_J - rig.kinetic_energy_J();
        worst.residual =
            std::max(worst.residual, std::abs(lost_J - w.energy_brake_J - w.energy_tyre_J) / start_J);
        if (truth.distance_m > 1.0) {
            worst.distance = relative(w.distance_m, truth.distance_m);
            worst.friction_distance = relative(w.friction_distance_m, truth.friction_distance_m);
        }
        worst.end_mps = truth.v_mps;
        if (truth.held && truth.time_s > 0.0) worst.locked = true;
        if (worst.locked && truth.omega_radps > 0.99 * rolling) worst.spun_up = true;
    };
    reference::integrate(parameters, input, profile, every_step, judge);
    return worst;
}
