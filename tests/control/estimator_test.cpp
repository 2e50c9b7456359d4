// What the controller believes, against wheels and brakes simulated here in double precision.
#include "firmware/control/estimator.hpp"

#include <array>
#include <cmath>
#include <vector>

#include "tests/catch.hpp"
#include "tests/control/fixed_config.hpp"
#include "tests/control/shaft.hpp"
#include "tests/control/valve_truth.hpp"

using namespace antiskid::control;
using control_test::fixed_config;
using control_test::kInf;
using control_test::kNaN;
using control_test::Shaft;
using control_test::ValveTruth;

namespace {

constexpr double kStep_s = 1e-3;
constexpr double kLiftPerStiffness = 3.61375 / 2.7e6;

/// A wheel under an estimator. Whoever uses it says how aircraft and wheel move.
struct RollingWheel {
    explicit RollingWheel(const Config& c = fixed_config()) : config(c), estimator(c) { sensors.maneuver.weight_on_wheels = true; }

    const Estimate& move(const double v, const double omega, const double pressure_Pa = 0.0, const double current_mA = 0.0) {
        now += Time{1'000'000};
        flywheel.turn_to(v / 0.6, kStep_s);
        wheel.turn_to(omega, kStep_s);
        flywheel.report(sensors.flywheel, now);
        wheel.report(sensors.wheel, now);
        sensors.pressure.received = now;
        sensors.pressure.pressure_Pa = static_cast<float>(pressure_Pa);
        return estimator.update(sensors, valve_pressure_Pa(config.valve, static_cast<float>(current_mA)));
    }
    void roll(const double v, const double standing_radius_m, const int periods) {
        for (int i = 0; i < periods; ++i) move(v, v / (standing_radius_m + kLiftPerStiffness * v * v));
    }

    Config config;
    Estimator estimator;
    Sensors sensors;
    Shaft wheel{60.0};
    Shaft flywheel{60.0};
    Time now{};
};

}  // namespace

TEST_CASE("a free-rolling wheel shows its radius", "[CTL-300]") {
    const double standing = GENERATE(0.310, 0.322, 0.335);
    const double v = GENERATE(20.0, 45.0, 61.0);
    RollingWheel w;
    w.roll(v, standing, 600);
    const Estimate& e = w.estimator.estimate();
    CHECK(e.speeds_known);
    CHECK(e.v_mps == Approx(v).epsilon(1e-4));
    CHECK(e.radius_m == Approx(standing + kLiftPerStiffness * v * v).epsilon(1e-3));
    CHECK(std::abs(e.slip) < 1e-3F);
    // Lift carries it on to another speed, where the brake no longer lets the wheel roll freely.
    for (int i = 0; i < 400; ++i) w.move(30.0, 80.0, 5e6, 13.5);
    CHECK(w.estimator.estimate().radius_m == Approx(standing + kLiftPerStiffness * 900.0).epsilon(2e-3));
}

TEST_CASE("what is no free roll leaves the radius alone", "[CTL-300]") {
    RollingWheel w;
    const auto standing = [&] {
        const Estimate& e = w.estimator.estimate();
        return static_cast<double>(e.radius_m) - kLiftPerStiffness * static_cast<double>(e.v_mps * e.v_mps);
    };
    SECTION("too slow") {
        w.roll(14.0, 0.33, 600);
        CHECK(standing() == Approx(0.322).epsilon(1e-5));
    }
    SECTION("in the air the wheel turns at any speed") {
        w.sensors.maneuver.weight_on_wheels = false;
        w.roll(50.0, 0.33, 600);
        CHECK(standing() == Approx(0.322).epsilon(1e-5));
    }
    SECTION("further from nominal than the tolerance") {
        w.roll(50.0, 0.345, 600);
        CHECK(standing() == Approx(0.322).epsilon(1e-5));
        w.roll(50.0, 0.300, 600);
        CHECK(standing() == Approx(0.322).epsilon(1e-5));
    }
    SECTION("under brake pressure") {
        for (int i = 0; i < 600; ++i) w.move(50.0, 50.0 / 0.333, 0.5e6, 4.5);
        CHECK(standing() == Approx(0.322).epsilon(1e-3));
    }
    SECTION("while it spins up") {
        for (int i = 0; i < 100; ++i) w.move(50.0, 140.0 + 0.1 * i);
        CHECK(standing() == Approx(0.322).epsilon(2e-3));
    }
    SECTION("standing") {
        for (int i = 0; i < 300; ++i) w.move(50.0, 0.0);
        CHECK(standing() == Approx(0.322).epsilon(1e-5));
        CHECK(w.estimator.estimate().slip == 1.0F);
    }
}

TEST_CASE("slip is eq. (3) and zero at standstill", "[CTL-300]") {
    RollingWheel w;
    w.roll(50.0, 0.322, 300);
    const double r = 0.322 + kLiftPerStiffness * 2500.0;
    const double slip = GENERATE(-0.5, 0.0, 0.1, 0.5, 0.9);
    for (int i = 0; i < 400; ++i) w.move(50.0, 50.0 / r * (1.0 - slip));
    CHECK(w.estimator.estimate().slip == Approx(slip).margin(2e-3));
    for (int i = 0; i < 200; ++i) w.move(0.0, 0.0);
    CHECK(w.estimator.estimate().slip == 0.0F);
    CHECK(w.estimator.estimate().v_mps == 0.0F);
    CHECK(w.estimator.estimate().speeds_known);
}

TEST_CASE("before anything has arrived nothing is known", "[CTL-300]") {
    RollingWheel w;
    for (int i = 0; i < 50; ++i) {
        const Estimate& e = w.estimator.update(w.sensors, 0.0F);
        REQUIRE_FALSE(e.speeds_known);
        REQUIRE(e.slip == 0.0F);
        REQUIRE(e.v_mps == 0.0F);
    }
}

namespace {

/// Eq. (1) with a road force that is given: J omega_dot = r F_x - k_b P, v_dot constant.
struct Truth {
    double v, omega, r, v_dot, road_Nm;
    void advance(const double pressure_Pa, const double h) {
        v += v_dot * h;
        omega += (road_Nm - 1.04e-3 * pressure_Pa) / 1.3 * h;
    }
    [[nodiscard]] double slip() const { return 1.0 - omega * r / v; }
};

}  // namespace

TEST_CASE("road torque and prediction agree with an independent simulation", "[CTL-300]") {
    // Pressure swings about the one that balances the road; the slip wanders between free rolling and half locked.
    const double balance_Pa = GENERATE(2e6, 8e6);
    const double v0 = GENERATE(30.0, 60.0);
    const Config config = fixed_config();
    RollingWheel w(config);
    w.roll(v0, 0.322, 400);
    const double r = 0.322 + kLiftPerStiffness * v0 * v0;
    Truth truth{.v = v0, .omega = v0 / r, .r = r, .v_dot = -4.0, .road_Nm = 1.04e-3 * balance_Pa};
    ValveTruth valve(static_cast<double>(config.valve.natural_frequency_radps), 0.8, 6e-3);
    std::vector<double> slips, late, balances;
    double current_mA = 0.0;
    constexpr int kPeriods = 700;
    truth.road_Nm = 0.0;
    for (int k = 0; k < kPeriods; ++k) {
        // The current of the step before acts over this period.
        valve.hold(static_cast<double>(valve_pressure_Pa(config.valve, static_cast<float>(current_mA))), kStep_s,
                   [&](const double p, const double h) {
                       // The tyre takes what the brake gives until the balance is reached.
                       truth.road_Nm = 1.04e-3 * std::min(balance_Pa, k < 60 ? p : balance_Pa);
                       truth.advance(p, h);
                   });
        const Estimate& e = w.move(truth.v, truth.omega, valve.pressure_Pa(), current_mA);
        slips.push_back(truth.slip());
        late.push_back(static_cast<double>(e.late_slip));
        balances.push_back(static_cast<double>(e.late_balance_Pa));
        // A stabilizing hand, so that the wheel neither locks nor spins free, with a swing on top.
        const double swing = 0.15 * balance_Pa * std::sin(2.0 * 3.14159 * 3.0 * k * kStep_s);
        const double wanted = balance_Pa + swing + 1e5 * v0 * (0.2 - truth.slip()) * (k >= 60 ? 1.0 : 0.0);
        current_mA = static_cast<double>(valve_current_mA(config.valve, static_cast<float>(wanted)));
    }
    double max = 0.0, min = 1.0;
    for (int k = 200; k + 6 < kPeriods; ++k) {
        const auto i = static_cast<std::size_t>(k);
        CAPTURE(k, balance_Pa, v0);
        REQUIRE(std::abs(late[i] - slips[i + 6]) < 0.01);
        max = std::max(max, slips[i]);
        min = std::min(min, slips[i]);
        // Constant slip needs omega_dot = omega v_dot / v: the wheel itself gives that much torque.
        const double own_Pa = 1.3 / 1.04e-3 * truth.omega * -truth.v_dot / truth.v;
        REQUIRE(balances[i] == Approx(balance_Pa + own_Pa).margin(0.05 * balance_Pa + 0.1e6));
    }
    CHECK(max - min > 0.05);  // it did move
}

TEST_CASE("readings that cannot be leave no trace", "[CTL-010]") {
    constexpr std::array<float, 6> kBad{kNaN, kInf, -kInf, -5.0F, 401.0F, 3e38F};
    const float bad = kBad[static_cast<std::size_t>(GENERATE(range(0, 6)))];
    RollingWheel w;
    w.roll(50.0, 0.322, 300);
    RollingWheel healthy = w;
    const auto strike = [&](auto& speed) {
        const SpeedInput before = speed;
        speed.source = SpeedSource::speed;
        speed.speed_radps = bad;
        speed.received += Time{500'000};
        w.estimator.update(w.sensors, 0.0F);
        speed = before;
    };
    SECTION("wheel") {
        strike(w.sensors.wheel);
    }
    SECTION("flywheel") {
        strike(w.sensors.flywheel);
    }
    SECTION("pressure") {
        w.sensors.pressure.received += Time{500'000};
        w.sensors.pressure.pressure_Pa = bad < 0.0F || bad == 401.0F ? bad * 1e9F : bad;
        w.estimator.update(w.sensors, 0.0F);
    }
    healthy.estimator.update(healthy.sensors, 0.0F);
    CAPTURE(bad);
    for (int i = 0; i < 5; ++i) {
        const Estimate& e = w.move(50.0, 154.0);
        const Estimate& h = healthy.move(50.0, 154.0);
        REQUIRE(e.v_mps == Approx(h.v_mps).epsilon(1e-5));
        REQUIRE(e.slip == Approx(h.slip).margin(1e-3));
        REQUIRE(e.late_balance_Pa == Approx(h.late_balance_Pa).margin(3e4));
        REQUIRE(e.pressure.pressure_Pa == Approx(h.pressure.pressure_Pa).margin(1.0));
    }
}

TEST_CASE("a sensor that is wrong from its first frame starts no filter", "[CTL-010]") {
    RollingWheel w;
    w.sensors.wheel.source = SpeedSource::speed;
    w.sensors.wheel.speed_radps = kInf;
    w.sensors.wheel.received = Time{1};
    for (int i = 0; i < 3; ++i) {
        w.sensors.wheel.received += Time{1'000'000};
        CHECK(w.estimator.update(w.sensors, 0.0F).omega_radps == 0.0F);
    }
    w.sensors.wheel.speed_radps = 100.0F;
    w.sensors.wheel.received += Time{1'000'000};
    CHECK(w.estimator.update(w.sensors, 0.0F).omega_radps == 100.0F);
}

namespace {

/// Sensors that report speed, radii of 0.5 m, no lift: products and quotients of round numbers are exact.
struct Exact {
    static Config config() {
        Config c = fixed_config();
        c.wheel.nominal_radius_m = c.flywheel.radius_m = 0.5F;
        c.wheel.radius_tolerance = 0.0625F;
        c.wheel.lift_Ns2pm2 = 0.0F;
        return c;
    }
    const Estimate& move(const float v_mps, const float omega_radps, const float pressure_Pa = 0.0F) {
        now += Time{1'000'000};
        sensors.wheel.received = sensors.flywheel.received = sensors.pressure.received = now;
        sensors.wheel.source = sensors.flywheel.source = SpeedSource::speed;
        sensors.flywheel.speed_radps = 2.0F * v_mps;
        sensors.wheel.speed_radps = omega_radps;
        sensors.pressure.pressure_Pa = pressure_Pa;
        sensors.maneuver.weight_on_wheels = true;
        return estimator.update(sensors, 0.0F);
    }
    Estimator estimator{config()};
    Sensors sensors;
    Time now{};
};

}  // namespace

TEST_CASE("a radius at the edge of its tolerance is learnt, above 15 m/s only", "[CTL-300]") {
    struct Row {
        float v_mps, omega_radps;
        bool learnt;
    };
    const Row row = GENERATE(values<Row>({{30.0F, 64.0F, true},  // 0.46875 m: 0.5 m less a sixteenth
                                          {30.0F, 64.01F, false},
                                          {34.0F, 64.0F, true},  // 0.53125 m
                                          {34.0F, 63.99F, false},
                                          {15.0F, 31.0F, false},
                                          {std::nextafter(15.0F, 16.0F), 31.0F, true}}));
    Exact x;
    for (int i = 0; i < 20; ++i) x.move(row.v_mps, row.omega_radps);
    CHECK((x.estimator.estimate().radius_m != 0.5F) == row.learnt);
}

TEST_CASE("a pressure up to twice the full one is believed", "[CTL-020]") {
    CHECK(Exact().move(0.0F, 0.0F, 2.0F * 20.7e6F).pressure.pressure_Pa > 1e6F);
    CHECK(Exact().move(0.0F, 0.0F, std::nextafter(2.0F * 20.7e6F, 1e9F)).pressure.pressure_Pa == 0.0F);
}

TEST_CASE("a pressure that is not renewed is used once, then the model goes on alone", "[CTL-020]") {
    Exact x;
    for (int i = 0; i < 200; ++i) x.move(0.0F, 0.0F, 5e6F);
    REQUIRE(x.estimator.estimate().pressure.pressure_Pa > 3e6F);
    for (int i = 0; i < 200; ++i) x.estimator.update(x.sensors, 0.0F);  // no current
    CHECK(std::abs(x.estimator.estimate().pressure.pressure_Pa) < 1e4F);
}

TEST_CASE("slip has no meaning up to half a metre per second, and stays between -1 and 1", "[CTL-300]") {
    CHECK(Exact().move(0.5F, 0.0F).slip == 0.0F);
    CHECK(Exact().move(std::nextafter(0.5F, 1.0F), 0.0F).slip == 1.0F);
    const Estimate fast = Exact().move(10.0F, 100.0F);
    CHECK(fast.slip == -1.0F);
    CHECK(fast.late_slip == -1.0F);
    // A brake that will stop the wheel before the command that is given now takes effect.
    Exact x;
    for (int i = 0; i < 20; ++i) x.move(30.0F, 20.0F);
    CHECK(x.move(30.0F, 20.0F, 40e6F).late_slip == 1.0F);
}

TEST_CASE("the fastest reading that can be is believed", "[CTL-010]") {
    Exact x;
    CHECK(x.move(125.0F, 400.0F).omega_radps == 400.0F);
    CHECK(x.estimator.estimate().v_mps == 125.0F);
    for (int i = 0; i < 20; ++i) x.move(124.0F, 399.0F);
    const float slower = x.estimator.estimate().omega_radps;
    for (int i = 0; i < 20; ++i) x.move(125.0F, 400.0F);
    CHECK(x.estimator.estimate().omega_radps > slower + 0.5F);
}

TEST_CASE("a bound above what a wheel can turn at bounds nothing", "[CTL-010]") {
    // 60 teeth: an edge is 0.10472 rad. The wheel gets faster, then an edge comes too early, and then none for a while.
    const auto fed = [](Estimator& estimator, const bool silence) {
        Sensors sensors;
        double edge_s = 1.0;
        const auto feed = [&](const double frame_s, const std::uint32_t edges, const double radps) {
            edge_s += edges * 0.104719755 / radps;
            sensors.wheel.received = Time{static_cast<std::int64_t>(frame_s * 1e9)};
            sensors.wheel.edge_count += edges;
            sensors.wheel.edge_time = Time{static_cast<std::int64_t>(edge_s * 1e9)};
            estimator.update(sensors, 0.0F);
        };
        double frame_s = 1.0;
        for (double radps = 200.0; radps < 399.0; radps += 20.0) {
            frame_s += 1e-3;
            feed(frame_s, 4, radps);
        }
        frame_s += 1e-3;
        feed(frame_s, 4, 450.0);                               // unusable
        if (silence) sensors.wheel.received += Time{255'000};  // 410.7 rad/s at most, from the silence
        return estimator.update(sensors, 0.0F).omega_radps;
    };
    Config c = fixed_config();
    c.observer.road_noise_radps2 = 1e5F;  // so that it follows within these ten readings
    c.observer.max_mean_innovation = 1e3F;
    Estimator one(c);
    Estimator other(c);
    const float expected = fed(one, false);
    REQUIRE(expected > 411.0F);  // the observer is ahead of every reading
    CHECK(fed(other, true) == expected);
}

TEST_CASE("a wheel whose speed changes by 60 rad/s2 is not free", "[CTL-300]") {
    const float max_radps2 = GENERATE(60.0F, 59.9F);
    Config config = Exact::config();
    config.wheel.encoder.max_acceleration_radps2 = max_radps2;  // what the observer stops at
    config.observer.pole_floor_radps = 0.0F;                    // a road without a slope
    Exact x;
    x.estimator = Estimator(config);
    for (int i = 0; i < 300; ++i) {
        const float v = 60.0F - 0.05F * static_cast<float>(i);
        x.move(v, v / 0.52F);
    }
    const float before = x.estimator.estimate().radius_m;
    x.move(45.0F, 45.0F / 0.52F);
    CHECK((x.estimator.estimate().radius_m == before) == (max_radps2 == 60.0F));
}

TEST_CASE("a wheel under 2 bar is not free", "[CTL-300]") {
    const bool below = GENERATE(false, true);
    const float target_Pa = below ? std::nextafter(2e5F, 0.0F) : 2e5F;
    bool found = false;
    float held_Pa = target_Pa;
    for (int tries = 0; tries < 400 && !found; ++tries) {
        Exact x;
        const auto move = [&x, target_Pa, held_Pa](const float omega_radps) {
            x.now += Time{1'000'000};
            x.sensors.wheel.received = x.sensors.flywheel.received = x.sensors.pressure.received = x.now;
            x.sensors.wheel.source = x.sensors.flywheel.source = SpeedSource::speed;
            x.sensors.flywheel.speed_radps = 100.0F;
            x.sensors.wheel.speed_radps = omega_radps;
            x.sensors.pressure.pressure_Pa = target_Pa;
            x.sensors.maneuver.weight_on_wheels = true;
            return x.estimator.update(x.sensors, held_Pa);
        };
        // At last it slows down by the 160 rad/s2 of that brake torque: the road gives it nothing.
        for (int i = 0; i < 600; ++i) move(103.0F);
        float omega_radps = 103.0F;
        for (int i = 0; i < 30; ++i) move(omega_radps -= 0.16F);
        const float before = x.estimator.estimate().radius_m;
        const Estimate after = move(omega_radps -= 0.16F);
        found = after.pressure.pressure_Pa == target_Pa;
        if (found) CHECK((after.radius_m != before) == below);
        held_Pa = after.pressure.pressure_Pa < target_Pa ? std::nextafter(held_Pa, 1e9F) : std::nextafter(held_Pa, 0.0F);
    }
    CHECK(found);
}
