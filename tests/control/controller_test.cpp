// The controller as a whole: the demand is the ceiling, the current stays in its range, nothing is ever no number, changes are bumpless.
#include "firmware/control/controller.hpp"

#include <algorithm>
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
    return std::isfinite(c.current_mA) && std::isfinite(c.slip) && std::isfinite(c.slip_reference) && std::isfinite(c.speed_mps) &&
           std::isfinite(c.wheel_speed_radps) && std::isfinite(c.pressure_request_Pa);
}

/// What does not hold of a command that must hold of every one, whatever came in; "" if all does.
std::string wrong_with(const Command& c, const Sensors& seen, const Config& config) {
    const float demand_Pa = seen.maneuver.demand_Pa;
    if (!finite(c)) return "no number";
    if (c.current_mA < config.valve.safe_current_mA) return "current below the safe one";
    if (c.current_mA > config.valve.current_mA[static_cast<std::size_t>(config.valve.points - 1)]) return "current above the map";
    if (c.pressure_request_Pa < 0.0F) return "request below none";
    if (c.pressure_request_Pa > config.valve.full_pressure_Pa) return "request above full pressure";
    if (c.state == State::braking || c.state == State::drop_out) {
        if (!(c.pressure_request_Pa <= demand_Pa)) return "request above the demand";
        if (!(valve_pressure_Pa(config.valve, c.current_mA) <= demand_Pa * (1.0F + 1e-6F) + 1.0F)) return "current above the demand";
    } else {
        if (c.current_mA != config.valve.safe_current_mA) return "not braking, current not safe";
        if (c.pressure_request_Pa != 0.0F) return "not braking, pressure asked for";
        if (c.slip_reference != 0.0F) return "not braking, a slip reference in force";
    }
    const bool searches = c.state == State::braking && seen.maneuver.law == Law::peak_slip;
    if (!searches && (c.road.peak_slip != 0.0F || c.road.grip_N != 0.0F || c.road.confidence != 0.0F)) return "a road found without a search";
    if (c.slip < -1.0F || c.slip > 1.0F) return "slip out of range";
    if (c.state == State::safe && c.faults.empty()) return "safe without a name";
    return {};
}

/// Thousands of times a test: nothing is put into words unless it is wrong.
void check_command(const Command& c, const Sensors& seen, const Config& config, unsigned seed, int step) {
    const std::string wrong = wrong_with(c, seen, config);
    if (!wrong.empty()) FAIL(wrong << ": seed " << seed << ", step " << step << ", state " << static_cast<int>(c.state));
}

}  // namespace

TEST_CASE("the pressure request is never above the demand", "[CTL-061]") {
    const auto seed = static_cast<unsigned>(GENERATE(range(0, 12)));
    std::mt19937 random(seed);
    const auto between = [&random](const double a, const double b) { return std::uniform_real_distribution<>(a, b)(random); };
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

TEST_CASE("no input whatever makes a command that is no number or out of range", "[CTL-061]") {
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
        return pick < kNasty.size() ? kNasty[pick] : std::bit_cast<float>(static_cast<std::uint32_t>(random()));
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

TEST_CASE("open loop is the commanded current, limited by the demand", "[CTL-061]") {
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

TEST_CASE("a command that did not leave is not taken for given: the valve holds the one before", "[CTL-020]") {
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

TEST_CASE("a valve that gives less than its map is asked for more where a pressure is meant", "[CTL-020]") {
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
        CHECK(baseline.command.current_mA == antiskid::control::valve_current_mA(config.valve, baseline.command.pressure_request_Pa));
    }

    Bench slip(config);
    slip.to_braking();
    slip.tamper = b.tamper;
    slip.slip = 0.05;  // short of the reference: all of the demand
    slip.seconds(1.0);
    REQUIRE(slip.command.pressure_request_Pa > 1e6F);
    CHECK(slip.command.current_mA > antiskid::control::valve_current_mA(config.valve, slip.command.pressure_request_Pa));
}

TEST_CASE("estimates can be looked at, and the state is told", "[CTL-076]") {
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

TEST_CASE("a command that nobody has decided says nothing and asks for nothing", "[CTL-076]") {
    const std::vector<Command> undecided(1);
    CHECK(undecided[0].current_mA == 0.0F);
    CHECK(undecided[0].slip == 0.0F);
    CHECK(undecided[0].speed_mps == 0.0F);
    CHECK(undecided[0].wheel_speed_radps == 0.0F);
    CHECK(undecided[0].pressure_request_Pa == 0.0F);
}
