// The rig's side of the bus: what arrives there, and when it sends.
#include <array>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"
#include "tests/can/layouts.hpp"
#include "tests/can/port_samples.hpp"
#include "tests/catch.hpp"

using namespace antiskid;
using namespace antiskid::can;
using can_test::foreign;
using can_test::ours;
using control::Time;
using namespace pohost_test;

TEST_CASE("command, state and every fault arrive at the rig", "[CAN-058]") {
    for (const Layout* layout : {&ours(), &foreign()}) {
        ControllerPort port(*layout, kStep);
        RigPort rig(*layout, kStep);
        for (std::uint8_t i = 0; i < control::kFaultCount; ++i) {
            control::Command command;
            command.current_mA = 1.25F * static_cast<float>(i);
            command.state = static_cast<control::State>(i % control::kStateCount);
            command.slip = -0.5F + 0.05F * static_cast<float>(i);
            command.slip_reference = 0.24F;
            command.speed_mps = 60.0F - static_cast<float>(i);
            command.faults.insert(static_cast<control::Fault>(i));
            Frame frame = port.valve_command(command.current_mA);
            frame.received = Time{i};
            rig.accept(frame);
            rig.accept(port.status(command));
            rig.accept(port.faults(command.faults));
            rig.accept(port.heartbeat());
            const ControllerView& view = rig.controller();
            CHECK(view.command_received == Time{i});
            CHECK(view.current_mA == command.current_mA);
            CHECK(view.state == command.state);
            CHECK(view.slip == Approx(command.slip).margin(0.0006));
            CHECK(view.slip_reference == 0.24F);
            CHECK(view.speed_mps == Approx(command.speed_mps).margin(0.02));
            CHECK(view.faults == command.faults);
        }
        for (const Role role : {Role::valve, Role::status, Role::faults, Role::controller_heartbeat}) {
            CHECK(rig.stats(role).accepted == control::kFaultCount);
            CHECK(rig.stats(role).rejected() == 0);
        }
    }
}

TEST_CASE("what the peak law has found arrives at the rig, where the layout has the message", "[CAN-058]") {
    ControllerPort port(ours(), kStep);
    RigPort rig(ours(), kStep);
    Frame frame = port.road({.peak_slip = 0.1713F, .grip_N = 31'002.0F, .confidence = 0.752F});
    frame.received = Time{7};
    rig.accept(frame);
    CHECK(rig.controller().road_received == Time{7});
    CHECK(rig.controller().road.peak_slip == Approx(0.1713).margin(5e-5));
    CHECK(rig.controller().road.grip_N == Approx(31'002.0).margin(2.5));
    CHECK(rig.controller().road.confidence == Approx(0.752).margin(0.0025));
    CHECK_FALSE(foreign()[Role::road].bound);
}

TEST_CASE("every message comes at its period, and slow ones never meet within a step", "[CAN-058]") {
    RigPort rig(ours(), kStep);
    ControllerPort port(ours(), kStep);
    std::array<Frame, 16> frames;
    std::array<unsigned, 2048> seen{};
    for (int step = 0; step < 1000; ++step) {
        std::size_t count = rig.due_frames(some_sample(), frames);
        count += port.due_frames({}, std::span(frames).subspan(count));
        for (std::size_t i = 0; i < count; ++i) ++seen[frames[i].id];
        CHECK(count <= 5);
        if (step == 0) CHECK(count == 5);  // the maneuver command comes with the first sample
    }
    for (std::size_t i = 0; i < kRoleCount; ++i) {
        const Message& message = ours().messages[i];
        INFO(name(static_cast<Role>(i)));
        const bool cyclic = message.period.count() != 0 && static_cast<Role>(i) != Role::maneuver_state;
        CHECK(seen[message.id] == (cyclic ? 1000 * kStep / message.period : 0));
    }
    RigPort slow(ours(), Time{3'000'000});
    seen.fill(0);
    for (int step = 0; step < 1200; ++step) {
        const std::size_t count = slow.due_frames(some_sample(), frames);
        for (std::size_t i = 0; i < count; ++i) ++seen[frames[i].id];
    }
    CHECK(seen[ours()[Role::wheel].id] == 1200);
    CHECK(seen[ours()[Role::maneuver].id] == 200);  // every 18 ms: never slower than promised
}

TEST_CASE("an emergency stop goes first, every step, for as long as it is asked for", "[CAN-058]") {
    RigPort rig(ours(), kStep);
    RigSample sample = some_sample();
    std::array<Frame, RigPort::kMaxFrames> frames;
    for (int step = 0; step < 10; ++step) {
        sample.emergency_stop = step >= 3 && step < 6;
        REQUIRE(rig.due_frames(sample, frames) >= 3);
        CHECK((frames[0].id == ours()[Role::emergency_stop].id) == sample.emergency_stop);
    }
}

TEST_CASE("SYNC carries its number modulo the field", "[CAN-058]") {
    for (const Layout* layout : {&ours(), &foreign()}) {
        RigPort rig(*layout, kStep);
        ControllerPort port(*layout, kStep);
        port.accept(rig.sync(70'000));
        CHECK(port.sync_count() == 1);
        CHECK(port.sync_number() == (70'000U & layout->sync_counter.mask()));
    }
}

TEST_CASE("the rig counts what is spoilt or has no meaning, and sends a valve command when it is due", "[CAN-050][CAN-201]") {
    Layout slow = ours();
    slow[Role::valve].period = Time{2'000'000};
    ControllerPort port(slow, kStep);
    RigPort rig(slow, kStep);
    std::array<Frame, ControllerPort::kMaxFrames> frames;
    control::Command command;
    command.state = static_cast<control::State>(9);
    unsigned valve_commands = 0;
    for (int i = 0; i < 100; ++i) {
        const std::size_t count = port.due_frames(command, frames);
        for (std::size_t k = 0; k < count; ++k) {
            valve_commands += frames[k].id == slow[Role::valve].id ? 1 : 0;
            rig.accept(frames[k]);
            Frame spoilt = frames[k];
            spoilt.data[1] ^= 0x80U;
            rig.accept(spoilt);
        }
    }
    CHECK(valve_commands == 50);
    CHECK(rig.stats(Role::valve).accepted == 50);
    CHECK(rig.stats(Role::valve).wrong_crc == 50);
    CHECK(rig.stats(Role::status).accepted == 0);
    CHECK(rig.stats(Role::status).wrong_value == 10);
    rig.accept({.id = 0x7FE, .length = 8, .data = {}, .received = {}});
    CHECK(rig.unknown_ids() == 1);
}
