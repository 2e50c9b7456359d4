// The controller as a whole: the demand is the ceiling, the current stays in its range, nothing is ever no number, changes are bumpless.
#include "firmware/control/controller.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/catch.hpp"
#include "tests/control/bench.hpp"

using namespace antiskid::control;
using control_test::Bench;
using control_test::fixed_config;

namespace {

bool finite(const Command& c) {
    return std::isfinite(c.current_mA) && std::isfinite(c.slip) && std::isfinite(c.slip_reference) &&
           std::isfinite(c.speed_mps) && std::isfinite(c.wheel_speed_radps) &&
           std::isfinite(c.pressure_request_Pa);
}

/// What does not hold of a command that must hold of every one, whatever came in; "" if all does.
std::string wrong_with(const Command& c, const Sensors& seen, const Config& config) {
    const float demand_Pa = seen.maneuver.demand_Pa;
    if (!finite(c)) return "no number";
    if (c.current_mA < config.valve.safe_current_mA) return "current below the safe one";
    if (c.current_mA > config.valve.current_mA[static_cast<std::size_t>(config.valve.points - 1)])
        return "current above the map";
    if (c.pressure_request_Pa < 0.0F) return "request below none";
    if (c.pressure_request_Pa > config.valve.full_pressure_Pa) return "request above full pressure";
    if (c.state == State::braking || c.state == State::drop_out) {
        if (!(c.pressure_request_Pa <= demand_Pa)) return "request above the demand";
        if (!(valve_pressure_Pa(config.valve, c.current_mA) <= demand_Pa * (1.0F + 1e-6F) + 1.0F))
            return "current above the demand";
    } else {
        if (c.current_mA != config.valve.safe_current_mA) return "not braking, current not safe";
        if (c.pressure_request_Pa != 0.0F) return "not braking, pressure asked for";
        if (c.slip_reference != 0.0F) return "not braking, a slip reference in force";
    }
    if (c.slip < -1.0F || c.slip > 1.0F) return "slip out of range";
    if (c.state == State::safe && c.faults.empty()) return "safe without a name";
    return {};
}

/// Thousands of times a test: nothing is put into words unless it is wrong.
void check_command(const Command& c, const Sensors& seen, const Config& config, unsigned seed, int step) {
    const std::string wrong = wrong_with(c, seen, config);
    if (!wrong.empty())
        FAIL(wrong << ": seed " << seed << ", step " << step << ", state " << static_cast<int>(c.state));
}

}  // namespace

TEST_CASE("the pressure request is never above the demand", "[CTL-061]") {
    const auto seed = static_cast<unsigned>(GENERATE(range(0, 12)));
    std::mt19937 random(seed);
    const auto between = [&random](const double a, const double b) {
        return std::uniform_real_distribution<>(a, b)(random);
    };
    const float period_s = seed % 3U == 0U ? 1e-3F : seed % 3U == 1U ? 2e-3F : 5e-3F;
    Bench b(fixed_config(period_s));
    b.to_braking();
    int braking = 0, dropped = 0, cut = 0;
    double slip_goal = 0.1;
    for (int k = 0; k < 20'000; ++k) {
        // Steps, ramps and nonsense of everything that the pilot, the runway and the sequencer can do.
        ManeuverInput& m = b.sensors.maneuver;
        if (k % 37 == 0) m.demand_Pa = static_cast<float>(between(0.0, 1.0) < 0.1 ? 0.0 : between(0.0, 25e6));
        if (k % 101 == 0) m.law = static_cast<Law>(random() % kLawCount);
        if (k % 53 == 0) m.slip_reference = static_cast<float>(between(0.0, 0.5));
        if (k % 61 == 0) m.deceleration_mps2 = static_cast<float>(between(0.0, 15.0));
        if (k % 71 == 0) m.current_mA = static_cast<float>(between(0.0, 100.0));
        if (k % 900 == 0) m.weight_on_wheels = between(0.0, 1.0) > 0.1;
        if (k % 83 == 0) slip_goal = between(-0.05, 0.9);
        b.slip += 0.02 * (slip_goal - b.slip);
        b.v_mps = std::max(0.0, b.v_mps - 3e-3 * 1e3 * static_cast<double>(period_s));
        if (b.v_mps < 1.0 && k % 2000 == 0) b.v_mps = 55.0;
        if (b.command.state == State::safe) m.arm = false;
        if (b.command.state == State::standby) m.arm = k % 3 == 0;
        const Command c = b.step();
        check_command(c, b.sensors, b.config, seed, k);
        braking += c.state == State::braking ? 1 : 0;
        dropped += c.state == State::drop_out ? 1 : 0;
        cut += c.pressure_request_Pa == m.demand_Pa && m.demand_Pa > 0.0F ? 1 : 0;
    }
    CHECK(braking > 1000);
    CHECK(cut > 100);
    CHECK(dropped + braking > 1000);
}

TEST_CASE("no input whatever makes a command that is no number or out of range", "[CTL-062]") {
    const auto seed = static_cast<unsigned>(GENERATE(range(0, 8)));
    std::mt19937 random(seed);
    constexpr std::array<float, 14> kNasty{0.0F,
                                           -0.0F,
                                           1.0F,
                                           -1.0F,
                                           1e-42F,
                                           1e30F,
                                           -1e30F,
                                           3.4e38F,
                                           1e7F,
                                           20e6F,
                                           400.0F,
                                           std::numeric_limits<float>::infinity(),
                                           -std::numeric_limits<float>::infinity(),
                                           std::numeric_limits<float>::quiet_NaN()};
    const auto nasty = [&]() -> float {
        const auto pick = random() % 20U;
        return pick < kNasty.size() ? kNasty[pick]
                                    : std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    };
    const auto coin = [&random] { return random() % 2U == 0U; };
    // Differences of any two of these times fit the type: the programs' clocks start near zero.
    const auto any_time = [&]() -> Time {
        const auto pick = random() % 4U;
        if (pick == 0U) return kNever;
        const auto wide = static_cast<std::int64_t>((static_cast<std::uint64_t>(random()) << 32U) | random());
        return Time{pick == 1U ? wide / 4 : wide % 1'000'000'000'000};
    };
    Bench b;
    b.to_braking();
    int braking_through_it = 0;
    for (int k = 0; k < 60'000; ++k) {
        Sensors hit;
        const bool strike = random() % 4U == 0U;
        b.tamper = [&](Sensors& s) {
            if (strike) {
                switch (random() % 9U) {
                    case 0:
                        s.pressure.pressure_Pa = nasty();
                        break;
                    case 1:
                        s.wheel.source = SpeedSource::speed;
                        s.wheel.speed_radps = nasty();
                        break;
                    case 2:
                        s.flywheel.source = SpeedSource::speed;
                        s.flywheel.speed_radps = nasty();
                        break;
                    case 3:
                        s.wheel.edge_count = static_cast<std::uint32_t>(random());
                        break;
                    case 4:
                        s.flywheel.edge_time = Time{static_cast<std::int64_t>(random()) * 1000};
                        break;
                    case 5:
                        s.maneuver.demand_Pa = nasty();
                        s.maneuver.slip_reference = nasty();
                        s.maneuver.deceleration_mps2 = nasty();
                        s.maneuver.current_mA = nasty();
                        s.maneuver.law = static_cast<Law>(random() % 256U);
                        break;
                    case 6:
                        s.wheel.received = any_time();
                        s.flywheel.received = any_time();
                        s.pressure.received = any_time();
                        s.maneuver.received = any_time();
                        s.rig_heartbeat_received = any_time();
                        break;
                    case 7:
                        s.wheel.rejected = static_cast<std::uint32_t>(random());
                        s.emergency_stop = coin();
                        s.bus_off = coin();
                        s.missed_periods = coin() ? 1U : 0U;
                        break;
                    default:
                        s.maneuver.arm = coin();
                        s.maneuver.weight_on_wheels = coin();
                        break;
                }
            }
            hit = s;
        };
        if (b.command.state == State::safe) b.sensors.maneuver.arm = false;
        if (b.command.state == State::standby) b.sensors.maneuver.arm = true;
        const Command c = b.step();
        check_command(c, hit, b.config, seed, k);
        braking_through_it += c.state == State::braking && strike ? 1 : 0;
    }
    // And it has left nothing behind: with good inputs everything works again.
    b.tamper = nullptr;
    b.sensors.maneuver = {};
    b.sensors.maneuver.slip_reference = 0.2F;  // the wheel stays at 0.1: the law asks for more
    b.v_mps = 0.0;
    b.slip = 1.0;
    b.seconds(8.0);  // an aircraft at the highest speed that the encoder can show would have stopped by then
    REQUIRE(b.command.state == State::standby);
    b.to_braking();
    Bench fresh;
    fresh.sensors.maneuver.slip_reference = 0.2F;
    fresh.to_braking();
    REQUIRE(fresh.command.pressure_request_Pa > 3e6F);
    CHECK(b.command.pressure_request_Pa == Approx(fresh.command.pressure_request_Pa).epsilon(0.01));
    CHECK(std::isfinite(b.controller.estimate().late_balance_Pa));
    CHECK(braking_through_it > 0);
}

TEST_CASE("open loop is the commanded current, limited by the demand", "[CTL-060]") {
    Bench b;
    b.to_braking(Law::open_loop);
    b.sensors.maneuver.demand_Pa = 20.7e6F;
    for (const float current : {3.5F, 8.0F, 21.3F, 39.9F, 40.0F}) {
        b.sensors.maneuver.current_mA = current;
        CHECK(b.step().current_mA == Approx(current).epsilon(1e-5));
    }
    b.sensors.maneuver.current_mA = 100.0F;
    CHECK(b.step().current_mA == 40.0F);
    b.sensors.maneuver.current_mA = 2.0F;  // within the dead zone: no pressure
    CHECK(b.step().current_mA == 0.0F);
    b.sensors.maneuver.current_mA = 20.0F;
    b.sensors.maneuver.demand_Pa = 4.3e6F;
    CHECK(b.step().current_mA == Approx(12.0F));
    CHECK(b.command.pressure_request_Pa == 4.3e6F);
}

TEST_CASE("a command that did not leave is not taken for given: the valve holds the one before",
          "[CTL-320]") {
    const bool told = GENERATE(false, true);
    Bench b;
    b.to_braking(Law::open_loop);
    const float held_mA = b.command.current_mA;
    bool unsent = false;
    // The model alone: no reading that would correct it.
    Time read = b.now;
    b.tamper = [&](Sensors& seen) {
        seen.pressure.received = read;
        seen.command_unsent = unsent;
    };
    b.sensors.maneuver.current_mA = 5.0F;
    const auto believed_Pa = [&] { return b.controller.estimate().pressure.pressure_Pa; };
    for (int period = 0; period < 16; ++period) {
        CHECK(b.step().current_mA == Approx(5.0F));
        b.command.current_mA = held_mA;
        unsent = told;
    }
    if (told)
        CHECK(believed_Pa() == Approx(b.sensors.pressure.pressure_Pa).epsilon(0.005));
    else
        CHECK(believed_Pa() < 0.97F * b.sensors.pressure.pressure_Pa);

    // The next that leaves is taken for given again.
    b.command.current_mA = 5.0F;
    unsent = false;
    read = b.now;
    const float before_Pa = b.sensors.pressure.pressure_Pa;
    b.steps(16);
    if (told) {
        CHECK(b.sensors.pressure.pressure_Pa < 0.97F * before_Pa);
        CHECK(believed_Pa() == Approx(b.sensors.pressure.pressure_Pa).epsilon(0.005));
    }
}

TEST_CASE("a valve that gives less than its map is asked for more where a pressure is meant", "[CTL-025]") {
    antiskid::control::Config config = fixed_config();
    config.estimator.pressure_bandwidth_radps = 30.0F;
    config.estimator.valve_offset_radps = 7.0F;
    config.estimator.valve_offset_share = 0.25F;
    Bench b(config);
    b.to_braking();
    b.tamper = [](antiskid::control::Sensors& seen) { seen.pressure.pressure_Pa *= 0.9F; };
    while (b.v_mps > 4.0) {
        b.v_mps -= 0.01;
        b.steps(1);
    }
    b.seconds(3.0);
    REQUIRE(b.command.state == State::drop_out);
    CHECK(b.command.pressure_request_Pa == 6e6F);
    CHECK(b.valve_Pa() * 0.9 == Approx(6e6).epsilon(1e-3));

    Bench open(config);
    open.to_braking(Law::open_loop);
    open.tamper = b.tamper;
    open.sensors.maneuver.demand_Pa = 20.7e6F;
    open.seconds(3.0);
    CHECK(open.command.current_mA == Approx(12.0F).epsilon(1e-5));

    for (const Law law : {Law::threshold, Law::pressure_bias}) {
        Bench baseline(config);
        baseline.to_braking(law);
        baseline.tamper = b.tamper;
        baseline.seconds(1.0);
        REQUIRE(baseline.command.state == State::braking);
        REQUIRE(baseline.command.pressure_request_Pa > 1e6F);
        CHECK(baseline.command.current_mA ==
              antiskid::control::valve_current_mA(config.valve, baseline.command.pressure_request_Pa));
    }

    Bench slip(config);
    slip.to_braking();
    slip.tamper = b.tamper;
    slip.slip = 0.05;  // short of the reference: all of the demand
    slip.seconds(1.0);
    REQUIRE(slip.command.pressure_request_Pa > 1e6F);
    CHECK(slip.command.current_mA >
          antiskid::control::valve_current_mA(config.valve, slip.command.pressure_request_Pa));
}

TEST_CASE("below drop-out the demand passes through at a limited rate", "[CTL-064]") {
    Bench b;
    b.to_braking();
    b.sensors.maneuver.demand_Pa = 12e6F;
    while (b.v_mps > 4.9) {
        b.v_mps -= 8e-3;
        static_cast<void>(b.step());
    }
    b.steps(20);
    REQUIRE(b.command.state == State::drop_out);
    float before = b.command.pressure_request_Pa;
    CHECK(before < 12e6F);
    int rising = 0;
    for (int i = 0; i < 3000; ++i) {
        const float now = b.step().pressure_request_Pa;
        REQUIRE(now <= 12e6F);
        REQUIRE(now - before <= 10e6F * 1e-3F * 1.001F);
        rising += now > before ? 1 : 0;
        before = now;
    }
    CHECK(before == 12e6F);
    CHECK(rising > 100);
    // The pilot may always have less, at once.
    b.sensors.maneuver.demand_Pa = 2e6F;
    CHECK(b.step().pressure_request_Pa == 2e6F);
    b.sensors.maneuver.demand_Pa = 12e6F;
    CHECK(b.step().pressure_request_Pa == Approx(2e6 + 10e3));
    CHECK(b.command.slip_reference == 0.0F);
}

TEST_CASE("pass-through starts from the pressure that is there", "[CTL-064]") {
    Bench b;
    b.to_braking(Law::wheel_slip);
    b.sensors.maneuver.demand_Pa = 12e6F;
    while (b.v_mps > 5.001) {
        b.v_mps = std::max(5.001, b.v_mps - 8e-3);
        static_cast<void>(b.step());
    }
    REQUIRE(b.command.state == State::braking);
    b.v_mps = 4.9;
    while (b.command.state != State::drop_out) {
        b.v_mps -= 1e-4;
        static_cast<void>(b.step());
    }
    CHECK(static_cast<double>(b.command.pressure_request_Pa) == Approx(b.valve_Pa()).margin(0.15e6));
}

TEST_CASE("changing the law does not jump", "[CTL-065]") {
    // A quiet wheel at its reference under 6 MPa; the law changes in mid-braking, each into each.
    const auto from = static_cast<Law>(GENERATE(range(0, int{kLawCount})));
    const auto to = static_cast<Law>(GENERATE(range(0, int{kLawCount})));
    Bench b;
    b.to_braking(Law::open_loop);
    b.sensors.maneuver.demand_Pa = 20e6F;
    b.sensors.maneuver.current_mA = valve_current_mA(b.config.valve, 6e6F);
    b.sensors.maneuver.deceleration_mps2 = 0.0F;
    b.seconds(0.5);
    const auto change = [&b](const Law law) {
        b.sensors.maneuver.law = law;
        const float before = b.command.pressure_request_Pa;
        const float now = b.step().pressure_request_Pa;
        // One period's worth of the quickest ramp (the build-up's 1 MPa), less than the valve's noise afterwards.
        return std::abs(now - before);
    };
    CHECK(change(from) <= 1.2e6F);
    b.steps(3);
    b.sensors.maneuver.current_mA = valve_current_mA(b.config.valve, b.command.pressure_request_Pa);
    CAPTURE(static_cast<int>(from), static_cast<int>(to), b.command.pressure_request_Pa);
    CHECK(change(to) <= 1.2e6F);
}

TEST_CASE("a law that takes over is held back at the rate of a demand that passes through, and no longer",
          "[CTL-065]") {
    Bench b;
    b.to_braking(Law::open_loop);
    b.sensors.maneuver.demand_Pa = 20e6F;
    b.sensors.maneuver.current_mA = valve_current_mA(b.config.valve, 2e6F);
    b.seconds(0.3);
    const float before = b.command.pressure_request_Pa;
    REQUIRE(before == Approx(2e6F));
    // The wheel slips less than the threshold law allows: it would rise by 64 MPa/s.
    b.sensors.maneuver.law = Law::threshold;
    b.slip = 0.05;
    for (int k = 1; k <= 200; ++k) {
        const auto most = static_cast<double>(before) + 10e3 * k;
        REQUIRE(static_cast<double>(b.step().pressure_request_Pa) == Approx(most).epsilon(1e-3));
    }
    // What braked before does not hold back what brakes anew.
    b.sensors.maneuver.demand_Pa = 0.0F;
    b.steps(2);
    REQUIRE(b.command.state == State::armed);
    b.sensors.maneuver.demand_Pa = 20e6F;
    b.steps(150);
    CHECK(b.command.pressure_request_Pa > 8e6F);
}

namespace {

/// The most that the law's reference comes to within the next 30 periods.
float most_reference(Bench& b) {
    float most = 0.0F;
    for (int i = 0; i < 30; ++i) most = std::max(most, b.step().slip_reference);
    return most;
}

void slip_to(Bench& b, const double slip) {
    while (b.slip != slip) {
        b.slip += std::clamp(slip - b.slip, -0.01, 0.01);
        b.steps(1);
    }
}

/// Braking at a reference of 0.2 that has retreated: the wheel has slipped by 0.65 for 100 ms.
void to_retreated(Bench& b) {
    b.to_braking();
    b.sensors.maneuver.slip_reference = 0.2F;
    REQUIRE(most_reference(b) == Approx(0.2));
    slip_to(b, 0.65);
    b.seconds(0.1);
    REQUIRE(b.command.state == State::braking);
    slip_to(b, 0.07);
    REQUIRE(most_reference(b) < 0.15F);
}

}  // namespace

TEST_CASE("a reference that has retreated is whole on the next landing", "[CTL-315]") {
    const bool from_touchdown = GENERATE(false, true);
    CAPTURE(from_touchdown);
    Bench b;
    to_retreated(b);
    b.sensors.maneuver.demand_Pa = 0.0F;
    b.seconds(0.2);
    b.sensors.maneuver.arm = false;
    b.sensors.maneuver.weight_on_wheels = false;
    REQUIRE(b.step().state == State::standby);
    b.slip = 1.0;
    b.seconds(0.3);
    b.sensors.maneuver.arm = true;
    REQUIRE(b.step().state == State::armed);
    b.sensors.maneuver.weight_on_wheels = true;
    if (from_touchdown) {
        b.sensors.maneuver.demand_Pa = 6e6F;
        REQUIRE(b.step().state == State::touchdown_protection);
        b.spin_up();
        b.slip = 0.07;
    } else {
        b.spin_up();
        b.slip = 0.07;
        b.seconds(0.3);
        REQUIRE(b.command.state == State::armed);
        b.sensors.maneuver.demand_Pa = 6e6F;
    }
    CHECK(most_reference(b) == Approx(0.2));
    CHECK(b.command.state == State::braking);
}

TEST_CASE("a reference that has retreated stays so within a landing", "[CTL-315]") {
    Bench b;
    to_retreated(b);
    SECTION("after a lock") {
        slip_to(b, 0.9);
        REQUIRE(b.command.state == State::locked_wheel);
        slip_to(b, 0.07);
    }
    SECTION("after the demand was taken back") {
        b.sensors.maneuver.demand_Pa = 0.0F;
        b.seconds(0.2);
        REQUIRE(b.command.state == State::armed);
        b.sensors.maneuver.demand_Pa = 6e6F;
        b.steps(1);
    }
    SECTION("after another law") {
        b.sensors.maneuver.law = Law::threshold;
        b.seconds(0.1);
        b.sensors.maneuver.law = Law::wheel_slip;
        b.steps(1);
    }
    REQUIRE(b.command.state == State::braking);
    CHECK(most_reference(b) < 0.15F);
}

TEST_CASE("the slip of most friction is sought from its start on each landing, and told", "[CTL-344]") {
    Config config = fixed_config();
    config.peak.swing = 0.0F;
    config.peak.elasticity = -1.0F;  // always upwards
    Bench b(config);
    const auto land = [&b] {
        float first = 0.0F;
        b.sensors.maneuver.arm = true;
        b.sensors.maneuver.weight_on_wheels = true;
        b.spin_up();
        b.slip = 0.07;
        b.seconds(0.3);
        b.sensors.maneuver.demand_Pa = 6e6F;
        for (int i = 0; i < 40; ++i) first = b.step().slip_reference;
        return first;
    };
    b.to_standby();
    b.sensors.maneuver.law = Law::peak_slip;
    const float begins = land();
    CHECK(begins == Approx(0.16).epsilon(0.2));
    b.seconds(1.0);
    REQUIRE(b.command.state == State::braking);
    CHECK(b.command.slip_reference == 0.4F);
    SECTION("not on the same landing") {
        b.sensors.maneuver.demand_Pa = 0.0F;
        b.seconds(0.2);
        REQUIRE(b.command.state == State::armed);
        b.sensors.maneuver.demand_Pa = 6e6F;
        b.steps(40);
        CHECK(b.command.slip_reference == 0.4F);
    }
    SECTION("not after a lock") {
        slip_to(b, 0.9);
        REQUIRE(b.command.state == State::locked_wheel);
        slip_to(b, 0.07);
        b.steps(40);
        REQUIRE(b.command.state == State::braking);
        CHECK(b.command.slip_reference > 0.25F);  // from its start 40 ms take it to 0.19 at the most
    }
    SECTION("on the next one") {
        b.sensors.maneuver.demand_Pa = 0.0F;
        b.seconds(0.2);
        b.sensors.maneuver.arm = false;
        b.sensors.maneuver.weight_on_wheels = false;
        b.slip = 1.0;
        b.seconds(0.3);
        REQUIRE(b.command.state == State::standby);
        CHECK(land() == Approx(begins).epsilon(0.02));
    }
}

TEST_CASE("the bias outlasts a lock, neither another law nor a landing", "[CTL-334]") {
    Config config = fixed_config();
    config.pressure_bias.most_bias_share = 1.0F;
    Bench b(config);
    b.to_braking(Law::pressure_bias);
    b.sensors.maneuver.demand_Pa = 20e6F;
    slip_to(b, 0.3);
    b.seconds(0.05);
    slip_to(b, 0.07);
    const float biased_Pa = b.command.pressure_request_Pa;
    slip_to(b, 0.9);
    REQUIRE(b.command.state == State::locked_wheel);
    REQUIRE(b.command.pressure_request_Pa == 0.0F);
    const auto come_back = [&b] {
        while (b.command.state == State::locked_wheel) slip_to(b, b.slip - 0.01);
        REQUIRE(b.command.state == State::braking);
        return b.command.pressure_request_Pa;
    };
    SECTION("back with the same law") {
        const float back_Pa = come_back();
        CHECK(back_Pa < biased_Pa);
        CHECK(back_Pa > 3e6F);
        CHECK(b.step().pressure_request_Pa == Approx(back_Pa + 4e3F));
    }
    SECTION("another law in between: from the present pressure") {
        b.sensors.maneuver.law = Law::threshold;
        static_cast<void>(come_back());
        slip_to(b, 0.9);
        REQUIRE(b.command.state == State::locked_wheel);
        b.sensors.maneuver.law = Law::pressure_bias;
        CHECK(come_back() == Approx(64e3).margin(30e3));
    }
    SECTION("on the next landing the wheel is locked from the first: from the present pressure, slowly") {
        b.sensors.maneuver.arm = false;
        b.sensors.maneuver.demand_Pa = 0.0F;
        slip_to(b, 0.07);
        REQUIRE(b.command.state == State::standby);
        b.sensors.maneuver.arm = true;
        b.steps(2);
        REQUIRE(b.command.state == State::armed);
        slip_to(b, 0.9);
        b.sensors.maneuver.demand_Pa = 20e6F;
        b.steps(2);
        REQUIRE(b.command.state == State::locked_wheel);
        CHECK(come_back() == Approx(4e3).margin(30e3));
    }
}

TEST_CASE("from a reading below none the demand passes through from none", "[CTL-064]") {
    Bench b;
    b.to_braking();
    b.sensors.maneuver.demand_Pa = 0.3e6F;
    b.tamper = [](Sensors& seen) { seen.pressure.pressure_Pa = -0.4e6F; };
    while (b.command.state == State::braking) {
        b.v_mps -= 8e-3;
        static_cast<void>(b.step());
    }
    REQUIRE(b.command.state == State::drop_out);
    CHECK(b.command.pressure_request_Pa == 0.0F);
    CHECK(b.command.current_mA == b.config.valve.safe_current_mA);
}

TEST_CASE("estimates can be looked at, and the state is told", "[CTL-066]") {
    Bench b;
    b.to_braking();
    CHECK(b.command.speed_mps == b.controller.estimate().v_mps);
    CHECK(b.command.wheel_speed_radps == b.controller.estimate().omega_radps);
    CHECK(b.command.slip == b.controller.estimate().slip);
    CHECK(b.command.slip == Approx(0.07).margin(0.02));
    CHECK(b.command.speed_mps == Approx(40.0).epsilon(1e-3));
    CHECK(b.command.slip_reference == Approx(0.07F));
    b.slip = 0.8;
    while (b.step().state == State::braking) {
    }
    CHECK(b.command.state == State::locked_wheel);
    CHECK(b.command.current_mA == 0.0F);
}

TEST_CASE("a command that nobody has decided says nothing and asks for nothing", "[CTL-066]") {
    const std::vector<Command> undecided(1);
    CHECK(undecided[0].current_mA == 0.0F);
    CHECK(undecided[0].slip == 0.0F);
    CHECK(undecided[0].speed_mps == 0.0F);
    CHECK(undecided[0].wheel_speed_radps == 0.0F);
    CHECK(undecided[0].pressure_request_Pa == 0.0F);
}
