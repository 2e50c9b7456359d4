// The checks by themselves: on which side of each limit a fault begins.
#include <cmath>
#include <initializer_list>
#include <utility>

#include "tests/catch.hpp"
#include "tests/control/watch.hpp"

using namespace antiskid::control;
using control_test::exact_config;
using control_test::fixed_config;
using control_test::kMillisecond;
using control_test::Watch;

namespace {

FaultSet set_of(std::initializer_list<Fault> faults) {
    FaultSet set;
    for (const Fault fault : faults) set.insert(fault);
    return set;
}

}  // namespace

TEST_CASE("what has never come is lost, not corrupt, and nothing else is said of it", "[CTL-081]") {
    Watch w;
    const FaultSet lost = set_of({Fault::wheel_lost, Fault::flywheel_lost, Fault::pressure_lost, Fault::maneuver_lost, Fault::heartbeat_lost});
    for (int k = 0; k < 50; ++k) {
        w.now += kMillisecond;
        REQUIRE(w.silent_step() == lost);
    }
    w.sensors.wheel.rejected = 1;  // one that came and was refused
    CHECK(w.silent_step().contains(Fault::wheel_corrupt));
}

TEST_CASE("at rest nothing is wrong, and the ages are allowed to their last nanosecond", "[CTL-081]") {
    Watch w;
    for (int k = 0; k < 2000; ++k) REQUIRE(w.step().empty());
    const Time last = w.now;
    const auto after = [&](const Time age) {
        w.now = last + age;
        return w.silent_step();
    };
    CHECK(after(Time{20'000'000}).empty());
    const FaultSet sensors = set_of({Fault::wheel_lost, Fault::flywheel_lost, Fault::pressure_lost});
    CHECK(after(Time{20'000'100}) == sensors);
    CHECK(after(Time{100'000'000}) == sensors);
    FaultSet command = sensors;
    command.insert(Fault::maneuver_lost);
    CHECK(after(Time{100'000'100}) == command);
    CHECK(after(Time{350'000'000}) == command);
    CHECK(after(Time{350'000'100}).contains(Fault::heartbeat_lost));
}

TEST_CASE("more refused frames than the maximum age has periods are corrupt", "[CTL-081]") {
    // 20 periods. The good frame among them pays for one, and good ones before them are no credit.
    const std::uint32_t rejected = GENERATE(21U, 22U);
    const int before = GENERATE(0, 5);
    Watch w(exact_config());
    for (int k = 0; k < before; ++k) REQUIRE(w.step().empty());
    w.sensors.wheel.rejected = rejected;
    CHECK(w.step().contains(Fault::wheel_corrupt) == (rejected == 22U));
}

TEST_CASE("good frames pay for refused ones, to the end", "[CTL-081]") {
    Watch w(exact_config());
    w.sensors.pressure.rejected = 22;
    CHECK(w.step() == set_of({Fault::pressure_corrupt}));
    CHECK(w.step().empty());
    // A count that goes back, or by half of its range, is another sensor, not two thousand million frames.
    w.sensors.pressure.rejected = 0;
    CHECK(w.step().empty());
    w.sensors.pressure.rejected = 0x8000'0000U;
    CHECK(w.step().empty());
    // It cannot owe more than twice the limit of 20.5: the first good frame takes it to 40, the twentieth below.
    w.sensors.pressure.rejected += 1000;
    for (int k = 0; k < 20; ++k) CHECK(w.step() == set_of({Fault::pressure_corrupt}));
    CHECK(w.step().empty());
    // What was refused long ago does not make a silent sensor a corrupt one.
    w.now += Time{30'000'000};
    CHECK(w.silent_step().contains(Fault::pressure_lost));
    CHECK_FALSE(w.silent_step().contains(Fault::pressure_corrupt));
}

TEST_CASE("the limits themselves are allowed", "[CTL-081]") {
    Watch w;
    const auto stays = [&] {
        FaultSet all;
        for (int k = 0; k < 50; ++k) all.insert(w.step());
        return all;
    };
    ManeuverInput& m = w.sensors.maneuver;
    m.demand_Pa = 25e6F;
    m.slip_reference = 0.5F;
    m.deceleration_mps2 = 15.0F;
    m.current_mA = 100.0F;
    m.law = Law::peak_slip;
    CHECK(stays().empty());
    m = {};
    CHECK(stays().empty());
    w.sensors.pressure.pressure_Pa = -0.5e6F;
    CHECK_FALSE(stays().contains(Fault::pressure_range));
    w.sensors.pressure.pressure_Pa = 25e6F;
    CHECK_FALSE(stays().contains(Fault::pressure_range));
    w.sensors.wheel.speed_radps = 400.0F;
    w.sensors.flywheel.speed_radps = 250.0F;
    CHECK_FALSE(stays().contains(Fault::wheel_range));
    CHECK_FALSE(stays().contains(Fault::flywheel_range));
}

TEST_CASE("the fastest change that is allowed is allowed", "[CTL-081]") {
    Watch w(exact_config());
    w.sensors.wheel.speed_radps = 100.0F;
    w.step();
    w.sensors.wheel.speed_radps = 132.0F;
    w.sensors.pressure.pressure_Pa = 1e6F;
    FaultSet faults = w.step();
    CHECK_FALSE(faults.contains(Fault::wheel_rate));
    CHECK_FALSE(faults.contains(Fault::pressure_rate));
    w.sensors.wheel.speed_radps = std::nextafter(164.0F, 200.0F);
    w.sensors.pressure.pressure_Pa = std::nextafter(2e6F, 3e6F);
    faults = w.step();
    CHECK(faults.contains(Fault::wheel_rate));
    CHECK(faults.contains(Fault::pressure_rate));
}

TEST_CASE("readings that come every other period are counted as often as they come", "[CTL-081]") {
    Watch w;
    w.step();
    for (int jump = 1; jump <= 5; ++jump) {
        w.now += kMillisecond;
        w.silent_step();
        w.sensors.pressure.pressure_Pa = jump % 2 == 1 ? 20e6F : 0.0F;
        CHECK(w.step().contains(Fault::pressure_rate) == (jump == 5));
    }
}

TEST_CASE("a modelled change, a difference and a speed exactly at their limits", "[CTL-081]") {
    // What model and tracker settle on is asked of them, and then made the limit.
    const auto run = [](Watch& w) {
        w.current_mA = 9.0F;
        w.sensors.flywheel.speed_radps = 30.0F;
        FaultSet all;
        for (int k = 0; k < 3000; ++k) all.insert(w.step());
        return all;
    };
    Watch first;
    run(first);
    const float settled_Pa = first.estimator.uncorrected_pressure_Pa();
    REQUIRE(settled_Pa > 2e6F);
    const bool beyond = GENERATE(false, true);
    const auto limit = [beyond](const float value) { return beyond ? std::nextafter(value, 0.0F) : value; };
    Config config = fixed_config();
    config.monitor.off_command_s = config.monitor.stuck_s;
    config.monitor.pressure_moves_Pa = limit(settled_Pa);
    config.monitor.off_command_Pa = 1e9F;
    Watch moves(config);
    CHECK(run(moves).contains(Fault::pressure_stuck) == beyond);
    std::swap(config.monitor.pressure_moves_Pa, config.monitor.off_command_Pa);
    Watch off(config);
    CHECK(run(off).contains(Fault::pressure_off_command) == beyond);

    config = fixed_config();
    config.monitor.plausible_above_mps = limit(first.estimator.estimate().v_mps);
    Watch third(config);
    third.sensors.maneuver.weight_on_wheels = true;
    third.sensors.flywheel.speed_radps = 30.0F;
    third.sensors.pressure.pressure_Pa = 0.6e6F;  // stays without a current, on a rig that moves
    FaultSet all;
    for (int k = 0; k < 1000; ++k) all.insert(third.step());
    CHECK(all.contains(Fault::pressure_off_command) == beyond);
}

TEST_CASE("the first reading of a sensor that starts late is no jump", "[CTL-085]") {
    Config config = fixed_config();
    config.monitor.implausible_s = config.period_s;  // a single jump is named
    config.monitor.pressure_rate_Paps = 1e6F;
    Watch w(config);
    w.sensors.wheel.speed_radps = 180.0F;
    w.sensors.flywheel.speed_radps = 100.0F;
    w.sensors.pressure.pressure_Pa = 24e6F;
    const FaultSet first = w.step();
    CHECK_FALSE(first.contains(Fault::wheel_rate));
    CHECK_FALSE(first.contains(Fault::flywheel_rate));
    CHECK_FALSE(first.contains(Fault::pressure_rate));
    w.sensors.wheel.speed_radps = 180.0F + 29.9F;  // 30,000 rad/s2
    CHECK_FALSE(w.step().contains(Fault::wheel_rate));
    w.sensors.wheel.speed_radps = 180.0F - 0.2F;
    CHECK(w.step().contains(Fault::wheel_rate));
    CHECK_FALSE(w.step().contains(Fault::wheel_rate));
}

TEST_CASE("ten good periods pay for a missed one, not nine", "[CTL-081]") {
    // Ten missed periods are the limit; the eleventh is named.
    const int good = GENERATE(9, 10);
    Watch w;
    w.sensors.missed_periods = 10;
    REQUIRE(w.step().empty());
    w.sensors.missed_periods = 0;
    for (int k = 0; k < good - 1; ++k) REQUIRE(w.step().empty());
    w.sensors.missed_periods = 1;  // comes in a good period itself
    CHECK(w.step().contains(Fault::overrun) == (good == 9));
}

TEST_CASE("a missed period that has been paid for leaves nothing behind", "[CTL-081]") {
    Watch w;
    w.sensors.missed_periods = 1;
    REQUIRE(w.step().empty());
    w.sensors.missed_periods = 0;
    for (int k = 0; k < 20; ++k) REQUIRE(w.step().empty());
    w.sensors.missed_periods = 10;
    CHECK(w.step().empty());
    // Nor does a long stall owe more than the limit: it is named once.
    w.sensors.missed_periods = 50;
    CHECK(w.step() == set_of({Fault::overrun}));
    w.sensors.missed_periods = 0;
    CHECK(w.step().empty());
}

TEST_CASE("an aircraft loses its most deceleration at most: a reference that falls faster is believed for a while", "[CTL-081]") {
    const float fall_mps2 = GENERATE(14.0F, 30.0F);
    Watch w;
    float v = 60.0F, carried = 60.0F;
    bool named = false;
    for (; v > 4.0F && !named; v -= fall_mps2 * 1e-3F, carried -= 15e-3F) {
        w.sensors.flywheel.speed_radps = v / 0.6F;
        named = w.step().contains(Fault::flywheel_stuck);
    }
    CHECK(named == (fall_mps2 > 15.0F));
    if (named) {
        CHECK(v / carried == Approx(0.85F).epsilon(0.02));  // less by overspeed_share
    }
}

TEST_CASE("an encoder at the least that the aircraft must still have is believed, one below is not", "[CTL-081]") {
    // 64 m/s, less 16 m/s2 over 1/1024 s, is 63.984375 m/s.
    constexpr float kCarried_mps = 63.984375F;
    struct Row {
        float plausible_above_mps, reading_mps;
        bool named;
    };
    const Row row = GENERATE(values<Row>({{8.0F, 0.5F * kCarried_mps, false},
                                          {8.0F, std::nextafter(0.5F * kCarried_mps, 0.0F), true},
                                          {kCarried_mps, 0.0F, false},
                                          {std::nextafter(kCarried_mps, 0.0F), 0.0F, true}}));
    Config config = exact_config();
    config.monitor.plausible_above_mps = row.plausible_above_mps;
    config.monitor.overspeed_share = 0.5F;
    config.monitor.max_deceleration_mps2 = 16.0F;
    config.monitor.stuck_s = 1.0F;
    Watch w(config);
    w.sensors.flywheel.speed_radps = 128.0F;
    REQUIRE_FALSE(w.step().contains(Fault::flywheel_stuck));
    w.sensors.flywheel.speed_radps = 2.0F * row.reading_mps;
    CHECK(w.step().contains(Fault::flywheel_stuck) == row.named);
}

TEST_CASE("a big drum's speed is what its rim has", "[CTL-081]") {
    Config config = fixed_config();
    config.flywheel.radius_m = 1.5F;
    Watch w(config);
    w.sensors.flywheel.speed_radps = 240.0F;
    for (int k = 0; k < 10; ++k) REQUIRE_FALSE(w.step().contains(Fault::flywheel_stuck));
    w.sensors.flywheel.speed_radps = 100.0F;  // less than half
    FaultSet all;
    for (int k = 0; k < 10; ++k) all.insert(w.step());
    CHECK(all.contains(Fault::flywheel_stuck));
}

TEST_CASE("a wheel that turns on a flywheel that never did", "[CTL-081]") {
    Watch w;
    w.sensors.wheel.speed_radps = 100.0F;
    int period = 0;
    while (period < 1000 && !w.step().contains(Fault::flywheel_stuck)) ++period;
    CHECK(period + 1 == 250);
}

TEST_CASE("rim speeds and slip exactly at their limits", "[CTL-081]") {
    struct Row {
        float flywheel_radps, wheel_radps, plausible_above_mps;
        bool rolling, disagree;
    };
    // Radii of 0.5 m; overspeed by a quarter, free slip of a quarter.
    const Row row = GENERATE(values<Row>({{128.0F, 160.0F, 8.0F, false, false},
                                          {128.0F, std::nextafter(160.0F, 200.0F), 8.0F, false, true},
                                          {0.0F, 32.0F, 16.0F, false, false},
                                          {0.0F, std::nextafter(32.0F, 40.0F), 16.0F, false, true},
                                          {128.0F, 96.0F, 8.0F, true, false},
                                          {128.0F, 95.9F, 8.0F, true, true}}));
    Config config = exact_config();
    config.monitor.overspeed_share = 0.25F;
    config.monitor.free_slip = 0.25F;
    config.monitor.plausible_above_mps = row.plausible_above_mps;
    Watch w(config);
    w.previous.rolling = row.rolling;
    w.sensors.flywheel.speed_radps = row.flywheel_radps;
    w.sensors.wheel.speed_radps = row.wheel_radps;
    const FaultSet faults = w.step();
    CHECK(faults.contains(Fault::speeds_disagree) == row.disagree);
    CHECK(faults.contains(Fault::flywheel_stuck) == (row.flywheel_radps == 0.0F && row.disagree));
}

TEST_CASE("more refused maneuver commands than its maximum age has frames are corrupt", "[CTL-081]") {
    // 0.1 s and 10 ms; the good frame among them pays for one.
    const float period_s = GENERATE(1e-3F, 5e-3F);
    const std::uint32_t rejected = GENERATE(11U, 12U);
    Watch w(fixed_config(period_s));
    REQUIRE(w.step().empty());
    w.sensors.maneuver.rejected = rejected;
    CHECK(w.step().contains(Fault::maneuver_corrupt) == (rejected == 12U));
}

TEST_CASE("a landed aircraft gets faster by no more than it can lose and the share, and only above the least speed", "[CTL-081]") {
    struct Row {
        float before_mps, after_mps;
        bool rolling, armed, named;
    };
    // 8 m/s and 16 m/s2 over 1/1024 s, and a quarter more.
    constexpr float kMax_mps = 10.01953125F;
    const Row row = GENERATE(values<Row>({{8.0F, kMax_mps, true, true, false},
                                          {8.0F, std::nextafter(kMax_mps, 20.0F), true, true, true},
                                          {8.0F, 20.0F, false, true, false},
                                          {8.0F, 20.0F, true, false, false},
                                          {8.0F, 20.0F, true, true, true},
                                          {2.0F, 4.0F, true, true, false},
                                          {2.0F, std::nextafter(4.0F, 5.0F), true, true, true},
                                          {64.0F, 125.0F, true, true, true}}));  // the encoder's last
    Config config = exact_config();
    config.flywheel.encoder.max_acceleration_radps2 = 1e9F;
    config.monitor.overspeed_share = 0.25F;
    config.monitor.max_deceleration_mps2 = 16.0F;
    config.monitor.plausible_above_mps = 4.0F;
    Watch w(config);
    w.sensors.maneuver.arm = row.armed;
    w.sensors.flywheel.speed_radps = 2.0F * row.before_mps;
    REQUIRE_FALSE(w.step().contains(Fault::flywheel_rate));
    w.previous.rolling = row.rolling;
    REQUIRE_FALSE(w.step().contains(Fault::flywheel_rate));
    w.sensors.flywheel.speed_radps = 2.0F * row.after_mps;
    CHECK(w.step().contains(Fault::flywheel_rate) == row.named);
}

TEST_CASE("a set of faults from the bus holds the faults that exist", "[CTL-081]") {
    CHECK(FaultSet::from_bits(0xFFFF'FFFFU).bits() == 0x03FF'FFFFU);
    for (unsigned i = 0; i < 32; ++i) {
        const FaultSet one = FaultSet::from_bits(1U << i);
        CHECK(one.empty() == (i >= kFaultCount));
        for (unsigned k = 0; k < kFaultCount; ++k) CHECK(one.contains(static_cast<Fault>(k)) == (i == k));
    }
}

TEST_CASE("a jump that misplaced teeth explain is none", "[CTL-040]") {
    // 60 teeth, 1/1024 s: three times 2 % of a pitch are 6.43 rad/s; 1,000 rad/s2 allow 0.98 more.
    const bool misplaced = GENERATE(false, true);
    Config config = control_test::exact_config();
    config.flywheel.encoder.max_acceleration_radps2 = 1024.0F;
    config.flywheel.encoder.pitch_error = misplaced ? 0.02F : 0.0F;
    config.monitor.implausible_s = config.period_s;
    const auto named = [&](float jump_radps) {
        control_test::Watch w(config);
        w.sensors.flywheel.speed_radps = w.sensors.wheel.speed_radps = 64.0F;
        for (int i = 0; i < 300; ++i) w.step();
        w.sensors.flywheel.speed_radps += jump_radps;
        return w.step().contains(Fault::flywheel_rate);
    };
    CHECK_FALSE(named(0.99F));
    CHECK(named(1.01F) == !misplaced);
    CHECK(named(7.4F) == !misplaced);
    CHECK(named(7.5F));
}
