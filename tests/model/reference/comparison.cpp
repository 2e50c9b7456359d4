#include "tests/model/reference/comparison.hpp"

#include <algorithm>
#include <cmath>

#include "plant_sim/model/open_loop.hpp"

namespace {

double radius_m(const rig::RigParameters& rig, double v) {
    const double F_z = rig.load.base_N - rig.load.lift_Ns2pm2 * v * v;
    return rig.wheel.free_radius_m - F_z / rig.wheel.stiffness_Npm;
}

}  // namespace

Comparison compare(const rig::RigParameters& parameters, reference::Input input, const reference::Profile& profile, double step_s,
                   const reference::Options& options) {
    rig::RigParameters direct = parameters;
    // The reference knows static pressures; here current means pressure, 1 mA a pascal.
    direct.pressure_map = rig::PressureMap({{0.0, 0.0}, {1e8, 1e8}});
    plant::Rig rig(direct, step_s, 1);
    if (options.from_rest)
        rig.touch_down();
    else
        rig.start_rolling();
    if (input == reference::Input::pressure) rig.start_pressure(profile.front().value);
    const double start_J = rig.kinetic_energy_J();
    const auto relative = [](double value, double truth) { return std::abs(value - truth) / std::abs(truth); };

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
        worst.energy = std::max(
            {worst.energy, std::abs(w.energy_brake_J - truth.energy_brake_J) / start_J, std::abs(w.energy_tyre_J - truth.energy_tyre_J) / start_J});
        const double lost_J = start_J - rig.kinetic_energy_J();
        worst.residual = std::max(worst.residual, std::abs(lost_J - w.energy_brake_J - w.energy_tyre_J) / start_J);
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

Comparison compare_open_loop(const rig::RigParameters& parameters, reference::Input input, const reference::Profile& profile,
                             const reference::Options& options, double tolerance) {
    std::vector<plant::OpenLoop::Point> points;
    points.reserve(profile.size());
    for (const reference::Knot& knot : profile) points.push_back({knot.time_s, knot.value});
    plant::OpenLoop plant(parameters, input == reference::Input::valve ? plant::OpenLoop::Input::valve : plant::OpenLoop::Input::pressure, points,
                          tolerance);
    const auto kinetic_J = [&](const plant::WheelState& w) {
        return 0.5 * parameters.wheel.mass_kg * w.v_mps * w.v_mps + 0.5 * parameters.wheel.inertia_kgm2 * w.omega_radps * w.omega_radps;
    };
    const double start_J = kinetic_J(plant.wheel());
    Comparison worst;
    const auto judge = [&](const reference::Motion& truth) {
        while (plant.time_s() < truth.time_s && plant.step(options.longest_s)) {
            const plant::WheelState& w = plant.wheel();
            const double residual = (start_J - kinetic_J(w) - w.energy_brake_J - w.energy_tyre_J) / start_J;
            worst.residual = std::max(worst.residual, std::abs(residual));
        }
        const plant::OpenLoop::Sample sample = plant.at(truth.time_s);
        const double rolling = truth.v_mps / radius_m(parameters, truth.v_mps);
        if (truth.time_s == 0.0) return;
        worst.v = std::max(worst.v, std::abs(sample.v_mps / truth.v_mps - 1.0));
        worst.omega = std::max(worst.omega, std::abs(sample.omega_radps - truth.omega_radps) / rolling);
        worst.locked = worst.locked || truth.held;
    };
    reference::integrate(parameters, input, profile, options, judge);
    return worst;
}
