/// Ways around the protections that somebody tried: none may work.
#include <limits>

#include "firmware/host/controller_config.hpp"
#include "tests/catch.hpp"
#include "tests/control/bench.hpp"

namespace {

using namespace antiskid::control;
using control_test::Bench;

Config shipped() {
    return antiskid::load_controller_config("config/controller.toml");
}

void slow_to(Bench& b, double v_mps) {
    while (b.v_mps > v_mps) {
        b.v_mps -= 0.015;
        static_cast<void>(b.step());
    }
    REQUIRE(b.command.state == State::braking);
}

}  // namespace

TEST_CASE("a reference encoder that dies just above drop-out is a fault, not a drop-out with full demand", "[CTL-081]") {
    const double v_mps = GENERATE(5.5, 6.0, 7.5, 7.9, 12.0);
    CAPTURE(v_mps);
    Bench b(shipped());
    b.to_braking();
    slow_to(b, v_mps);
    b.sensors.maneuver.demand_Pa = 20e6F;
    const SpeedInput frozen = b.sensors.flywheel;
    b.tamper = [&](Sensors& seen) {
        seen.flywheel.edge_count = frozen.edge_count;
        seen.flywheel.edge_time = frozen.edge_time;
    };
    b.seconds(0.3);
    CHECK(b.command.state == State::safe);
    CHECK(b.command.faults.contains(Fault::flywheel_stuck));
    CHECK(b.command.current_mA == b.config.valve.safe_current_mA);
}

TEST_CASE("a sensor that is nonsense most of the time is a fault", "[CTL-081]") {
    Bench b(shipped());
    b.to_braking();
    int frame = 0;
    SECTION("wheel speed is no number in four of five frames") {
        b.tamper = [&](Sensors& seen) {
            seen.wheel.source = SpeedSource::speed;
            seen.wheel.speed_radps = ++frame % 5 == 0 ? 110.0F : std::numeric_limits<float>::quiet_NaN();
        };
        b.seconds(0.1);
        CHECK(b.command.faults.contains(Fault::wheel_range));
    }
    SECTION("pressure that comes every other period and jumps beyond what the valve can do") {
        PressureInput last = b.sensors.pressure;
        b.tamper = [&](Sensors& seen) {
            if (++frame % 2 == 0) {
                last = seen.pressure;
                last.pressure_Pa = frame % 4 == 0 ? 0.0F : 22e6F;
            }
            seen.pressure = last;
        };
        b.seconds(0.1);
        CHECK(b.command.faults.contains(Fault::pressure_rate));
    }
    CHECK(b.command.state == State::safe);
}

TEST_CASE("one long stall is as much an overrun as many short ones", "[CTL-081]") {
    Bench b(shipped());
    b.to_braking();
    b.tamper = [](Sensors& seen) { seen.missed_periods = 50; };
    static_cast<void>(b.step());
    b.tamper = {};
    b.seconds(0.05);
    CHECK(b.command.faults.empty());
    b.seconds(1.0);
    b.tamper = [](Sensors& seen) { seen.missed_periods = 51; };
    CHECK(b.step().faults.contains(Fault::overrun));
    CHECK(b.command.state == State::safe);
}

TEST_CASE("an emergency stop during the self-test counts", "[CTL-070]") {
    Bench b(shipped());
    b.steps(20);
    REQUIRE(b.command.state == State::self_test);
    b.tamper = [](Sensors& seen) { seen.emergency_stop = true; };
    CHECK(b.step().state == State::safe);
    CHECK(b.command.faults.contains(Fault::emergency_stop));
}

TEST_CASE("an emergency stop that is repeated is one, and over when none comes any more", "[CTL-076]") {
    Bench b(shipped());
    b.to_standby();
    const int every = GENERATE(1, 10, 50);
    int step = 0;
    b.tamper = [&](Sensors& seen) { seen.emergency_stop = step % every == 0; };
    for (; step < 1000; ++step) {
        REQUIRE(b.step().state == State::safe);
        REQUIRE(b.command.current_mA == b.config.valve.safe_current_mA);
    }
    b.tamper = nullptr;
    b.steps(100 - every);
    CHECK(b.command.state == State::safe);
    CHECK(b.step().state == State::standby);
    CHECK(b.command.faults.contains(Fault::emergency_stop));  // latched until armed again
}

TEST_CASE(
    "a law that takes over raises the pressure no faster than a demand that passes through, and may release "
    "at once",
    "[CTL-065]") {
    Bench b(shipped());
    const Law from = GENERATE(Law::wheel_slip, Law::peak_slip, Law::threshold, Law::pressure_bias, Law::deceleration);
    const Law to = GENERATE(Law::wheel_slip, Law::peak_slip, Law::threshold, Law::pressure_bias, Law::deceleration, Law::open_loop);
    if (from == to) return;
    CAPTURE(static_cast<int>(from), static_cast<int>(to));
    b.to_braking(from);
    b.sensors.maneuver.demand_Pa = 20e6F;
    b.sensors.maneuver.slip_reference = 0.24F;
    b.sensors.maneuver.law = to;
    b.sensors.maneuver.current_mA = 38.0F;
    const float start_Pa = b.command.pressure_request_Pa;
    const float per_step_Pa = b.config.supervisor.pass_through_rate_Paps * b.config.period_s * 1.01F;
    for (int i = 1; i <= 100; ++i) {
        CHECK(b.step().pressure_request_Pa <= start_Pa + static_cast<float>(i) * per_step_Pa + 1.0F);
    }
}

TEST_CASE("asking for another law does not put pressure back on a locked wheel", "[CTL-065]") {
    Bench b(shipped());
    b.to_braking();
    slow_to(b, 12.0);  // a fast wheel cannot lose so much at once
    b.slip = 0.9;
    while (b.step().state == State::braking) {
    }
    REQUIRE(b.command.state == State::locked_wheel);
    b.sensors.maneuver.law = Law::open_loop;
    for (int i = 0; i < 200; ++i) {
        static_cast<void>(b.step());
        CHECK(b.command.current_mA == b.config.valve.safe_current_mA);
    }
}

TEST_CASE("no stall is so long that its count rolls over", "[CTL-081][CTL-240]") {
    for (const std::uint32_t missed : {500U, 0x1999'999AU, 0xFFFF'FFFFU}) {
        Bench b(shipped());
        b.to_braking();
        b.tamper = [missed](Sensors& seen) { seen.missed_periods = missed; };
        CHECK(b.step().faults.contains(Fault::overrun));
        CHECK(b.command.state == State::safe);
    }
}

TEST_CASE("a set of faults is its members: from bits and by insertion alike, and no other set", "[CTL-240]") {
    FaultSet one;
    CHECK(one == FaultSet{});
    one.insert(Fault::wheel_lost);
    CHECK_FALSE(one == FaultSet{});
    CHECK(FaultSet::from_bits(1U) == one);
    CHECK(FaultSet::from_bits(0xFFFF'FFFFU).bits() == 0x03FF'FFFFU);  // 26 faults, and nothing else
}

TEST_CASE("frames that are mostly refused are a fault although some pass, repeats are none", "[CTL-081]") {
    Bench b(shipped());
    b.to_braking();
    int period = 0;
    SECTION("two of three are refused") {
        b.tamper = [&, last = b.sensors.pressure](Sensors& seen) mutable {
            if (++period % 3 != 0) {
                seen.pressure.received = last.received;
                ++last.rejected;
            } else {
                last.received = seen.pressure.received;
            }
            seen.pressure.rejected = last.rejected;
        };
        b.seconds(0.1);
        CHECK(b.command.state == State::safe);
        CHECK(b.command.faults.contains(Fault::pressure_corrupt));
    }
    SECTION("few come, and all are refused") {
        b.tamper = [&, last = b.sensors.pressure](Sensors& seen) mutable {
            if (++period % 8 == 0) ++last.rejected;
            seen.pressure = last;
        };
        b.steps(22);
        CHECK(b.command.faults.contains(Fault::pressure_corrupt));
        CHECK_FALSE(b.command.faults.contains(Fault::pressure_lost));
    }
    SECTION("each comes twice") {
        b.tamper = [&](Sensors& seen) { seen.pressure.rejected = static_cast<std::uint32_t>(++period); };
        b.seconds(0.5);
        CHECK(b.command.faults.empty());
    }
}

TEST_CASE("a reference speed that leaps while the wheel rolls is a fault within five readings", "[CTL-081]") {
    const Law law = GENERATE(Law::wheel_slip, Law::peak_slip, Law::threshold, Law::pressure_bias, Law::deceleration);
    const float share = GENERATE(0.5F, 0.84F, 0.9F, 1.1F, 1.16F, 1.5F);
    CAPTURE(law, share);
    Bench b(shipped());
    b.to_braking(law);
    b.tamper = [share](Sensors& seen) {
        seen.flywheel.source = SpeedSource::speed;
        seen.flywheel.speed_radps *= share;
    };
    b.steps(5);
    CHECK(b.command.faults.contains(Fault::flywheel_stuck) == (share < 0.85F));
    CHECK(b.command.faults.contains(Fault::flywheel_rate) == (share > 1.15F));
    CHECK((b.command.state == State::safe) == (share < 0.85F || share > 1.15F));
}

TEST_CASE("a reading that stays for many periods counts once", "[CTL-081]") {
    Bench b(shipped());
    b.to_braking();
    SpeedInput last;
    int period = 0;
    b.tamper = [&](Sensors& seen) {
        // A frame every 15 ms, and one of nine far off.
        if (period % 15 == 0) {
            last = seen.flywheel;
            last.source = SpeedSource::speed;
            last.speed_radps *= period % 135 == 0 ? 0.8F : 1.0F;
        }
        ++period;
        seen.flywheel = last;
    };
    b.seconds(1.0);
    CHECK(b.command.faults.empty());
}

TEST_CASE("a wheel encoder that is wrong from touchdown on is named once the wheel should roll", "[CTL-081]") {
    Bench b(shipped());
    b.to_standby();
    b.sensors.maneuver.arm = true;
    static_cast<void>(b.step());
    b.sensors.maneuver.weight_on_wheels = true;
    b.sensors.maneuver.demand_Pa = 6e6F;
    Fault named = Fault::wheel_stuck;
    SECTION("it shows no edge") {}
    SECTION("it shows half of the speed, below that of a wheel that is spun up") {
        b.slip = 0.5;
        named = Fault::speeds_disagree;
    }
    SECTION("it shows less than the lock protection's share") {
        b.slip = 0.9;
        named = Fault::speeds_disagree;
    }
    b.seconds(static_cast<double>(b.config.supervisor.touchdown_timeout_s) - 0.01);
    CHECK(b.command.state == State::touchdown_protection);
    b.seconds(0.3);
    CHECK(b.command.state == State::safe);
    CHECK(b.command.faults.contains(named));
}

TEST_CASE("pressure that is far off the model on and off is a fault", "[CTL-081]") {
    Bench b(shipped());
    b.to_braking();
    int period = 0;
    b.tamper = [&](Sensors& seen) {
        if (++period % 30 < 20) seen.pressure.pressure_Pa += 4e6F;
    };
    b.seconds(0.25);
    CHECK(b.command.state == State::safe);
    CHECK(b.command.faults.contains(Fault::pressure_off_command));
}

TEST_CASE("pressure that stays on a loaded wheel without current is a fault", "[CTL-070]") {
    Bench b(shipped());
    b.to_armed();
    const float stays_Pa = GENERATE(0.4e6F, 0.6e6F);
    b.tamper = [&](Sensors& seen) { seen.pressure.pressure_Pa = stays_Pa; };
    b.seconds(0.15);
    CHECK(b.command.faults.contains(Fault::pressure_off_command) == (stays_Pa > 0.5e6F));
}
