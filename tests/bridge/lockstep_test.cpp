// Whose turn it is in lockstep, and what time it is.
#include "rig_bridge/bridge/lockstep.hpp"

#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"
#include "tests/bridge/fakes.hpp"
#include "tests/catch.hpp"

using antiskid::can::Time;
using rig::bridge::Lockstep;
using namespace std::chrono_literals;

namespace {

struct LockstepBench {
    void sync(std::uint32_t number) { lockstep.accept(rig.sync(number)); }
    void answer() { lockstep.accept(controller.valve_command(0.0F)); }
    void period(std::uint32_t number) {
        sync(number);
        answer();
    }

    antiskid::can::Layout layout = bridge_test::layout();
    antiskid::can::RigPort rig{layout, 1ms};
    antiskid::can::ControllerPort controller{layout, 1ms};
    Lockstep lockstep{layout, 1ms, 10ms, 100ms};
};

}  // namespace

TEST_CASE("The bridge's turn is each tenth SYNC, once the controller has answered it", "[BRG-465]") {
    LockstepBench b;
    std::vector<std::uint32_t> turns;
    for (std::uint32_t n = 0; n < 45; ++n) {
        b.sync(n);
        CHECK_FALSE(b.lockstep.due());
        b.answer();
        if (!b.lockstep.due()) continue;
        turns.push_back(n);
        CHECK(b.lockstep.end_turn() == rig::turn_number(n, 10));
        CHECK(b.lockstep.now() == (static_cast<std::int64_t>(n) + 1) * Time{1ms});
    }
    CHECK(turns == std::vector<std::uint32_t>{0, 10, 20, 30, 40});
    CHECK(b.lockstep.syncs() == 45);
}

TEST_CASE("Between two turns the bus need not be looked at before the last period", "[BRG-465]") {
    LockstepBench b;
    CHECK(b.lockstep.quiet() == 0ms);  // nothing is known of the rig yet
    for (std::uint32_t number = 0; number <= 3; ++number) b.period(number);
    CHECK(b.lockstep.quiet() == 0ms);  // its turn
    (void)b.lockstep.end_turn();
    CHECK(b.lockstep.quiet() == 6ms);
    for (std::uint32_t number = 4; number <= 9; ++number) b.period(number);
    CHECK(b.lockstep.quiet() == 0ms);
    b.sync(10);
    CHECK(b.lockstep.quiet() == 0ms);
    b.answer();
    CHECK(b.lockstep.due());
    (void)b.lockstep.end_turn();
    CHECK(b.lockstep.quiet() == 9ms);
    b.lockstep.timed_out(100ms);  // no SYNC comes
    CHECK(b.lockstep.quiet() == 0ms);
}

TEST_CASE("A SYNC that is repeated is one; lost ones have passed; a rig that starts anew goes on", "[BRG-465]") {
    LockstepBench b;
    b.sync(0);
    b.sync(0);
    b.period(0);
    CHECK(b.lockstep.syncs() == 1);
    CHECK(b.lockstep.due());
    (void)b.lockstep.end_turn();
    b.period(3);
    CHECK(b.lockstep.now() == Time{4ms});
    CHECK_FALSE(b.lockstep.due());
    b.period(0);
    CHECK(b.lockstep.now() == Time{5ms});
    CHECK(b.lockstep.due());
}

TEST_CASE("A bridge that was late takes its turn as soon as it can", "[BRG-465]") {
    LockstepBench b;
    b.period(0);
    (void)b.lockstep.end_turn();
    for (std::uint32_t number = 1; number <= 13; ++number) b.period(number);  // a rig that does not wait
    CHECK(b.lockstep.due());
    CHECK(b.lockstep.end_turn() == rig::turn_number(13, 10));
    b.period(14);
    CHECK_FALSE(b.lockstep.due());
    b.period(27);  // the SYNC of the turn itself was lost
    CHECK(b.lockstep.due());
    CHECK(b.lockstep.end_turn() == rig::turn_number(20, 10));
}

TEST_CASE("A controller that is silent is waited for once", "[BRG-465]") {
    LockstepBench b;
    b.period(0);
    (void)b.lockstep.end_turn();
    b.sync(10);
    CHECK_FALSE(b.lockstep.due());
    CHECK(b.lockstep.max_wait() == Time{100ms});
    b.lockstep.timed_out(100ms);
    CHECK(b.lockstep.due());
    CHECK(b.lockstep.end_turn() == rig::turn_number(10, 10));
    b.sync(20);
    CHECK(b.lockstep.due());
    (void)b.lockstep.end_turn();
    CHECK(b.lockstep.now() == Time{1ms} + Time{20ms});  // none of it by the machine's clock
    b.answer();
    b.sync(30);
    CHECK_FALSE(b.lockstep.due());
}

TEST_CASE("Without SYNC time goes on as the machine's does, and by SYNC again when it comes", "[BRG-465]") {
    LockstepBench b;
    CHECK(b.lockstep.max_wait() == Time{30s});
    CHECK(b.lockstep.end_turn() == rig::kJoined);
    b.period(10);
    (void)b.lockstep.end_turn();
    b.lockstep.timed_out(100ms);
    CHECK(b.lockstep.due());
    CHECK(b.lockstep.now() == Time{101ms});
    (void)b.lockstep.end_turn();
    CHECK(b.lockstep.max_wait() == Time{10ms});
    b.lockstep.timed_out(13ms);
    CHECK(b.lockstep.now() == Time{114ms});
    (void)b.lockstep.end_turn();
    b.period(11);
    CHECK(b.lockstep.now() == Time{115ms});
}

TEST_CASE("A rig that waits for a silent controller is not silent itself", "[BRG-465]") {
    LockstepBench b;
    b.period(0);
    (void)b.lockstep.end_turn();
    b.sync(1);  // not answered: SYNC 2 comes after the rig's own wait
    CHECK(b.lockstep.max_wait() > Time{100ms});
    b.sync(2);
    CHECK(b.lockstep.now() == Time{3ms});  // none of it by the machine's clock
}

TEST_CASE("A turn has a number that is none of the others'", "[BRG-465]") {
    CHECK(rig::turn_number(0, 10) == 1);
    CHECK(rig::turn_number(19, 10) == 2);
    CHECK(rig::turn_number(655339, 10) == 65534);
    CHECK(rig::turn_number(655340, 10) == 1);
    for (std::uint32_t n = 0; n < 1'400'000; n += 10) {
        const std::uint16_t turn = rig::turn_number(n, 10);
        if (turn == rig::kNoTurns || turn == rig::kJoined) FAIL(n);
    }
}
