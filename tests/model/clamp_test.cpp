/// The clamping of a brake against closed forms, and its wheel against short steps.
#include "plant_sim/model/clamp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "plant_sim/model/rig.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "tests/catch.hpp"

namespace {

/// Clamping pressure after the brake's pressure went to `to_Pa`, wheel at rest.
double follow(plant::Clamp& clamp, double to_Pa) {
    return clamp.follow(plant::PressureArc::linear(0.0, to_Pa), 0.0, 0.0).at(1.0);
}

constexpr rig::Clamping kAll{.contact_Pa = 1e6, .piston_friction = 0.05, .run_out = 0.08, .warp = 0.03};

rig::RigParameters landing(const rig::Clamping& clamping) {
    rig::RigParameters parameters = rig::load_rig("config", {}).rig;
    parameters.clamping = clamping;
    return parameters;
}

struct Stop {
    double distance_m, brake_J, residual;
};

/// From 60 to 5 m/s with a current that rises in three seconds and swings. `residual`: of the energy balance, eq. (8) and (9).
Stop stop(const rig::Clamping& clamping, double step_s) {
    plant::Rig rig(landing(clamping), step_s, 1);
    rig.start_rolling();
    const double before_J = rig.kinetic_energy_J();
    const auto mA = [](double t) { return std::min(t / 3.0, 1.0) * 9.0 + std::sin(8.0 * t); };
    while (rig.wheel().v_mps > 5.0) rig.advance_current(mA(rig.time_s()), mA(rig.time_s() + step_s));
    const double taken_J = rig.wheel().energy_brake_J + rig.wheel().energy_tyre_J;
    return {rig.wheel().distance_m, rig.wheel().energy_brake_J, (before_J - rig.kinetic_energy_J() - taken_J) / before_J};
}

}  // namespace

TEST_CASE("clamping: nothing below the contact pressure, the rest above", "[RIG-265]") {
    plant::Clamp clamp({.contact_Pa = 1e6});
    CHECK(follow(clamp, 0.9e6) == 0.0);
    CHECK(follow(clamp, 5e6) == Approx(4e6));
    CHECK(follow(clamp, 1e6) == 0.0);
}

TEST_CASE("clamping: piston friction holds up both ways, a loop as wide as twice its share", "[RIG-265]") {
    plant::Clamp clamp({.contact_Pa = 1e6, .piston_friction = 0.05});
    CHECK(follow(clamp, 11e6) == Approx(9.5e6));
    CHECK(follow(clamp, 10.5e6) == Approx(9.5e6));  // within the play
    CHECK(follow(clamp, 7e6) == Approx(6.3e6));     // 6 MPa and 5 % more
    CHECK(follow(clamp, 7.2e6) == Approx(6.3e6));
    CHECK(follow(clamp, 11e6) == Approx(9.5e6));
    CHECK(follow(clamp, 0.0) == 0.0);
}

TEST_CASE("clamping: the torque of discs that are not true changes with the wheel's angle, and has its mean over a turn", "[RIG-265]") {
    plant::Clamp clamp({.run_out = 0.08, .warp = 0.03});
    static_cast<void>(follow(clamp, 10e6));
    double sum = 0.0;
    for (int i = 0; i < 360; ++i) sum += clamp.pressure_Pa(i * std::numbers::pi / 180.0) / 360.0;
    CHECK(sum == Approx(10e6).epsilon(1e-12));
    CHECK(clamp.pressure_Pa(0.5 * std::numbers::pi) == Approx(10.8e6));
    CHECK(clamp.pressure_Pa(0.25 * std::numbers::pi) == Approx(10e6 * (1.03 + 0.08 * std::sqrt(0.5))));
}

TEST_CASE("clamping: a stop's energy balance closes, and short steps give the same stop", "[RIG-265]") {
    const Stop ours = stop(kAll, 1e-3), fine = stop(kAll, 1e-4), plain = stop({}, 1e-3);
    CHECK(std::abs(ours.residual) < 1e-6);
    CHECK(ours.distance_m == Approx(fine.distance_m).epsilon(2e-4));
    CHECK(ours.brake_J == Approx(fine.brake_J).epsilon(2e-4));
    CHECK(ours.distance_m > 1.1 * plain.distance_m);  // the springs take 1 of some 5 MPa
}

TEST_CASE("clamping: what cannot be is refused", "[RIG-265]") {
    for (const rig::Clamping& wrong :
         {rig::Clamping{.contact_Pa = -1.0}, rig::Clamping{.piston_friction = 1.0}, rig::Clamping{.run_out = 0.6, .warp = 0.4},
          rig::Clamping{.contact_Pa = std::numeric_limits<double>::quiet_NaN()}})
        CHECK_THROWS_AS(plant::Clamp(wrong), std::invalid_argument);
}
