// Readings that look right one by one: encoders that count backwards or report late, slip and pressure against what the law means.
#include "firmware/control/arithmetic.hpp"
#include "tests/catch.hpp"
#include "tests/control/watch.hpp"

using namespace antiskid::control;
using control_test::exact_config;
using control_test::fixed_config;
using control_test::kMillisecond;
using control_test::Watch;

namespace {

/// A wheel encoder whose count goes on by `step` in every fourth period, its frames `late` after them.
struct Encoder {
    Watch watch;
    int period = 0;

    FaultSet turn(const std::uint32_t step, const Time late = Time{}) {
        SpeedInput& wheel = watch.sensors.wheel;
        wheel.source = SpeedSource::edges;
        watch.sensors.flywheel.speed_radps = 14.0F;  // as the wheel's rim
        if (period++ % 4 == 0) {
            wheel.edge_count += step;
            wheel.edge_time = watch.now + kMillisecond - late;
        }
        return watch.step();
    }
};

}  // namespace

TEST_CASE("an encoder that counts backwards is out of range, however seldom an edge comes", "[CTL-081]") {
    Encoder e;
    for (int k = 0; k < 400; ++k) REQUIRE((e.turn(1).empty() || k < 300));
    int periods = 1;
    while (!e.turn(0U - 1U).contains(Fault::wheel_range)) REQUIRE(++periods < 100);
    // The limit counts readings: five edges, one in four periods.
    CHECK(periods == 17);
}

TEST_CASE("frames that come late after their edges are lost ones, one alone is not", "[CTL-081]") {
    Encoder e;
    for (int k = 0; k < 400; ++k) REQUIRE((e.turn(1).empty() || k < 300));
    const auto fall_behind = [&e](const int to_ms) {
        for (int ms = 1; ms <= to_ms; ++ms) {
            for (int k = 0; k < 4; ++k) REQUIRE(e.turn(1, ms * kMillisecond).empty());
        }
    };
    SECTION("half of the maximum age is allowed for ever") {
        fall_behind(9);
        for (int k = 0; k < 4000; ++k) REQUIRE(e.turn(1, Time{9'900'000}).empty());
    }
    SECTION("more are named at the second reading") {
        fall_behind(9);
        int periods = 1;
        while (!e.turn(1, Time{11'000'000}).contains(Fault::wheel_lost)) REQUIRE(++periods < 100);
        CHECK(periods == 5);
    }
    SECTION("a clock that runs slower by 1e-4 is followed") {
        for (int k = 0; k < 400'000; ++k) REQUIRE(e.turn(1, Time{100LL * k}).empty());
    }
}

TEST_CASE("slip above what the law asks for is named once it adds up", "[CTL-081][CTL-040]") {
    Config config = exact_config();
    config.monitor.stuck_s = 0.25F;
    config.monitor.free_slip = 0.9F;
    Watch w(config);
    w.current_mA = 8.0F;  // 2.1 MPa
    w.sensors.maneuver.law = Law::wheel_slip;
    w.previous = {.rolling = true, .braking = true, .slip_reference = 0.25F};
    const auto at = [&w](const float slip) {
        w.sensors.flywheel.speed_radps = 40.0F;  // too slow for its fall to be held against the brake
        w.sensors.wheel.speed_radps = 40.0F * (1.0F - slip);
        w.sensors.pressure.pressure_Pa = w.estimator.uncorrected_pressure_Pa();
        return w.step();
    };
    for (int k = 0; k < 2000; ++k) at(0.25F);
    REQUIRE(at(0.25F).empty());
    const auto periods_to_name = [&at](const float slip) {
        int periods = 1;
        while (!at(slip).contains(Fault::speeds_disagree) && periods < 5000) ++periods;
        return periods;
    };
    SECTION("0.05 above is allowed for ever") {
        CHECK(periods_to_name(0.2999F) == 5000);
    }
    SECTION("0.1 beyond that is named after a second") {
        CHECK(periods_to_name(0.4F) == Approx(1375).margin(30));  // 351 until the lowest slip of late has followed, 24 of the trackers' lag
    }
    SECTION("slip that comes back to what is asked for is allowed for ever") {
        for (int k = 0; k < 100; ++k) {
            for (int i = 0; i < 50; ++i) REQUIRE(at(0.6F).empty());
            for (int i = 0; i < 50; ++i) REQUIRE(at(0.2F).empty());
        }
    }
    SECTION("less slip pays back") {
        for (int k = 0; k < 20; ++k) {
            for (int i = 0; i < 500; ++i) REQUIRE(at(0.4F).empty());
            for (int i = 0; i < 600; ++i) REQUIRE(at(0.1F).empty());
        }
    }
    SECTION("not while no law brakes, nor under a law that asks for no slip") {
        const bool braking = GENERATE(true, false);
        w.previous.braking = braking;
        w.sensors.maneuver.law = braking ? Law::threshold : Law::wheel_slip;
        CHECK(periods_to_name(0.4F) == 5000);
    }
    SECTION("each braking begins anew") {
        for (int i = 0; i < 1000; ++i) REQUIRE(at(0.4F).empty());
        w.previous.braking = false;
        REQUIRE(at(0.4F).empty());
        w.previous.braking = true;
        CHECK(periods_to_name(0.4F) == Approx(1635).margin(30));  // the lowest slip of late begins at none
    }
    SECTION("without pressure neither more nor less") {
        const auto had = [&](int periods) {
            for (int i = 0; i < periods; ++i) REQUIRE(at(0.4F).empty());
        };
        had(700);
        w.current_mA = 0.0F;
        had(5000);
        for (int i = 0; i < 5000; ++i) REQUIRE(at(0.0F).empty());
        had(100);
        w.current_mA = 8.0F;
        CHECK(periods_to_name(0.4F) == Approx(675).margin(60));  // what was missing
    }
}

TEST_CASE("a valve off its map by more than is made up for is named", "[CTL-081]") {
    // 8 mA are 2.1 MPa; up to a quarter of it is made up for.
    struct Row {
        float short_Pa;
        Law law;
        bool braking, named;
        float current_mA = 8.0F;
    };
    const Row row = GENERATE(
        Row{0.50e6F, Law::wheel_slip, true, false}, Row{0.55e6F, Law::wheel_slip, true, true}, Row{-0.55e6F, Law::wheel_slip, true, true},
        Row{0.51e6F, Law::wheel_slip, true, false}, Row{0.55e6F, Law::wheel_slip, true, false, 5.4F}, Row{0.55e6F, Law::wheel_slip, true, true, 5.8F},
        Row{0.55e6F, Law::deceleration, true, true}, Row{0.55e6F, Law::open_loop, true, false}, Row{0.55e6F, Law::threshold, true, false},
        Row{0.55e6F, Law::pressure_bias, true, false}, Row{0.55e6F, Law::wheel_slip, false, false});
    Config config = fixed_config();
    config.estimator.valve_offset_radps = 7.0F;
    config.estimator.valve_offset_share = 0.25F;
    config.estimator.pressure_bandwidth_radps = 30.0F;
    Watch w(config);
    w.current_mA = row.current_mA;
    w.sensors.maneuver.law = row.law;
    w.previous.braking = row.braking;
    FaultSet faults;
    for (int k = 0; k < 3000; ++k) {
        w.sensors.pressure.pressure_Pa = larger(w.estimator.uncorrected_pressure_Pa() - row.short_Pa, 0.0F);
        faults = w.step();
    }
    CHECK(faults.contains(Fault::pressure_off_command) == row.named);
}

TEST_CASE("no offset, and no pressure, are exactly at their limits where these are none", "[CTL-081]") {
    const bool learns = GENERATE(false, true);
    Config config = fixed_config();
    config.supervisor.residual_pressure_Pa = 0.0F;
    config.estimator.valve_offset_radps = learns ? 7.0F : 0.0F;
    config.estimator.valve_offset_share = learns ? 0.25F : 0.0F;
    Watch w(config);
    w.sensors.maneuver.law = Law::wheel_slip;
    w.previous.braking = true;
    w.current_mA = learns ? 0.0F : 8.0F;
    w.sensors.pressure.pressure_Pa = learns ? 1e5F : 2.1e6F;
    for (int k = 0; k < 1000; ++k) REQUIRE_FALSE(w.step().contains(Fault::pressure_off_command));
}

TEST_CASE("an encoder that stands is not late before its first reading", "[CTL-081]") {
    Watch w;
    w.sensors.wheel.source = SpeedSource::edges;
    for (int k = 0; k < 200; ++k) REQUIRE(w.step().empty());
}
