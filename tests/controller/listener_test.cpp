// What the rig sends, heard as the controller would hear it: each thing that is wrong fails its own check.
#include "firmware/controller/listener.hpp"

#include "tests/controller/results.hpp"
#include "tests/controller/rig_at_rest.hpp"

using namespace controller_test;
using namespace std::chrono_literals;
using controller::Reception;

namespace {

Reception listened(RigAtRest& rig, control::Time duration = 1s) {
    const std::atomic<bool> stop{false};
    return controller::listen(rig.setup, rig.ear, rig.clock, duration, stop);
}

Wrong wrong_frames(RigAtRest& rig) {
    return wrong(frame_checks(listened(rig), rig.setup, "can0"));
}

std::uint16_t id_of(const RigAtRest& rig, can::Role role) {
    return rig.setup.layout[role].id;
}

/// A shaft with this many edges, all at once in each period.
void turn(can::SpeedSample& shaft, control::Time now, std::uint32_t edges) {
    shaft.edge_count += edges;
    shaft.edge_time = now;
}

}  // namespace

TEST_CASE("a rig at rest with its bridge passes every check, and nothing is sent to it", "[RT-130]") {
    RigAtRest rig;
    const Reception reception = listened(rig, 2s);
    const auto checks = frame_checks(reception, rig.setup, "can0");
    CHECK(wrong(checks).empty());
    for (const controller::Check& check : checks) CHECK(check.verdict == controller::CheckResult::pass);
    CHECK(named(checks, "wheel frames").figures.front().second > 1990.0);
    CHECK(wrong(timing_checks(reception, rig.setup.period)).empty());
    CHECK(controller::why_not_to_move_the_valve(reception, rig.setup.control).empty());
    CHECK(rig.reception.empty());
}

TEST_CASE("a message that does not come is named; the bridge's only warn", "[RT-130]") {
    const auto [role, expected] = GENERATE(table<can::Role, Wrong>({
        {can::Role::wheel, {"wheel frames: fail"}},
        {can::Role::flywheel, {"flywheel frames: fail"}},
        {can::Role::pressure, {"pressure frames: fail"}},
        {can::Role::maneuver, {"maneuver frames: warn"}},
        {can::Role::rig_heartbeat, {"rig_heartbeat frames: warn"}},
    }));
    RigAtRest rig;
    rig.disturb = [&rig, silent = role](const can::Frame& frame) { return frame.id != id_of(rig, silent); };
    CHECK(wrong_frames(rig) == expected);
}

TEST_CASE("frames that are damaged, lost, late or too few fail the check of their message", "[RT-130]") {
    RigAtRest rig;
    int count = 0;
    SECTION("every hundredth with a wrong CRC") {
        rig.disturb = [&](can::Frame& frame) {
            if (frame.id == id_of(rig, can::Role::wheel) && ++count % 100 == 0) frame.data[3] ^= 1U;
            return true;
        };
        CHECK(wrong_frames(rig) == Wrong{"wheel frames: fail"});
    }
    SECTION("all with a wrong CRC") {
        rig.disturb = [&](can::Frame& frame) {
            if (frame.id == id_of(rig, can::Role::pressure)) frame.data[3] ^= 1U;
            return true;
        };
        const auto checks = frame_checks(listened(rig), rig.setup, "can0");
        CHECK(wrong(checks) == Wrong{"pressure frames: fail"});
        CHECK_THAT(named(checks, "pressure frames").measured, ContainsSubstring("0 good"));
    }
    SECTION("one lost in a hundred") {
        rig.disturb = [&](const can::Frame& frame) { return frame.id != id_of(rig, can::Role::flywheel) || ++count % 100 != 0; };
        CHECK(wrong_frames(rig) == Wrong{"flywheel frames: fail"});
    }
    SECTION("a pause longer than the controller bears") {
        rig.disturb = [&](const can::Frame& frame) {
            if (frame.id != id_of(rig, can::Role::wheel)) return true;
            ++count;
            return count < 700 || count > 730;  // 30 frames are two turns of the counter: none is missed by it
        };
        const auto checks = frame_checks(listened(rig), rig.setup, "can0");
        CHECK(wrong(checks) == Wrong{"wheel frames: fail"});
        CHECK_THAT(named(checks, "wheel frames").measured, ContainsSubstring("wheel_lost"));
    }
    SECTION("half as many as the binding says") {
        rig.setup.layout[can::Role::wheel].period = 500us;
        CHECK(wrong_frames(rig) == Wrong{"wheel frames: warn"});
    }
}

TEST_CASE("what a rig at rest cannot say fails the check of that sensor", "[RT-130]") {
    RigAtRest rig;
    SECTION("the wheel turns") {
        rig.each = [&](int period) {
            if (period % 10 == 0) turn(rig.sample.wheel, rig.clock.now(), 1);
        };
        CHECK(wrong_frames(rig) == Wrong{"wheel at rest: fail"});
    }
    SECTION("the flywheel turns") {
        rig.each = [&](int period) {
            if (period % 10 == 0) turn(rig.sample.flywheel, rig.clock.now(), 1);
        };
        CHECK(wrong_frames(rig) == Wrong{"flywheel at rest: fail"});
    }
    SECTION("a speed that cannot be") {
        rig.each = [&](int) { turn(rig.sample.wheel, rig.clock.now(), 1000); };
        const auto checks = frame_checks(listened(rig), rig.setup, "can0");
        CHECK(wrong(checks) == Wrong{"wheel at rest: fail"});
        CHECK_THAT(named(checks, "wheel at rest").measured, ContainsSubstring("wheel_range"));
    }
    SECTION("pressure without a command") {
        rig.pressure_offset_Pa = 0.6e6F;
        CHECK(wrong_frames(rig) == Wrong{"pressure at rest: fail"});
    }
    SECTION("a pressure that jumps") {
        rig.each = [&](int period) { rig.pressure_offset_Pa = period % 2 == 0 ? 0.0F : 24e6F; };
        const auto checks = frame_checks(listened(rig), rig.setup, "can0");
        CHECK(wrong(checks) == Wrong{"pressure at rest: fail"});
        CHECK_THAT(named(checks, "pressure at rest").measured, ContainsSubstring("pressure_rate"));
    }
    SECTION("an emergency stop") {
        rig.sample.emergency_stop = true;
        CHECK(wrong_frames(rig) == Wrong{"emergency stop: fail"});
    }
    SECTION("a maneuver that asks for what cannot be") {
        rig.sample.maneuver.slip_reference = 0.9F;
        const auto checks = frame_checks(listened(rig), rig.setup, "can0");
        CHECK(wrong(checks) == Wrong{"maneuver frames: fail"});
        CHECK_THAT(named(checks, "maneuver frames").measured, ContainsSubstring("maneuver_range"));
    }
}

TEST_CASE("a link that fails and a second controller are named", "[RT-130]") {
    RigAtRest rig;
    SECTION("bus-off") {
        rig.each = [&](int period) {
            if (period == 900) rig.ear.set_link(false, true);
        };
        const auto checks = frame_checks(listened(rig), rig.setup, "can0");
        CHECK(named(checks, "CAN while listening").verdict == controller::CheckResult::fail);
    }
    SECTION("another controller") {
        can::Loopback::End& other = rig.hub.connect();
        can::ControllerPort port(rig.setup.layout, rig.setup.period);
        rig.each = [&](int period) {
            if (period % 10 == 0) other.send(port.heartbeat());
        };
        const Reception reception = listened(rig);
        CHECK(wrong(frame_checks(reception, rig.setup, "can0")) == Wrong{"only controller: fail"});
        CHECK(controller::why_not_to_move_the_valve(reception, rig.setup.control) == "another controller commands the valve");
    }
}

TEST_CASE("a loop that wakes up late, works long or misses periods fails by its own limit", "[RT-001]") {
    RigAtRest rig;
    SECTION("late, every hundredth time by a quarter of a period") {
        const auto rigs = rig.clock.on_sleep;
        rig.clock.on_sleep = [&, rigs, n = 0](control::Time deadline) mutable {
            rigs(deadline);
            if (++n % 100 == 0) rig.clock.advance(deadline + 250us - rig.clock.now());
        };
        const auto checks = timing_checks(listened(rig), rig.setup.period);
        CHECK(wrong(checks) == Wrong{"loop latency: fail"});
        CHECK(named(checks, "loop latency").figures.back().second == Approx(250.0).epsilon(0.02));
    }
    SECTION("by more than a period") {
        const auto rigs = rig.clock.on_sleep;
        rig.clock.on_sleep = [&, rigs, n = 0](control::Time deadline) mutable {
            rigs(deadline);
            if (++n == 300) rig.clock.advance(deadline + 3ms - rig.clock.now());
        };
        const auto checks = timing_checks(listened(rig, 3s), rig.setup.period);
        CHECK(wrong(checks) == Wrong{"missed periods: fail"});
        CHECK_THAT(named(checks, "missed periods").measured, ContainsSubstring("3 of "));
    }
    SECTION("long work") {
        Reception reception = listened(rig);
        reception.work.add(600us);
        CHECK(wrong(timing_checks(reception, rig.setup.period)) == Wrong{"loop work: fail"});
    }
    SECTION("stopped before its first period") {
        const std::atomic<bool> stop{true};
        const Reception reception = controller::listen(rig.setup, rig.ear, rig.clock, 1s, stop);
        CHECK(wrong(timing_checks(reception, rig.setup.period)) == Wrong{"missed periods: fail"});
    }
}
