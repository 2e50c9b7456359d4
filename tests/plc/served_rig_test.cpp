/// The served rig by its registers: load, touchdown, trips, measured values, determinism.
#include "plant_sim/plc/served_rig.hpp"

#include <limits>

#include "tests/catch.hpp"
#include "tests/plc/operator.hpp"

using plc::Bench;
using plc_test::Measured;
using plc_test::Operator;

namespace {

bool on_rim_at(Operator& op, double speed_mps, bool load) {
    op.wish({.drive = true, .speed_mps = speed_mps});
    if (!op.until([&op, speed_mps] { return op.v() > speed_mps - 0.02; }, 60.0)) return false;
    op.wish({.advance = true, .load = load});
    return op.until([&op] { return op.rig.wheel_on_rim(); }, 10.0);
}

}  // namespace

TEST_CASE("everything is at rest and off at the start", "[RIG-230]") {
    Operator op(Bench::landing);
    CHECK(op.measured(Measured::plc_state) == 0.0);
    CHECK(op.measured(Measured::interlocks) == 15.0);
    CHECK(op.measured(Measured::applied_commit) == 0.0);
    CHECK(op.measured(Measured::wheel_on_rim) == 0.0);
    CHECK(op.measured(Measured::brake_temperature_C) == Approx(20.0).margin(1.5));
    CHECK(op.measured(Measured::hydraulic_pressure_Pa) == Approx(21e6).epsilon(0.02));
    op.run(5.0);
    CHECK(op.v() == 0.0);
    CHECK(op.rig.idle());
    CHECK(op.measured(Measured::plc_watchdog) == 500.0);
}

TEST_CASE(
    "a rig that starts spun up has a flywheel that turns, coasts and is brought to speed, and nothing else "
    "that moves",
    "[RIG-230]") {
    plc::ServedRigOptions options = plc::load_served_rig("config", Bench::landing);
    options.rim_mps = 50.0;
    Operator op(Bench::landing, options, 1);
    CHECK(op.measured(Measured::plc_state) == 0.0);
    CHECK(op.measured(Measured::wheel_on_rim) == 0.0);
    CHECK(op.rig.rig().wheel().omega_radps == 0.0);
    CHECK(op.v() == 50.0);
    op.run(1.0);
    CHECK(op.v() < 50.0);
    CHECK(op.v() > 49.0);
    op.wish({.drive = true, .speed_mps = 51.0});
    CHECK(op.until([&op] { return op.v() > 50.98; }, 10.0));
    CHECK(op.rig.rig().wheel().omega_radps == 0.0);
}

TEST_CASE("the load follows eq. (2) behind its lag, once enabled", "[RIG-200]") {
    Operator op(Bench::landing);
    REQUIRE(on_rim_at(op, op.plant.rig.brake_on_mps, false));
    const double contact_N = plc::load_served_rig("config", Bench::landing).machinery.loading.contact_force_N;
    op.run(2.0);
    CHECK(op.rig.rig().forces().F_z_N == Approx(contact_N).epsilon(1e-6));
    op.wish({.advance = true, .load = true});
    const auto& law = op.plant.rig.load;
    REQUIRE(op.until([&op, contact_N] { return op.rig.rig().forces().F_z_N > contact_N * 1.0001; }, 0.05));
    double expected = op.rig.rig().forces().F_z_N;
    for (int i = 0; i < 300; ++i) {
        const double v = op.v();
        const double set_N = law.base_N - law.lift_Ns2pm2 * v * v;
        expected = set_N + (expected - set_N) * std::exp(-1e-3 / law.lag_s);
        op.tick();
        REQUIRE(op.rig.rig().forces().F_z_N == Approx(expected).epsilon(1e-4));
    }
    // In the stop the load grows as the speed falls, by the lag behind the law.
    REQUIRE(op.until([&op] { return op.v() < 30.0; }, 30.0, 12.0));
    const double v = op.v();
    const double a = op.rig.rig().forces().F_x_N / op.plant.rig.wheel.mass_kg;
    const double behind_N = law.lag_s * 2.0 * law.lift_Ns2pm2 * v * a;
    CHECK(law.base_N - law.lift_Ns2pm2 * v * v - op.rig.rig().forces().F_z_N == Approx(behind_N).epsilon(0.05).margin(30.0));
    CHECK(op.measured(Measured::vertical_load_N) == Approx(op.rig.rig().forces().F_z_N).margin(200.0));
}

TEST_CASE("without load_enable only the contact force presses; retract lifts off", "[RIG-200]") {
    Operator op(Bench::endurance);
    REQUIRE(on_rim_at(op, 20.0, true));
    op.run(2.0);
    CHECK(op.rig.rig().forces().F_z_N == Approx(op.plant.rig.load.base_N).epsilon(1e-6));
    op.wish({.advance = true});
    op.run(2.0);
    CHECK(op.rig.rig().forces().F_z_N == Approx(500.0).epsilon(1e-4));
    op.wish({});
    op.run(1.5);
    CHECK_FALSE(op.rig.wheel_on_rim());
    CHECK(op.rig.rig().forces().F_z_N < 0.01);
    CHECK(op.measured(Measured::vertical_load_N) == Approx(0.0).margin(100.0));
}

TEST_CASE("touchdown spins the wheel up and costs the rim what the wheel took", "[RIG-200]") {
    const auto bench = GENERATE(Bench::landing, Bench::endurance);
    Operator op(bench);
    REQUIRE(on_rim_at(op, 50.0, true));
    const double before_mps = op.v();
    op.run(3.0);
    const auto& w = op.plant.rig.wheel;
    const plant::Forces f = op.rig.rig().forces();
    CHECK(f.slip == Approx(0.0).margin(1e-6));
    // Angular momentum about each axle, with a radius that the load flattens on the way.
    const double max = before_mps / (1.0 + w.inertia_kgm2 / (w.mass_kg * w.free_radius_m * w.free_radius_m));
    const double min = before_mps / (1.0 + w.inertia_kgm2 / (w.mass_kg * f.radius_m * f.radius_m));
    CHECK(op.v() > min - 0.01);
    CHECK(op.v() < max + 0.01);
    CHECK(op.rig.maneuvers() == 1);
}

TEST_CASE("an open interlock in any phase: drive off, sledge back, load off", "[RIG-214]") {
    const unsigned interlock = GENERATE(0U, 1U, 2U, 3U);
    const bool braking = GENERATE(false, true);
    Operator op(Bench::endurance);
    if (braking) {
        REQUIRE(on_rim_at(op, 40.0, true));
        op.run(3.0, 15.0);
    } else {
        op.wish({.drive = true, .speed_mps = 40.0});
        op.run(5.0);
    }
    const double before_mps = op.v();
    op.rig.open_interlocks(1U << interlock);
    op.run(0.02);
    CHECK(op.measured(Measured::plc_state) == 1.0);
    CHECK(op.measured(Measured::interlocks) == 15.0 - static_cast<double>(1U << interlock));
    CHECK(op.measured(Measured::hydraulic_pressure_Pa) == Approx(interlock == 2 ? 0.0 : 21e6).margin(0.3e6));
    CHECK_FALSE(op.rig.wheel_on_rim());
    op.run(4.0);
    CHECK(op.measured(Measured::sledge_position_m) == 0.0);
    CHECK(op.rig.rig().forces().F_z_N < 0.01);
    CHECK(op.v() < before_mps);
    CHECK(op.v() > before_mps - 3.0);  // coasting
    // Closed again: still tripped, until a reset.
    op.rig.open_interlocks(0);
    op.run(0.5);
    CHECK(op.measured(Measured::plc_state) == 1.0);
    op.wish({.reset = true});
    op.run(0.02);
    CHECK(op.measured(Measured::plc_state) == 0.0);
    op.wish({.drive = true, .speed_mps = 45.0});
    op.run(2.0);
    CHECK(op.v() > before_mps - 3.0 + 1.0);
}

TEST_CASE("a silent bridge trips the rig after its time, in rig time", "[RIG-214]") {
    plc::ServedRigOptions options = plc::load_served_rig("config", Bench::endurance);
    options.watchdog_s = 1.5;
    Operator op(Bench::endurance, options, 1);
    op.wish({.drive = true, .speed_mps = 40.0});
    op.run(5.0);
    op.alive = false;
    op.run(1.4);
    CHECK(op.measured(Measured::plc_state) == 0.0);
    op.run(0.2);
    CHECK(op.measured(Measured::plc_state) == 1.0);
    CHECK(op.rig.plc().trip() == plc::Trip::bridge_silent);
}

TEST_CASE("gauges: seeded noise of the given size, no bias, resolution kept", "[RIG-230]") {
    Operator op(Bench::endurance);
    REQUIRE(on_rim_at(op, 30.0, true));
    op.run(3.0);
    const plc::Gauges g = plc::load_served_rig("config", Bench::endurance).machinery.gauges;
    double sum = 0.0;
    double squares = 0.0;
    constexpr int kReadings = 4000;
    for (int i = 0; i < kReadings; ++i) {
        op.run(0.01);
        const double reading = op.measured(Measured::vertical_load_N);
        REQUIRE(std::abs(std::remainder(reading, g.force.resolution)) < 1e-6);
        const double error = reading - op.rig.rig().forces().F_z_N;
        sum += error;
        squares += error * error;
    }
    const double deviation = std::hypot(g.force.noise, g.force.resolution / std::sqrt(12.0));
    CHECK(sum / kReadings == Approx(0.0).margin(4.0 * deviation / std::sqrt(kReadings)));
    CHECK(std::sqrt(squares / kReadings) == Approx(deviation).epsilon(0.05));
}

TEST_CASE("same seed and commands: the same bits; another seed: another noise on the same plant", "[RIG-230]") {
    const auto run = [](std::uint64_t seed, std::vector<double>& noisy) {
        Operator op(Bench::endurance, seed);
        REQUIRE(on_rim_at(op, 20.0, true));
        for (int i = 0; i < 4000; ++i) {
            op.tick(12.0);
            for (const double value : op.rig.measured()) noisy.push_back(value);
            noisy.push_back(static_cast<double>(op.rig.sample().pressure_Pa));
            noisy.push_back(static_cast<double>(op.rig.sample().wheel.edge_time.count()));
        }
        return op.rig.rig().wheel().energy_tyre_J;
    };
    std::vector<double> one, again, other;
    const double tyre = run(1, one);
    CHECK(run(1, again) == tyre);
    CHECK(one == again);
    (void)run(2, other);
    CHECK(one != other);
}

TEST_CASE("periods of several milliseconds are the same rig", "[RIG-230]") {
    plc::ServedRigOptions options = plc::load_served_rig("config", Bench::endurance);
    Operator fine(Bench::endurance, options, 3);
    options.period_s = 5e-3;
    Operator coarse(Bench::endurance, options, 3);
    fine.alive = coarse.alive = false;
    for (Operator* op : {&fine, &coarse}) {
        rig::at(op->registers, rig::Commanded::bridge_watchdog) = 1.0;
        op->wish({.drive = true, .speed_mps = 20.0});
    }
    for (int i = 0; i < 90; ++i) {
        coarse.tick(5.0);
        for (int k = 0; k < 5; ++k) fine.tick(5.0);
    }
    CHECK(fine.rig.rig().wheel().distance_m == coarse.rig.rig().wheel().distance_m);
    CHECK(fine.rig.measured() == coarse.rig.measured());
    CHECK(coarse.v() > 0.5);
    for (const double wrong : {0.0, -1e-3, 1.5e-3, std::numeric_limits<double>::quiet_NaN()}) {
        options.period_s = wrong;
        CHECK_THROWS_AS(plc::ServedRig(fine.plant, options, 1), std::invalid_argument);
    }
}

TEST_CASE("a command acts at the next scan, measured values change with it", "[RIG-210]") {
    Operator op(Bench::endurance);
    op.run(1.0);
    op.wish({.drive = true, .speed_mps = 20.0});
    int ticks = 0;
    REQUIRE(op.until(
        [&] {
            ++ticks;
            return op.measured(Measured::applied_commit) == 1.0;
        },
        0.1));
    CHECK(ticks <= 11);
}
