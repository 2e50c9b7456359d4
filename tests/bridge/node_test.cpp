#include "rig_bridge/bridge/node.hpp"

#include <algorithm>
#include <cmath>

#include "rig_bridge/bridge/view_model.hpp"
#include "tests/bridge/fakes.hpp"
#include "tests/catch.hpp"

using namespace bridge_test;
using antiskid::can::Role;
using rig::Commanded;
using rig::Measured;
using rig::Phase;

namespace {

struct Bench {
    antiskid::can::Layout frames = layout();
    FakePlc plc{};
    FakeFeed feed{};
    FakeBus bus{};
    rig::bridge::Freshness limits{};
    rig::bridge::Node node{frames, 1e-3, limits, plc, feed, bus};
    Time now = 1s;

    const rig::bridge::Moment& step(rig::Sequencer* sequencer, const rig::bridge::Node::Wishes& wishes = {}) {
        now += rig::bridge::Node::kStep;
        feed.bus.valid_at = now;
        feed.bus.view.wheel.received = feed.bus.view.flywheel.received = feed.bus.view.pressure.received = now;
        feed.bus.view.controller.status_received = now;
        return node.step(sequencer, wishes, now);
    }
    void plc_moves() { rig::at(plc.now.values, Measured::plc_watchdog) += 1.0; }
    [[nodiscard]] std::ptrdiff_t sent(Role role) const {
        return std::count_if(bus.sent.begin(), bus.sent.end(), [&](const antiskid::can::Frame& f) { return f.id == frames[role].id; });
    }
    [[nodiscard]] double commanded(Commanded q) const { return rig::at(plc.commands.back(), q); }
};

rig::Plan plan() {
    rig::Plan plan;
    plan.speed_mps = 50.0;
    plan.load_base_N = 40e3;
    plan.demand_Pa = 20e6;
    plan.slip_reference = 0.2;
    return plan;
}

}  // namespace

TEST_CASE("The bridge's frames go out at their periods, load cells only while they are fresh", "[BRG-400]") {
    Bench b;
    for (int i = 0; i < 100; ++i) {
        b.plc_moves();
        b.step(nullptr, {.number = 3});
    }
    CHECK(b.sent(Role::maneuver) == 50);
    CHECK(b.sent(Role::rig_heartbeat) == 10);
    CHECK(b.sent(Role::load_cells) == 100);
    CHECK(b.sent(Role::maneuver_state) >= 10);
    CHECK(b.sent(Role::maneuver_state) <= 11);
    CHECK(b.sent(Role::emergency_stop) == 0);
    CHECK(b.sent(Role::wheel) + b.sent(Role::flywheel) + b.sent(Role::pressure) + b.sent(Role::sync) == 0);
    for (const Measured cell : {Measured::vertical_load_N, Measured::longitudinal_force_N, Measured::brake_torque_Nm}) {
        b.bus.sent.clear();
        b.plc.now = good_plc();
        b.plc.now.age_s[static_cast<std::size_t>(cell)] = 0.11;
        for (int i = 0; i < 10; ++i) {
            b.plc_moves();
            b.step(nullptr);
        }
        CHECK(b.sent(Role::load_cells) == 0);
        CHECK(b.sent(Role::maneuver) == 5);
    }
}

TEST_CASE("A reading of the load cells goes on the bus once, however often it is read", "[BRG-400]") {
    Bench b;
    for (int i = 0; i < 10; ++i) b.step(nullptr);
    CHECK(b.sent(Role::load_cells) == 1);
    b.plc_moves();  // the same forces, measured anew
    for (int i = 0; i < 10; ++i) b.step(nullptr);
    CHECK(b.sent(Role::load_cells) == 2);
    // The slowest PLC of the register map moves its watchdog each 100 ms, its forces more often.
    for (const Measured cell : {Measured::vertical_load_N, Measured::longitudinal_force_N, Measured::brake_torque_Nm}) {
        b.bus.sent.clear();
        rig::at(b.plc.now.values, cell) += 1.0;
        b.plc.now.plc_watchdog_age_s = 0.1;
        for (int i = 0; i < 10; ++i) b.step(nullptr);
        CHECK(b.sent(Role::load_cells) == 1);
    }
    for (const double age_s : {0.101, 0.299, double{NAN}}) {  // of the watchdog
        b.bus.sent.clear();
        b.plc.now.plc_watchdog_age_s = age_s;
        rig::at(b.plc.now.values, Measured::brake_torque_Nm) += 1.0;
        for (int i = 0; i < 10; ++i) b.step(nullptr);
        CHECK(b.sent(Role::load_cells) == 0);
        CHECK(b.sent(Role::maneuver) == 5);
    }
}

TEST_CASE("With a reading of the load cells goes how old it is: in the registers, and since it was asked for", "[BRG-400]") {
    constexpr int kInRegisters_ms = 5;
    Bench b{.limits = {.load_cells_late_s = 1e-3 * kInRegisters_ms}};
    antiskid::can::Observer heard(b.frames);
    for (const int asked_ms : {0, 4, 9, 60}) {
        CAPTURE(asked_ms);
        b.plc.now.age_s[static_cast<std::size_t>(Measured::brake_torque_Nm)] = 1e-3 * asked_ms;
        b.plc_moves();
        b.step(nullptr);
        for (const antiskid::can::Frame& frame : b.bus.sent) heard.accept(frame);
        b.bus.sent.clear();
        constexpr int kMost_ms = 30;  // of the field
        CHECK(std::abs(heard.view().load_cells.age / 1ms - std::min(asked_ms + kInRegisters_ms, kMost_ms)) <= 1);
    }
}

TEST_CASE("A phase and its command go out in the same step", "[BRG-400]") {
    for (const int before : {1, 2}) {
        Bench b;
        rig::Sequencer sequencer(plan());
        for (int i = 0; i < before; ++i) b.step(nullptr);
        Phase phase = Phase::idle;
        int changes = 0;
        for (int i = 0; i < 400; ++i) {
            b.bus.sent.clear();
            b.step(&sequencer, {.number = 1, .abort = i == 200 + before});
            if (b.node.moment().outputs.phase == phase) {
                CHECK(b.sent(Role::maneuver) <= 1);
                continue;
            }
            phase = b.node.moment().outputs.phase;
            ++changes;
            CAPTURE(rig::name(phase));
            REQUIRE(b.sent(Role::maneuver) == 1);
            // The command first: who hears the phase has heard it.
            const auto place = [&](Role role) {
                return std::find_if(b.bus.sent.begin(), b.bus.sent.end(), [&](const auto& frame) { return frame.id == b.frames[role].id; });
            };
            CHECK(place(Role::maneuver) < place(Role::maneuver_state));
        }
        CHECK(changes >= 3);
    }
}

TEST_CASE("Without a sequencer everything is off", "[BRG-400]") {
    Bench b;
    b.step(nullptr);
    CHECK(b.plc.commands.back() == rig::CommandedValues{});
    CHECK(b.node.moment().outputs.phase == Phase::idle);
    CHECK_FALSE(b.node.moment().outputs.arm);
}

TEST_CASE("An interlock that opens is the abort of the same step, and the PLC is told at once", "[BRG-400]") {
    Bench b;
    rig::Sequencer sequencer(plan());
    for (int i = 0; i < 5 && sequencer.phase() != Phase::spin_up; ++i) b.step(&sequencer);
    REQUIRE(sequencer.phase() == Phase::spin_up);
    CHECK(b.commanded(Commanded::drive_enable) == 1.0);
    CHECK(b.commanded(Commanded::flywheel_speed_mps) > 50.0);
    rig::at(b.plc.now.values, Measured::interlocks) = 13.0;
    b.bus.sent.clear();
    const rig::bridge::Moment& m = b.step(&sequencer);
    CHECK(m.outputs.phase == Phase::aborting);
    CHECK(m.outputs.abort == rig::Abort::guard_open);
    CHECK(b.plc.commands.back() == rig::CommandedValues{});
    CHECK(b.sent(Role::emergency_stop) == 1);
    CHECK(b.sent(Role::maneuver_state) == 1);
}

TEST_CASE("A link of its own that is down counts as a lost bus", "[BRG-400]") {
    Bench b;
    rig::Sequencer sequencer(plan());
    for (int i = 0; i < 5; ++i) b.step(&sequencer);
    REQUIRE(sequencer.phase() == Phase::spin_up);
    b.bus.up = false;
    b.step(&sequencer);
    CHECK(sequencer.abort() == rig::Abort::bus_lost);
}

TEST_CASE("Somebody else's command is the abort of the same step, once", "[BRG-136]") {
    Bench b;
    b.plc.now.foreign_commands = 3;  // while nothing ran
    b.step(nullptr);
    rig::Sequencer sequencer(plan());
    for (int i = 0; i < 5; ++i) b.step(&sequencer);
    REQUIRE(sequencer.phase() == Phase::spin_up);
    b.plc.now.foreign_commands = 4;
    b.plc.now.foreign_commit = 4711;
    const rig::bridge::Moment& m = b.step(&sequencer);
    CHECK(sequencer.abort() == rig::Abort::foreign_command);
    CHECK(note_of(m) == "somebody else commands the PLC: commit 4711 is not the bridge's");
    CHECK(b.plc.commands.back() == rig::CommandedValues{});
    CHECK(note_of(b.step(&sequencer)).empty());
}

TEST_CASE("How fast the rim still turns is said by whoever is heard", "[BRG-420]") {
    Bench b;
    rig::at(b.plc.now.values, Measured::flywheel_speed_mps) = 30.0;
    b.feed.bus.rim_mps = 30.5;
    CHECK(rig::bridge::rim_speed_mps(b.step(nullptr)) == 30.5);
    b.feed.bus.up = false;
    CHECK(rig::bridge::rim_speed_mps(b.step(nullptr)) == 30.0);
    b.plc.now.age_s.fill(3.0);
    CHECK_FALSE(rig::bridge::rim_speed_mps(b.step(nullptr)).has_value());
    b.feed.bus.up = true;
    CHECK(rig::bridge::rim_speed_mps(b.step(nullptr)) == 30.5);
    CHECK_THAT(rig::bridge::rim_text(30.5, 0.1), ContainsSubstring("still turns, at 30.50 m/s"));
    CHECK_THAT(rig::bridge::rim_text(std::nullopt, 0.1), ContainsSubstring("take it for turning"));
    CHECK(rig::bridge::rim_text(0.09, 0.1) == "the rim stands");
}

TEST_CASE("The wish to stop aborts as requested", "[BRG-400]") {
    Bench b;
    rig::Sequencer sequencer(plan());
    for (int i = 0; i < 5; ++i) b.step(&sequencer);
    b.step(&sequencer, {.abort = true});
    CHECK(sequencer.abort() == rig::Abort::requested);
}

TEST_CASE("A tripped PLC is reset only where that is allowed, with nothing on and every interlock good", "[BRG-400]") {
    const auto resets = [](Bench& b, rig::Sequencer* sequencer, bool allowed) {
        bool reset = false;
        for (int i = 0; i < 40; ++i) {
            b.step(sequencer, {.reset = allowed});
            reset = reset || b.commanded(Commanded::reset) == 1.0;
        }
        return reset;
    };
    Bench tripped;
    rig::at(tripped.plc.now.values, Measured::plc_state) = 1.0;
    CHECK_FALSE(resets(tripped, nullptr, false));
    CHECK(resets(tripped, nullptr, true));
    rig::at(tripped.plc.now.values, Measured::plc_state) = 0.0;
    tripped.step(nullptr, {.reset = true});
    CHECK(tripped.commanded(Commanded::reset) == 0.0);

    Bench open;
    rig::at(open.plc.now.values, Measured::plc_state) = 1.0;
    rig::at(open.plc.now.values, Measured::interlocks) = 14.0;
    CHECK_FALSE(resets(open, nullptr, true));

    Bench silent;
    rig::at(silent.plc.now.values, Measured::plc_state) = 1.0;
    silent.plc.now.age_s.fill(1.0);
    CHECK_FALSE(resets(silent, nullptr, true));

    // During a maneuver the trip is its abort, and nothing is reset before the safe end.
    Bench running;
    rig::Sequencer sequencer(plan());
    for (int i = 0; i < 5; ++i) running.step(&sequencer, {.reset = true});
    REQUIRE(sequencer.phase() == Phase::spin_up);
    rig::at(running.plc.now.values, Measured::plc_state) = 1.0;
    rig::at(running.plc.now.values, Measured::sledge_position_m) = 0.2;
    CHECK_FALSE(resets(running, &sequencer, true));
    CHECK(sequencer.abort() == rig::Abort::plc_tripped);
    CHECK(sequencer.phase() == Phase::aborting);
}

TEST_CASE("The sequencer's time is the rig's: SYNC where it is on the bus", "[BRG-400]") {
    Bench b;
    b.step(nullptr);
    const double start = b.node.moment().rig_s;
    for (int i = 0; i < 100; ++i) {
        b.feed.bus.syncs += 4;  // a host that is 2.5 times too slow
        b.step(nullptr);
    }
    CHECK(b.node.moment().rig_s - start == Approx(0.4));
}

TEST_CASE("What is wrong stands in the view", "[BRG-420]") {
    Bench b;
    b.feed.bus.view.controller.faults.insert(antiskid::control::Fault::heartbeat_lost);
    b.step(nullptr);
    rig::bridge::ViewModel view = view_of(b.node.moment(), b.node.limits());
    CHECK(view.controller == "standby");
    CHECK(view.plc == "ready");
    CHECK(view.bus == "up");
    REQUIRE(view.faults.size() == 1);
    CHECK(view.faults[0] == "heartbeat_lost");
    b.plc.now.link = rig::modbus::LinkState::lost;
    b.plc.now.error = "no answer within 200 ms";
    b.plc.now.age_s.fill(3.0);
    b.step(nullptr);
    view = view_of(b.node.moment(), b.node.limits());
    CHECK(view.plc == "lost");
    CHECK(view.note == "PLC: no answer within 200 ms");
    b.feed.bus.up = false;
    b.feed.bus.error = "CAN interface 'vcan0' went down";
    b.step(nullptr);
    CHECK(note_of(b.node.moment()) == "CAN interface 'vcan0' went down");
}
