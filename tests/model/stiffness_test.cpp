/// Low speed on every surface: the pole of the free-rolling wheel runs away from the step.
#include <cmath>

#include "tests/catch.hpp"
#include "tests/model/reference/comparison.hpp"
#include "tests/model/scenarios.hpp"

namespace {

/// d(omega_dot)/d(omega) at zero slip.
double pole_per_s(const rig::RigParameters& rig, double v) {
    const double F_z = rig.load.base_N - rig.load.lift_Ns2pm2 * v * v;
    const double r = rig.wheel.free_radius_m - F_z / rig.wheel.stiffness_Npm;
    const double mu_1 = rig.surface.c1 * rig.surface.c2 - rig.surface.c3;
    return -F_z * r * r * mu_1 / (rig.wheel.inertia_kgm2 * v);
}

}  // namespace

TEST_CASE("low speed: accurate at 1 ms and 5 ms on every surface", "[RIG-001]") {
    double fastest_pole = 0.0;
    for (const NamedScenario& s : all_scenarios()) {
        for (const double start_mps : {5.5, 2.0}) {
            for (const double step_s : {1e-3, 5e-3}) {
                rig::RigParameters rig = s.loaded.rig;
                rig.brake_on_mps = start_mps;
                fastest_pole = std::min(fastest_pole, pole_per_s(rig, start_mps));
                const double peak = min_peak_pressure_Pa(rig);
                CAPTURE(s.name, start_mps, step_s, peak);
                reference::Options options;
                options.until_mps = 1.0;
                options.longest_s = 3.0;
                const reference::Profile steps{{0.0, 0.0}, {0.05, 0.0}, {0.05, 0.5 * peak}, {0.1, 0.5 * peak}, {0.1, 0.1 * peak}, {0.15, 0.8 * peak}};
                const Comparison c = compare(rig, reference::Input::pressure, steps, step_s, options);
                CHECK(c.v <= 1e-4);
                CHECK(c.omega <= 1e-4);
                CHECK(c.residual <= 1e-6);
            }
        }
    }
    CHECK(fastest_pole < -5e4);
}

TEST_CASE("low speed: a disturbed wheel returns to its slip without oscillation", "[RIG-001]") {
    for (const NamedScenario& s : all_scenarios()) {
        const rig::RigParameters& rig = s.loaded.rig;
        plant::Wheel wheel(rig.wheel, plant::BrakeTorque(rig.brake, rig.friction_curve, rig.mean_friction, rig.brake_on_mps), rig.surface);
        const plant::LoadArc load{rig.load.base_N, 0.0, rig.load.lift_Ns2pm2};
        for (const double v : {5.5, 2.0}) {
            for (const double step_s : {1e-3, 5e-3}) {
                CAPTURE(s.name, v, step_s);
                const double r = wheel.forces({.v_mps = v}, 0.0, load).radius_m;
                plant::WheelState state;
                state.v_mps = v;
                state.omega_radps = 0.98 * v / r;
                state.held = false;
                double slip = 0.02;
                for (int i = 0; i < 20; ++i) {
                    wheel.advance(state, plant::PressureArc::linear(0.0, 0.0), load, step_s);
                    const double next = wheel.forces(state, 0.0, load).slip;
                    // Without a brake the slip dies away: it never grows and never changes its sign by more than the error allowed.
                    CHECK(std::abs(next) <= std::abs(slip) + 1e-9);
                    CHECK(next > -1e-5);
                    slip = next;
                }
                CHECK(std::abs(slip) < 1e-4);
            }
        }
    }
}
