// The state machine by itself: every transition, no other, and what each state needs.
#include "firmware/control/supervisor.hpp"

#include <array>
#include <cmath>
#include <random>

#include "tests/catch.hpp"
#include "tests/control/bench.hpp"

using namespace antiskid::control;
using control_test::Bench;
using control_test::fixed_config;

namespace {

constexpr float kPeriod_s = 1e-3F;
constexpr float kRadius_m = 0.32F;

/// One supervisor and its inputs.
struct Stand {
    Stand() {
        sensors.maneuver.received = Time{0};
        sensors.maneuver.law = Law::wheel_slip;
        estimate.speeds_known = true;
        estimate.radius_m = kRadius_m;
        move(0.0F, 0.0F);
    }
    void move(const float v, const float rim) {
        estimate.v_mps = v;
        estimate.omega_radps = rim / kRadius_m;
    }
    State step(const int count = 1) {
        for (int i = 0; i < count; ++i) supervisor.update(sensors, estimate, present, Time{});
        return supervisor.state();
    }
    /// Through the self-test, armed, landed at 50 m/s and rolling.
    void to_armed() {
        REQUIRE(step(60) == State::standby);
        sensors.maneuver.arm = true;
        REQUIRE(step() == State::armed);
        sensors.maneuver.weight_on_wheels = true;
        move(50.0F, 50.0F);
        REQUIRE(step() == State::armed);
    }
    void to_braking() {
        to_armed();
        sensors.maneuver.demand_Pa = 10e6F;
        REQUIRE(step() == State::braking);
    }

    Supervisor supervisor{fixed_config().supervisor, kPeriod_s};
    Sensors sensors;
    Estimate estimate;
    FaultSet present;
};

constexpr auto idx(const State s) {
    return static_cast<std::size_t>(s);
}

/// What may follow what, besides staying: the diagram of supervisor.hpp as a table. Rows and columns in the order of State.
constexpr std::array<std::array<bool, kStateCount>, kStateCount> kMayFollow{{
    //             self_test standby armed touchdown braking locked drop_out safe
    /* self_test */ {false, true, false, false, false, false, false, true},
    /* standby   */ {false, false, true, false, false, false, false, true},
    /* armed     */ {false, true, false, true, true, true, true, true},
    /* touchdown */ {false, true, true, false, true, true, true, true},
    /* braking   */ {false, true, true, false, false, true, true, true},
    /* locked    */ {false, true, true, false, true, false, true, true},
    /* drop_out  */ {false, true, true, false, true, true, false, true},
    /* safe      */ {false, true, false, false, false, false, false, false},
}};

}  // namespace

TEST_CASE("self-test needs good inputs, a wheel at rest and no pressure, all at once", "[CTL-070]") {
    Stand s;
    SECTION("passes after its time") {
        CHECK(s.step(49) == State::self_test);
        CHECK(s.step() == State::standby);
    }
    SECTION("speeds unknown") {
        s.estimate.speeds_known = false;
    }
    SECTION("wheel turns") {
        s.move(0.0F, 0.1F);
    }
    SECTION("pressure in the brake") {
        s.sensors.pressure.pressure_Pa = 0.6e6F;
    }
    SECTION("a fault") {
        s.present.insert(Fault::heartbeat_lost);
    }
    if (s.supervisor.state() == State::self_test) {
        CHECK(s.step(1000) == State::self_test);
        CHECK(s.supervisor.latched().empty());
        // Each interruption starts the time anew.
        s.present = {};
        s.estimate.speeds_known = true;
        s.move(0.0F, 0.0F);
        s.sensors.pressure.pressure_Pa = 0.0F;
        CHECK(s.step(30) == State::self_test);
        s.present.insert(Fault::wheel_lost);
        CHECK(s.step() == State::self_test);
        s.present = {};
        CHECK(s.step(49) == State::self_test);
        CHECK(s.step() == State::standby);
    }
}

TEST_CASE("pressure that does not go away fails the self-test, until it has gone", "[CTL-071]") {
    Stand s;
    s.sensors.pressure.pressure_Pa = 1e6F;
    CHECK(s.step(1999) == State::self_test);
    CHECK(s.step() == State::safe);
    CHECK(s.supervisor.latched().contains(Fault::self_test_failed));
    CHECK(s.step(1000) == State::safe);
    s.sensors.pressure.pressure_Pa = 0.0F;
    CHECK(s.step() == State::standby);
    CHECK(s.supervisor.latched().contains(Fault::self_test_failed));
    s.sensors.maneuver.arm = true;
    CHECK(s.step() == State::armed);
    CHECK(s.supervisor.latched().empty());
}

TEST_CASE("arming is an edge", "[CTL-072]") {
    Stand s;
    s.sensors.maneuver.arm =
        true;  // from the start: a stuck switch, or a controller restarted in the landing
    CHECK(s.step(1000) == State::standby);
    s.sensors.maneuver.arm = false;
    CHECK(s.step() == State::standby);
    s.sensors.maneuver.arm = true;
    CHECK(s.step() == State::armed);
    s.sensors.maneuver.arm = false;
    CHECK(s.step() == State::standby);
}

TEST_CASE("a command that has never come does not arm by coming", "[CTL-072]") {
    Bench b;
    b.v_mps = 0.0;
    b.tamper = [](Sensors& in) { in.maneuver = {}; };
    b.seconds(0.5);
    CHECK(b.command.state == State::self_test);
    b.tamper = nullptr;
    b.sensors.maneuver.arm = true;
    b.seconds(0.5);
    CHECK(b.command.state == State::standby);
}

TEST_CASE("touchdown protection ends with the wheel spun up or with its time", "[CTL-073]") {
    Stand s;
    REQUIRE(s.step(60) == State::standby);
    s.sensors.maneuver.arm = true;
    s.sensors.maneuver.demand_Pa = 20e6F;  // a pilot already on the pedals
    s.move(60.0F, 0.0F);
    CHECK(s.step(5000) == State::armed);  // in the air, for as long as it takes
    s.sensors.maneuver.weight_on_wheels = true;
    SECTION("spun up") {
        s.move(60.0F, 30.0F);
        CHECK(s.step(100) == State::touchdown_protection);
        s.move(60.0F, 30.1F);
        CHECK(s.step() == State::braking);
        // Once over it stays over, also for a slower wheel.
        s.move(25.0F, 22.0F);
        CHECK(s.step() == State::braking);
    }
    SECTION("a slow wheel that turns along") {
        s.move(25.0F, 17.4F);
        CHECK(s.step(100) == State::touchdown_protection);
        s.move(25.0F, 17.6F);
        CHECK(s.step() == State::braking);
    }
    SECTION("time") {
        s.move(25.0F, 17.0F);
        CHECK(s.step(2999) == State::touchdown_protection);
        CHECK(s.step() == State::braking);
    }
    SECTION("time, and a wheel that never turned, is a locked wheel") {
        CHECK(s.step(2999) == State::touchdown_protection);
        CHECK(s.step() == State::locked_wheel);
    }
    CHECK(s.supervisor.latched().empty());
}

TEST_CASE("a controller that starts on its wheels has not seen them spin up", "[CTL-073]") {
    Stand s;
    s.sensors.maneuver.weight_on_wheels = true;
    CHECK_FALSE(s.supervisor.rolling());
    REQUIRE(s.step(60) == State::standby);
    CHECK_FALSE(s.supervisor.rolling());
    s.sensors.maneuver.arm = true;
    s.sensors.maneuver.demand_Pa = 10e6F;
    s.move(25.0F, 17.0F);
    CHECK(s.step() == State::armed);
    CHECK(s.step() == State::touchdown_protection);
    CHECK_FALSE(s.supervisor.rolling());
    CHECK(s.step(3000) == State::braking);
    CHECK(s.supervisor.rolling());  // it should by now
}

TEST_CASE("a bounce is no fault and protects again", "[CTL-073]") {
    Stand s;
    s.to_braking();
    CHECK(s.supervisor.rolling());
    s.sensors.maneuver.weight_on_wheels = false;
    CHECK(s.step() == State::armed);
    CHECK_FALSE(s.supervisor.rolling());
    s.move(50.0F, 0.0F);  // the wheel stops in the air
    CHECK(s.step(700) == State::armed);
    s.sensors.maneuver.weight_on_wheels = true;
    CHECK(s.step(20) == State::touchdown_protection);
    s.move(50.0F, 35.0F);
    CHECK(s.step() == State::braking);
    // The time starts anew with each contact.
    s.sensors.maneuver.weight_on_wheels = false;
    s.step();
    s.move(28.0F, 19.0F);
    s.sensors.maneuver.weight_on_wheels = true;
    CHECK(s.step(2999) == State::touchdown_protection);
    CHECK(s.step() == State::braking);
    CHECK(s.supervisor.latched().empty());
}

TEST_CASE("a squat switch that opens for a moment costs that moment at every speed", "[CTL-276]") {
    const float v = GENERATE(5.1F, 12.0F, 29.0F, 45.0F);
    Stand s;
    s.to_braking();
    s.move(v, 0.8F * v);
    s.sensors.maneuver.weight_on_wheels = false;
    CHECK(s.step(20) == State::armed);
    s.sensors.maneuver.weight_on_wheels = true;
    CHECK(s.step() == State::braking);
}

TEST_CASE("a wheel below 30 % is released until 70 %", "[CTL-074]") {
    const auto law = GENERATE(Law::wheel_slip, Law::deceleration, Law::threshold);
    Stand s;
    s.to_braking();
    s.sensors.maneuver.law = law;
    s.move(50.0F, 15.1F);
    CHECK(s.step() == State::braking);
    s.move(50.0F, 14.9F);
    CHECK(s.step() == State::locked_wheel);
    s.move(50.0F, 34.9F);
    CHECK(s.step(500) == State::locked_wheel);
    s.move(50.0F, 35.1F);
    CHECK(s.step() == State::braking);
    s.move(50.0F, 20.0F);
    CHECK(s.step() == State::braking);
}

TEST_CASE("a lock that lasts is a fault, one that passes is none", "[CTL-074]") {
    Stand s;
    s.to_braking();
    for (int i = 0; i < 5; ++i) {
        s.move(50.0F, 5.0F);
        CHECK(s.step(999) == State::locked_wheel);
        s.move(50.0F, 40.0F);
        CHECK(s.step(2998) == State::braking);
    }
    s.move(50.0F, 5.0F);
    CHECK(s.step(999) == State::locked_wheel);
    CHECK(s.step() == State::safe);
    CHECK(s.supervisor.latched().contains(Fault::lock_persists));
    s.sensors.maneuver.arm = false;
    CHECK(s.step() == State::standby);
}

TEST_CASE("locks that recur are a fault, although none lasts", "[CTL-252]") {
    Stand s;
    s.to_braking();
    const auto cycle = [&s](const int locked, const int rolling) {
        s.move(50.0F, 5.0F);
        if (s.step(locked) == State::safe) return true;
        s.move(50.0F, 40.0F);
        return s.step(rolling) == State::safe;
    };
    SECTION("a quarter of the time is ridden out for ever") {
        for (int i = 0; i < 1000; ++i) REQUIRE_FALSE(cycle(20, 60));
    }
    SECTION("half of the time is two thirds of what lasts, each time") {
        int cycles = 1;
        while (!cycle(30, 30)) REQUIRE(++cycles < 100);
        CHECK(cycles == 50);  // 49 x (30 - 10) ms, and 20 of 30
        CHECK(s.supervisor.latched().contains(Fault::lock_persists));
    }
}

TEST_CASE("a slow wheel has to come back sooner", "[CTL-252]") {
    struct Row {
        float v_mps;
        int periods;
    };
    const Row row =
        GENERATE(Row{60.0F, 1000}, Row{30.0F, 1000}, Row{20.0F, 667}, Row{10.0F, 334}, Row{7.0F, 334});
    Stand s;
    s.to_braking();
    s.move(row.v_mps, 0.1F * row.v_mps);
    CHECK(s.step(row.periods - 1) == State::locked_wheel);
    CHECK(s.step() == State::safe);
}

TEST_CASE("open loop has no lock protection and no drop-out", "[CTL-074]") {
    Stand s;
    s.to_braking();
    s.sensors.maneuver.law = Law::open_loop;
    s.move(50.0F, 0.0F);
    CHECK(s.step(3000) == State::braking);
    s.move(1.0F, 1.0F);
    CHECK(s.step() == State::braking);
}

TEST_CASE("anti-skid drops out below 5 m/s and comes back above 6", "[CTL-075]") {
    const auto law = GENERATE(Law::wheel_slip, Law::threshold);
    Stand s;
    s.to_braking();
    s.sensors.maneuver.law = law;
    s.move(5.0F, 5.0F);
    CHECK(s.step() == State::braking);
    s.move(4.99F, 0.0F);
    CHECK(s.step() == State::drop_out);
    s.move(5.99F, 5.0F);
    CHECK(s.step() == State::drop_out);
    s.move(6.0F, 5.0F);
    CHECK(s.step() == State::braking);
    s.move(4.0F, 4.0F);
    CHECK(s.step() == State::drop_out);
    s.move(6.5F, 0.5F);
    CHECK(s.step() == State::locked_wheel);
    s.move(4.0F, 0.0F);
    CHECK(s.step(3000) == State::drop_out);
}

TEST_CASE("the deceleration law brakes to standstill", "[CTL-075]") {
    Stand s;
    s.to_braking();
    s.sensors.maneuver.law = Law::deceleration;
    for (const float v : {4.9F, 2.0F, 0.0F}) {
        s.move(v, 0.0F);
        CHECK(s.step() == State::braking);
    }
}

TEST_CASE("a demand below the threshold is none", "[CTL-075]") {
    Stand s;
    s.to_armed();
    s.sensors.maneuver.demand_Pa = 0.19e6F;
    CHECK(s.step() == State::armed);
    s.sensors.maneuver.demand_Pa = 0.2e6F;
    CHECK(s.step() == State::braking);
    s.sensors.maneuver.demand_Pa = 0.0F;
    CHECK(s.step() == State::armed);
}

TEST_CASE("safe is left by disarming with no cause left, names are cleared by arming again", "[CTL-076]") {
    Stand s;
    s.to_braking();
    s.present.insert(Fault::pressure_range);
    CHECK(s.step() == State::safe);
    s.present = {};
    CHECK(s.step(1000) == State::safe);  // gone, but still armed
    s.present.insert(Fault::wheel_lost);
    s.sensors.maneuver.arm = false;
    CHECK(s.step(1000) == State::safe);  // disarmed, but a cause is there
    CHECK(s.supervisor.latched().contains(Fault::pressure_range));
    CHECK(s.supervisor.latched().contains(Fault::wheel_lost));
    s.present = {};
    CHECK(s.step() == State::standby);
    CHECK(s.step(1000) == State::standby);
    CHECK_FALSE(s.supervisor.latched().empty());
    s.sensors.maneuver.arm = true;
    CHECK(s.step() == State::armed);
    CHECK(s.supervisor.latched().empty());
    CHECK(s.step() == State::braking);
}

TEST_CASE("arming again within the fault gives nothing", "[CTL-076]") {
    Stand s;
    s.to_braking();
    s.present.insert(Fault::bus_off);
    CHECK(s.step() == State::safe);
    for (int i = 0; i < 10; ++i) {
        s.sensors.maneuver.arm = i % 2 == 1;
        CHECK(s.step() == State::safe);
    }
    // Arming in the very period in which the cause goes away: it is a fresh look, but the edge is needed from standby.
    s.sensors.maneuver.arm = true;
    s.present = {};
    CHECK(s.step(10) == State::safe);
}

TEST_CASE("a fault in the period of arming wins", "[CTL-076]") {
    Stand s;
    REQUIRE(s.step(60) == State::standby);
    s.sensors.maneuver.arm = true;
    s.present.insert(Fault::overrun);
    CHECK(s.step() == State::safe);
    CHECK(s.supervisor.latched().contains(Fault::overrun));
}

TEST_CASE("a wheel, a pressure and a speed exactly at their limits", "[CTL-070][CTL-073][CTL-074]") {
    // Shares and a radius whose products with these speeds are exact.
    SupervisorConfig config = fixed_config().supervisor;
    config.lock_share = 0.25F;
    config.unlock_share = 0.75F;
    Stand s;
    s.supervisor = Supervisor(config, kPeriod_s);
    s.estimate.radius_m = 0.5F;
    const auto move = [&s](const float v, const float rim) {
        s.estimate.v_mps = v;
        s.estimate.omega_radps = 2.0F * rim;
    };
    SECTION("at rest is below 0.1 rad/s") {
        s.estimate.omega_radps = 0.1F;
        CHECK(s.step(200) == State::self_test);
        s.estimate.omega_radps = std::nextafter(0.1F, 0.0F);
        CHECK(s.step(50) == State::standby);
    }
    SECTION("no pressure is below the residual one") {
        s.sensors.pressure.pressure_Pa = 0.5e6F;
        CHECK(s.step(200) == State::self_test);
        s.sensors.pressure.pressure_Pa = std::nextafter(0.5e6F, 0.0F);
        CHECK(s.step(50) == State::standby);
    }
    SECTION("spun up is above its speed, a lock below its share, released from its share on") {
        REQUIRE(s.step(60) == State::standby);
        s.sensors.maneuver.arm = true;
        REQUIRE(s.step() == State::armed);
        s.sensors.maneuver.weight_on_wheels = true;
        s.sensors.maneuver.demand_Pa = 10e6F;
        move(40.0F, 30.0F);
        CHECK(s.step(10) == State::touchdown_protection);
        CHECK_FALSE(s.supervisor.rolling());
        move(40.0F, std::nextafter(30.0F, 31.0F));
        CHECK(s.step() == State::braking);
        CHECK(s.supervisor.rolling());
        // A slow wheel's share counts above the drop-out speed.
        s.sensors.maneuver.weight_on_wheels = false;
        s.step();
        s.sensors.maneuver.weight_on_wheels = true;
        move(20.0F, 15.0F);
        CHECK(s.step(10) == State::touchdown_protection);
        move(5.0F, 5.0F);
        CHECK(s.step(10) == State::touchdown_protection);
        move(20.0F, std::nextafter(15.0F, 16.0F));
        CHECK(s.step() == State::braking);
        move(40.0F, 10.0F);
        CHECK(s.step() == State::braking);
        move(40.0F, std::nextafter(10.0F, 0.0F));
        CHECK(s.step() == State::locked_wheel);
        move(40.0F, std::nextafter(30.0F, 0.0F));
        CHECK(s.step() == State::locked_wheel);
        // At the drop-out speed itself a lock is still one.
        move(5.0F, 2.5F);
        CHECK(s.step() == State::locked_wheel);
        move(40.0F, 30.0F);
        CHECK(s.step() == State::braking);
        s.sensors.maneuver.law = Law::deceleration;
        move(std::nextafter(5.0F, 0.0F), 1.0F);
        CHECK(s.step() == State::braking);
        move(5.0F, 1.0F);
        CHECK(s.step() == State::locked_wheel);
    }
}

TEST_CASE("random inputs make every transition of the table and no other", "[CTL-077]") {
    std::array<std::array<int, kStateCount>, kStateCount> seen{};
    std::mt19937 random(5);
    const auto chance = [&random](const double p) {
        return std::uniform_real_distribution<>(0.0, 1.0)(random) < p;
    };
    const auto between = [&random](const float a, const float b) {
        return std::uniform_real_distribution<float>(a, b)(random);
    };
    for (int run = 0; run < 400; ++run) {
        Stand s;
        State before = State::self_test;
        bool edge = false, disarmed = true;
        float on_wheels_s = 0.0F;
        bool spun_up = false;
        for (int k = 0; k < 6000; ++k) {
            const bool calm = run % 4 == 1;  // long enough on the wheels for the time-out
            const bool armed_before = s.sensors.maneuver.arm;
            if (chance(before == State::safe || before == State::standby ? 0.02 : calm ? 0.0001 : 0.002))
                s.sensors.maneuver.arm = !armed_before;
            if (chance(calm ? 0.0002 : 0.003))
                s.sensors.maneuver.weight_on_wheels = !s.sensors.maneuver.weight_on_wheels;
            if (chance(0.01)) s.sensors.maneuver.demand_Pa = chance(0.3) ? 0.0F : between(0.0F, 20e6F);
            if (chance(0.005)) s.sensors.maneuver.law = static_cast<Law>(random() % 4U);
            if (chance(0.02)) {
                const float v = chance(0.3) ? between(0.0F, 8.0F) : between(0.0F, calm ? 27.0F : 70.0F);
                s.move(v, chance(0.3) ? 0.0F : v * between(0.0F, calm ? 0.68F : 1.1F));
            }
            if (chance(0.01)) s.sensors.pressure.pressure_Pa = chance(0.8) ? 0.0F : 1e6F;
            if (before == State::self_test && run % 3 == 0) {
                s.move(0.0F, 0.0F);
                s.sensors.pressure.pressure_Pa = run % 2 == 0 ? 1e6F : 0.0F;
            }
            s.present = {};
            if (chance(before == State::self_test ? 0.0 : calm ? 0.0001 : 0.0007))
                s.present.insert(static_cast<Fault>(random() % kFaultCount));
            const bool faulty = !s.present.empty();

            const State after = s.step();
            // What the states need, said independently of the code.
            const ManeuverInput& m = s.sensors.maneuver;
            edge = m.arm && disarmed;
            disarmed = !m.arm;
            on_wheels_s = m.weight_on_wheels ? on_wheels_s + kPeriod_s : 0.0F;
            const float rim = s.estimate.omega_radps * kRadius_m;
            const bool along = s.estimate.v_mps > 5.0F && rim > 0.7F * s.estimate.v_mps;
            spun_up = m.weight_on_wheels && (spun_up || rim > 30.0F || along);
            const auto wrong = [&](const char* const what) {
                FAIL(what << ": run " << run << ", step " << k << ", " << idx(before) << " to "
                          << idx(after));
            };
            if (after != before) ++seen[idx(before)][idx(after)];
            if (after != before && !kMayFollow[idx(before)][idx(after)]) {
                wrong("a transition that is not in the table");
            }
            if (faulty && before != State::self_test && after != State::safe)
                wrong("a fault without reaction");
            const bool active = after != State::self_test && after != State::standby && after != State::safe;
            if (active && !m.arm) wrong("active without arm");
            if (before == State::standby && after == State::armed && !edge) wrong("armed without an edge");
            const bool brakes = after == State::braking || after == State::drop_out;
            if (brakes) {
                if (!m.weight_on_wheels) wrong("braking in the air");
                if (!spun_up && on_wheels_s < 2.998F) wrong("braking within touchdown protection");
                if (m.demand_Pa < 0.2e6F) wrong("braking without a demand");
            }
            if (after == State::touchdown_protection && (spun_up || !m.weight_on_wheels))
                wrong("protection without need");
            if (after == State::safe && s.supervisor.latched().empty()) wrong("safe without a name");
            if (after == State::braking && m.law != Law::open_loop && s.estimate.v_mps >= 6.0F &&
                s.estimate.omega_radps * kRadius_m < 0.299F * s.estimate.v_mps)
                wrong("braking a locked wheel");
            before = after;
        }
    }
    for (std::size_t from = 0; from < kStateCount; ++from) {
        for (std::size_t to = 0; to < kStateCount; ++to) {
            CAPTURE(from, to);
            CHECK((seen[from][to] > 0) == kMayFollow[from][to]);
        }
    }
}
