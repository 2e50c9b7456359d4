/// Drive and drag on the bare plant: closed form off the rim, closed books everywhere.
#include <cmath>

#include "plant_sim/model/rig.hpp"
#include "tests/catch.hpp"
#include "tests/plc/operator.hpp"

namespace {

rig::RigParameters parameters() {
    return plc_test::loaded(plc::Bench::endurance).rig;
}

double residual_J(const plant::Rig& rig, double start_J) {
    return rig.kinetic_energy_J() + rig.wheel().energy_brake_J + rig.wheel().energy_tyre_J + rig.energy_drag_J() - rig.energy_drive_J() - start_J;
}

}  // namespace

TEST_CASE("a constant force accelerates the free flywheel uniformly, encoder included", "[RIG-200]") {
    const rig::RigParameters p = parameters();
    plant::Rig rig(p, 1e-3, 1);
    rig.start_at_rest();
    rig.set_outside_forces({.drive_N = 3000.0, .drag_N = 200.0});
    for (int i = 0; i < 10000; ++i) rig.advance_current(0.0);
    const double a = 2800.0 / p.wheel.mass_kg;
    CHECK(rig.wheel().v_mps == Approx(a * 10.0).epsilon(1e-12));
    CHECK(rig.wheel().distance_m == Approx(0.5 * a * 100.0).epsilon(1e-12));
    CHECK(rig.energy_drive_J() == Approx(3000.0 * 0.5 * a * 100.0).epsilon(1e-12));
    CHECK(rig.energy_drag_J() == Approx(200.0 * 0.5 * a * 100.0).epsilon(1e-9));
    CHECK(rig.wheel().omega_radps == 0.0);
    // The pick-up is blind at first; from then on every tooth counts, and the last one is where the motion says.
    const double teeth_per_m = p.flywheel_encoder.teeth / (2.0 * M_PI * p.flywheel_radius_m);
    const double unseen_mps = p.flywheel_encoder.slowest_edges_hz / teeth_per_m;
    const double unseen_m = unseen_mps * unseen_mps / (2.0 * a);
    const double edges = rig.wheel().distance_m * teeth_per_m;
    CHECK(rig.flywheel_encoder().edge_count() == Approx(edges - unseen_m * teeth_per_m).margin(1.5));
    const double last_edge_s = std::sqrt(2.0 * std::floor(edges) / teeth_per_m / a);
    CHECK(rig.flywheel_encoder().edge_time_s() == Approx(last_edge_s).margin(5.0 * p.flywheel_encoder.jitter_s));
}

TEST_CASE("drag stops flywheel and wheel, and never turns them back", "[RIG-200]") {
    plant::Rig rig(parameters(), 1e-3, 1);
    rig.start_rolling();
    rig.lift_off();
    const double start_J = rig.kinetic_energy_J();
    rig.set_outside_forces({.drive_N = 0.0, .drag_N = 5000.0, .wheel_drag_Nm = 40.0});
    for (int i = 0; i < 30000; ++i) {
        rig.advance_current(0.0);
        REQUIRE(rig.wheel().v_mps >= 0.0);
        REQUIRE(rig.wheel().omega_radps >= 0.0);
    }
    CHECK(rig.wheel().v_mps == 0.0);
    CHECK(rig.wheel().omega_radps == 0.0);
    CHECK(std::abs(residual_J(rig, start_J)) < 1e-6 * start_J);
}

TEST_CASE("the books close with drive, drag, brake and tyre at once", "[RIG-200]") {
    plant::Rig rig(parameters(), 1e-3, 1);
    rig.start_at_rest();
    double largest_J = 0.0;
    for (int i = 0; i < 60000; ++i) {
        const double t = i * 1e-3;
        const bool rim = t > 15.0 && (t < 40.0 || t > 45.0);
        if (rim)
            rig.touch_down();
        else
            rig.lift_off();
        rig.set_outside_forces(
            {.drive_N = t < 20.0 ? 2500.0 : 300.0, .drag_N = rig.wheel().v_mps > 0.0 ? 20.0 : 0.0, .wheel_drag_Nm = rim ? 0.0 : 2.0});
        rig.advance_current(t > 25.0 && t < 38.0 ? 15.0 : 0.0);
        largest_J = std::max(largest_J, rig.kinetic_energy_J());
        REQUIRE(std::abs(residual_J(rig, 0.0)) < 1e-6 * std::max(largest_J, 1e3));
    }
    CHECK(largest_J > 5e5);
    CHECK(rig.wheel().energy_brake_J > 1e5);
    CHECK(rig.wheel().energy_tyre_J > 1e4);
}

TEST_CASE("another load law acts with the device's own lag", "[RIG-200]") {
    const rig::RigParameters p = parameters();
    plant::Rig rig(p, 1e-3, 1);
    rig.start_rolling();
    const double from_N = rig.forces().F_z_N;
    rig.set_load(10e3, 1.5);
    double expected = from_N;
    for (int i = 0; i < 500; ++i) {
        // The set-point follows the speed of the step's start.
        const double v = rig.wheel().v_mps;
        expected += (10e3 - 1.5 * v * v - expected) * (1.0 - std::exp(-1e-3 / p.load.lag_s));
        rig.advance_current(0.0);
    }
    CHECK(rig.forces().F_z_N == Approx(expected).epsilon(1e-6));
    CHECK(from_N > 2.0 * expected);
}

TEST_CASE("another brake acts from the next step on", "[RIG-200]") {
    const rig::RigParameters p = parameters();
    plant::Rig rig(p, 1e-3, 1);
    rig.start_rolling();
    for (int i = 0; i < 500; ++i) rig.advance_current(15.0);
    const double before = rig.forces().brake_torque_Nm / rig.pressure_Pa();
    rig.set_brake(0.2, p.brake_on_mps);
    const double after = rig.forces().brake_torque_Nm / rig.pressure_Pa();
    const double gain_m3 = p.brake.gain_m3();
    CHECK(before - after == Approx((p.mean_friction - 0.2) * gain_m3).epsilon(1e-9));
    CHECK_THROWS_AS(rig.set_brake(0.01, p.brake_on_mps), std::invalid_argument);
    CHECK_THROWS_AS(rig.set_brake(0.2, 0.0), std::invalid_argument);
    CHECK_THROWS_AS(rig.set_brake(std::nan(""), 50.0), std::invalid_argument);
}

TEST_CASE("idle time at once is idle time step by step", "[RIG-200]") {
    const rig::RigParameters p = parameters();
    const plant::Drag drag{.bearing_N = 5.0, .windage_Ns2pm2 = 0.004};
    plant::Rig steps(p, 1e-3, 1);
    plant::Rig jump(p, 1e-3, 1);
    for (plant::Rig* rig : {&steps, &jump}) {
        rig->start_at_rest();
        rig->set_outside_forces({.drive_N = 2000.0});
        for (int i = 0; i < 10000; ++i) rig->advance_current(0.0);
        CHECK_FALSE(rig->idle());
        rig->set_outside_forces({});
    }
    REQUIRE(jump.idle());
    for (int i = 0; i < 50000; ++i) {
        steps.set_outside_forces({.drive_N = 0.0, .drag_N = drag.force_N(steps.wheel().v_mps)});
        steps.advance_current(0.0);
    }
    jump.pass_idle(50.0, drag);
    CHECK(jump.time_s() == steps.time_s());
    CHECK(jump.wheel().v_mps == Approx(steps.wheel().v_mps).epsilon(1e-7));
    CHECK(jump.wheel().distance_m == Approx(steps.wheel().distance_m).epsilon(1e-7));
    CHECK(jump.energy_drag_J() == Approx(steps.energy_drag_J()).epsilon(1e-6));
    CHECK(jump.flywheel_encoder().edge_count() == Approx(steps.flywheel_encoder().edge_count()).margin(1.0));
    CHECK(jump.flywheel_encoder().edge_time_s() == Approx(steps.flywheel_encoder().edge_time_s()).margin(5e-3));
    SECTION("a rig that is not idle lets no time pass") {
        jump.touch_down();
        const double before_s = jump.time_s();
        jump.pass_idle(1.0, drag);
        CHECK(jump.time_s() == before_s);
    }
}
