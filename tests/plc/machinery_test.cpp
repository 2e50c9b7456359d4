/// The machines against their closed forms, run by the PLC's registers.
#include "plant_sim/plc/machinery.hpp"

#include "tests/catch.hpp"
#include "tests/plc/operator.hpp"

using plc::Bench;
using plc_test::Measured;
using plc_test::Operator;

namespace {

/// Both limits of the drive and the drag, integrated by a method of its own: the time from rest to `v_mps`, trapezoids over speed.
double time_to_speed_s(const plc::Drive& drive, double mass_kg, double radius_m, double v_mps) {
    constexpr int kParts = 200000;
    const double dv = v_mps / kParts;
    const auto slowness = [&](double v) {
        const double force =
            std::min(drive.torque_Nm / radius_m, v > 0.0 ? drive.power_W / v : 1e300) - drive.drag.bearing_N - drive.drag.windage_Ns2pm2 * v * v;
        return mass_kg / force;
    };
    double time = 0.0;
    for (int i = 0; i < kParts; ++i) time += 0.5 * dv * (slowness(i * dv) + slowness((i + 1) * dv));
    return time;
}

}  // namespace

TEST_CASE("the drive accelerates by its torque, then by its power, and holds the set-point", "[RIG-200]") {
    const auto bench = GENERATE(Bench::landing, Bench::endurance);
    Operator op(bench);
    const plc::Drive drive = plc::load_served_rig("config", bench).machinery.drive;
    const double mass_kg = op.plant.rig.wheel.mass_kg;
    const double radius_m = op.plant.rig.flywheel_radius_m;
    const double set_mps = op.plant.rig.brake_on_mps;
    op.wish({.drive = true, .speed_mps = set_mps});
    REQUIRE(op.until([&op] { return op.v() > 1.0; }, 2.0));
    const double start_s = op.rig.time_s();
    const double start_mps = op.v();
    // Constant torque, as long as the power allows it; the drag is a thousandth here and taken from the next step's own value.
    const double torque_mps = 0.5 * drive.power_W / (drive.torque_Nm / radius_m);
    REQUIRE(op.until([&op, torque_mps] { return op.v() > torque_mps; }, 60.0));
    CHECK(op.rig.time_s() - start_s ==
          Approx(time_to_speed_s(drive, mass_kg, radius_m, op.v()) - time_to_speed_s(drive, mass_kg, radius_m, start_mps)).epsilon(1e-5));
    // Into the power limit, short of the set-point by what the speed loop rounds off.
    const double near_mps = set_mps - 3.0 * drive.response_s;
    REQUIRE(op.until([&op, near_mps] { return op.v() > near_mps; }, 60.0));
    CHECK(op.rig.time_s() - start_s ==
          Approx(time_to_speed_s(drive, mass_kg, radius_m, op.v()) - time_to_speed_s(drive, mass_kg, radius_m, start_mps)).epsilon(1e-4));
    double fastest = 0.0;
    REQUIRE(op.until(
        [&op, &fastest, set_mps] {
            fastest = std::max(fastest, op.v());
            return op.v() > set_mps - 1e-3;
        },
        10.0));
    op.run(20.0);
    CHECK(op.v() == Approx(set_mps).margin(1e-6));
    CHECK(fastest <= set_mps + 1e-9);
    CHECK(op.measured(Measured::flywheel_speed_mps) == Approx(set_mps).margin(0.03));
}

TEST_CASE("a landing's flywheel is spun up in about 20 s, the endurance one, too", "[RIG-200]") {
    const auto bench = GENERATE(Bench::landing, Bench::endurance);
    Operator op(bench);
    const double set_mps = op.plant.rig.brake_on_mps;
    op.wish({.drive = true, .speed_mps = set_mps});
    CHECK(op.until([&op, set_mps] { return op.v() > set_mps - 0.1; }, 25.0));
    CHECK(op.rig.time_s() > 15.0);
}

TEST_CASE("without drive the flywheel coasts down by bearings and windage", "[RIG-200]") {
    const plant::Drag drag{.bearing_N = 40.0, .windage_Ns2pm2 = 0.3};
    const double m = 500.0;
    SECTION("closed form against a fine integration") {
        double v = 60.0;
        double distance = 0.0;
        constexpr double h = 1e-3;
        for (int i = 0; i < 60000; ++i) {
            const auto a = [&](double u) { return -(drag.bearing_N + drag.windage_Ns2pm2 * u * u) / m; };
            const double k1 = a(v), k2 = a(v + 0.5 * h * k1), k3 = a(v + 0.5 * h * k2), k4 = a(v + h * k3);
            const double next = v + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            distance += 0.5 * h * (v + next) + h * h / 12.0 * (k1 - k4);
            v = next;
        }
        const plant::CoastDown end = plant::coast_down(drag, m, 60.0, 60.0);
        CHECK(end.v_mps == Approx(v).epsilon(1e-9));
        CHECK(end.distance_m == Approx(distance).epsilon(1e-9));
    }
    SECTION("it comes to rest and stays there") {
        const plant::CoastDown end = plant::coast_down(drag, m, 1.0, 1e5);
        CHECK(end.v_mps == 0.0);
        CHECK(end.distance_m == Approx(0.5 * m / drag.windage_Ns2pm2 * std::log1p(drag.windage_Ns2pm2 / drag.bearing_N)));
        CHECK(plant::coast_down(drag, m, 0.0, 10.0).distance_m == 0.0);
    }
    SECTION("the served rig, step by step") {
        Operator op(Bench::endurance);
        op.wish({.drive = true, .speed_mps = 20.0});
        REQUIRE(op.until([&op] { return op.v() > 19.9; }, 20.0));
        op.wish({});
        op.run(0.02);
        const double from_mps = op.v();
        const double from_m = op.rig.rig().wheel().distance_m;
        op.run(30.0);
        const plant::Drag own = plc::load_served_rig("config", Bench::endurance).machinery.drive.drag;
        const plant::CoastDown end = plant::coast_down(own, op.plant.rig.wheel.mass_kg, from_mps, 30.0);
        CHECK(op.v() == Approx(end.v_mps).epsilon(1e-7));
        CHECK(op.rig.rig().wheel().distance_m - from_m == Approx(end.distance_m).epsilon(1e-7));
        CHECK(end.v_mps < from_mps - 0.2);
    }
}

TEST_CASE("a lower set-point is reached by coasting: the drive does not brake", "[RIG-200]") {
    Operator op(Bench::endurance);
    op.wish({.drive = true, .speed_mps = 20.0});
    REQUIRE(op.until([&op] { return op.v() > 19.99; }, 30.0));
    op.wish({.drive = true, .speed_mps = 19.9});
    double slowest = 20.0;
    op.run(60.0);
    slowest = std::min(slowest, op.v());
    CHECK(slowest == Approx(19.9).margin(1e-6));
}

TEST_CASE("the sledge travels at its speed, both ways, and touches at its contact position", "[RIG-200]") {
    Operator op(Bench::endurance);
    const plc::Sledge sledge = plc::load_served_rig("config", Bench::endurance).machinery.sledge;
    const double travel_s = sledge.contact_m / sledge.speed_mps;
    op.wish({.advance = true});
    REQUIRE(op.until([&op] { return op.rig.sledge_m() > 0.0; }, 0.1));
    const double start_s = op.rig.time_s();
    op.run(0.5 * travel_s);
    CHECK(op.rig.sledge_m() == Approx(0.5 * sledge.contact_m).margin(2e-4));
    CHECK_FALSE(op.rig.wheel_on_rim());
    REQUIRE(op.until([&op] { return op.rig.wheel_on_rim(); }, travel_s));
    CHECK(op.rig.time_s() - start_s == Approx(travel_s).margin(2e-3));
    op.run(1.0);
    CHECK(op.rig.sledge_m() == sledge.contact_m);
    CHECK(op.measured(Measured::wheel_on_rim) == 1.0);
    CHECK(op.measured(Measured::sledge_position_m) == sledge.contact_m);
    op.wish({});
    REQUIRE(op.until([&op] { return !op.rig.wheel_on_rim(); }, 0.1));
    const double back_s = op.rig.time_s();
    REQUIRE(op.until([&op] { return op.rig.sledge_m() == 0.0; }, 2.0 * travel_s));
    CHECK(op.rig.time_s() - back_s == Approx(travel_s).margin(2e-3));
    CHECK(op.measured(Measured::wheel_on_rim) == 0.0);
}

TEST_CASE("brake temperature: heat capacity and cooling in closed form", "[RIG-200]") {
    const plc::BrakeThermal t{.heat_capacity_JpK = 4000.0, .cooling_WpK = 10.0, .ambient_C = 20.0};
    SECTION("constant power, in a thousand steps and in one") {
        double T = 35.0;
        const double decay = t.decay(0.25);
        for (int i = 0; i < 1000; ++i) T = t.after(T, 3000.0, decay);
        const double expected = 20.0 + 300.0 + (35.0 - 320.0) * std::exp(-250.0 / 400.0);
        CHECK(T == Approx(expected).epsilon(1e-12));
        CHECK(t.after(35.0, 3000.0, t.decay(250.0)) == Approx(expected).epsilon(1e-12));
    }
    SECTION("time to cool") {
        CHECK(t.cooling_time_s(260.0, 100.0) == Approx(400.0 * std::log(240.0 / 80.0)));
        CHECK(t.cooling_time_s(90.0, 100.0) == 0.0);
        CHECK(std::isinf(t.cooling_time_s(90.0, 20.0)));
    }
    SECTION("a stop heats by its energy, less what has gone to the air") {
        Operator op(Bench::endurance);
        const plc::BrakeThermal own = plc::load_served_rig("config", Bench::endurance).machinery.thermal;
        REQUIRE(plc_test::maneuver(op, 30.0, 20.0));
        const double energy_J = op.rig.cumulative_energy_J();
        CHECK(energy_J > 2e5);
        const double hottest = own.ambient_C + energy_J / own.heat_capacity_JpK;
        CHECK(op.rig.brake_temperature_C() < hottest);
        CHECK(op.rig.brake_temperature_C() > own.ambient_C + 0.95 * energy_J / own.heat_capacity_JpK);
        CHECK(op.measured(Measured::brake_temperature_C) == Approx(op.rig.brake_temperature_C()).margin(1.5));
    }
}
