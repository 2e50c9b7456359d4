// The served rig in lockstep with a bridge that takes turns.
#include "plant_sim/virtual_rig/serve_node.hpp"

#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/can/roles.hpp"
#include "tests/catch.hpp"
#include "tests/plc/operator.hpp"
#include "tests/plc/serve_stand.hpp"

using antiskid::can::Frame;
using antiskid::can::Role;
using antiskid::control::Time;
using namespace serve_test;

namespace {

/// A bridge that does its turns while the rig waits for them, after so much time each.
struct TurnTaker {
    explicit TurnTaker(Stand& stand) : s(stand) {}
    std::uint16_t look() {
        if (at_sync != s.count(Role::sync)) {
            at_sync = s.count(Role::sync);
            since = s.clock.now();
        }
        // The clock moves by the rig's own looking.
        if (s.clock.now() - since >= takes && at_sync % 10 == 1 && !gone) done = rig::turn_number(static_cast<std::uint32_t>(at_sync - 1), 10);
        return done;
    }

    Stand& s;
    Time takes{};
    bool gone = false;
    std::uint16_t done = rig::kJoined;
    std::uint64_t at_sync = 0;
    Time since{};
};

}  // namespace

TEST_CASE("the rig's time waits for the turn of a bridge in lockstep, each tenth period", "[RIG-290]") {
    Stand s;
    TurnTaker bridge(s);
    bridge.takes = 40 * kMillisecond;
    std::vector<std::uint64_t> early;
    s.on_period = [&] {
        // The registers of the period are taken over after the turn.
        const std::uint64_t sync = s.count(Role::sync);
        if (sync % 10 == 1 && bridge.done != rig::turn_number(static_cast<std::uint32_t>(sync - 1), 10)) early.push_back(sync);
    };
    s.node.run_lockstep(s.stop, 100 * kMillisecond, {.done = [&] { return bridge.look(); }});
    CHECK(early.empty());
    CHECK(s.clock.now() > 100 * 40 * kMillisecond);
}

TEST_CASE("a bridge in lockstep that does not answer is given up, and waited for again when it is back", "[RIG-290]") {
    Stand s;
    TurnTaker bridge(s);
    s.end_s = 3.0;
    s.on_period = [&] { bridge.gone = s.op.rig.time_s() > 1.0 && s.op.rig.time_s() < 2.0; };
    s.node.run_lockstep(s.stop, 100 * kMillisecond, {.done = [&] { return bridge.look(); }});
    // Once in vain; the others cost no more than the paced period.
    CHECK(s.clock.now() > 3 * kSecond + 90 * kMillisecond);
    CHECK(s.clock.now() < 3 * kSecond + 400 * kMillisecond);
    CHECK(bridge.done == rig::turn_number(static_cast<std::uint32_t>(s.count(Role::sync) - 1), 10));
}

TEST_CASE("a bridge in lockstep that says good-bye is not waited for", "[RIG-290]") {
    Stand s;
    const auto left = [] { return rig::kNoTurns; };
    s.node.run_lockstep(s.stop, 100 * kMillisecond, {.done = left});
    CHECK(s.clock.now() < kSecond + 200 * kMillisecond);
}

TEST_CASE("all three begin together: the first sample and SYNC are said until the controller answers", "[RIG-290]") {
    Stand s;
    s.answers = false;
    std::vector<Frame> first;
    s.bus.on_send = [&](const Frame& frame) {
        if (s.exchanges == 0) first.push_back(frame);
        if (first.size() == 12 && frame.id == s.layout[Role::sync].id) s.answers = true;
        s.received(frame);
    };
    std::uint16_t turn = rig::kNoTurns;
    std::uint64_t sent_before_joining = 1;
    s.clock.on_time = [&](Time now) {
        if (turn != rig::kNoTurns || now < 500 * kMillisecond) return;
        sent_before_joining = first.size();
        turn = rig::kJoined;
    };
    TurnTaker bridge(s);
    s.node.run_lockstep(s.stop, 100 * kMillisecond, {.done = [&] { return turn == rig::kNoTurns ? turn : bridge.look(); }, .start_together = true});
    CHECK(sent_before_joining == 0);
    REQUIRE(first.size() == 12);
    for (std::size_t i = 4; i < 12; ++i) {
        CHECK(first[i].id == first[i % 4].id);
        CHECK(first[i].data == first[i % 4].data);
    }
    CHECK(s.node.state().controller_heard);
    CHECK(s.node.state().periods == Approx(1000.0).margin(2.0));
}
