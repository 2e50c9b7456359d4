#include <array>
#include <cstdlib>
#include <new>
#include <random>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/loopback.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/can/rounded_link.hpp"
#include "tests/can/layouts.hpp"
#include "tests/can/port_samples.hpp"
#include "tests/catch.hpp"

using namespace antiskid;
using namespace antiskid::can;
using can_test::foreign;
using can_test::ours;
using control::Time;
using namespace pohost_test;

namespace {

// Operator new has no other place for it. NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
std::size_t allocations = 0;

}  // namespace

void* operator new(std::size_t size) {
    ++allocations;
    if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
    throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
    ++allocations;
    return std::malloc(size == 0 ? 1 : size);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t /*size*/) noexcept {
    std::free(memory);
}

TEST_CASE("all 2048 identifiers, every length, right and wrong contents: only what is ours and right is used", "[CAN-050]") {
    for (const Layout* layout : {&ours(), &foreign()}) {
        RigPort rig(*layout, kStep);
        const Frame good = rig.maneuver(some_sample().maneuver);
        std::uint32_t sent = 0;
        std::uint32_t expected_accepted = 0;
        std::uint32_t expected_unknown = 0;
        ControllerPort port(*layout, kStep);
        for (std::uint32_t id = 0; id < 2048; ++id) {
            const Message* message = nullptr;
            for (const Role role :
                 {Role::wheel, Role::flywheel, Role::pressure, Role::maneuver, Role::rig_heartbeat, Role::emergency_stop, Role::sync}) {
                if (layout->operator[](role).id == id) message = &layout->operator[](role);
            }
            for (std::uint8_t length = 0; length <= 8; ++length) {
                Frame frame = good;
                frame.id = id;
                frame.length = length;
                port.accept(frame);
                ++sent;
                if (message == nullptr) ++expected_unknown;
                const bool right =
                    message != nullptr && length == message->length && (id == good.id || message->protection.protection != Protection::counter_crc);
                if (right) ++expected_accepted;
            }
        }
        CHECK(port.unknown_ids() == expected_unknown);
        CHECK(accepted(port) == expected_accepted);
        CHECK(rejected(port) == sent - expected_unknown - expected_accepted);
        port.accept({.id = 4096, .length = 8, .data = {}, .received = {}});
        CHECK(port.unknown_ids() == expected_unknown + 1);
    }
}

TEST_CASE("the controller does not listen to its own messages", "[CAN-050]") {
    ControllerPort other(ours(), kStep);
    ControllerPort port(ours(), kStep);
    std::array<Frame, ControllerPort::kMaxFrames> frames;
    std::uint32_t sent = 0;
    for (int i = 0; i < 100; ++i) {
        const std::size_t count = other.due_frames({}, frames);
        for (std::size_t k = 0; k < count; ++k) port.accept(frames[k]);
        sent += static_cast<std::uint32_t>(count);
    }
    CHECK(port.unknown_ids() == sent);
    CHECK(accepted(port) == 0);
}

TEST_CASE("a refused frame is counted where the controller sees it, and the last good value stays", "[CAN-050]") {
    RigPort rig(ours(), kStep);
    ControllerPort port(ours(), kStep);
    const RigSample sample = some_sample();
    const auto feed = [&port](Frame frame, std::int64_t at) {
        frame.received = Time{at};
        port.accept(frame);
    };
    feed(rig.wheel(sample.wheel), 100);
    feed(rig.flywheel(sample.flywheel), 200);
    feed(rig.pressure(sample.pressure_Pa), 300);
    feed(rig.maneuver(sample.maneuver), 400);
    feed(rig.heartbeat(), 500);
    const control::Sensors before = port.sensors();
    CHECK(before.wheel.received == Time{100});
    CHECK(before.flywheel.received == Time{200});
    CHECK(before.pressure.pressure_Pa == 5.5e6F);
    CHECK(before.maneuver.law == control::Law::threshold);
    CHECK(before.maneuver.arm);
    CHECK(before.maneuver.weight_on_wheels);
    CHECK(before.maneuver.demand_Pa == 2e7F);
    CHECK(before.maneuver.slip_reference == 0.25F);
    CHECK(before.maneuver.deceleration_mps2 == 3.2F);
    CHECK(before.maneuver.current_mA == 17.0F);
    CHECK(before.rig_heartbeat_received == Time{500});

    const auto spoil = [&](Frame frame) {
        Frame wrong = frame;
        wrong.data[wrong.length - 1U] ^= 0x40U;
        feed(wrong, 1000);
        Frame shorter = frame;
        --shorter.length;
        feed(shorter, 1001);
        Frame longer = frame;
        ++longer.length;
        feed(longer, 1002);
    };
    spoil(rig.wheel({}));
    spoil(rig.flywheel({}));
    spoil(rig.pressure(0.0F));
    spoil(rig.maneuver({}));
    spoil(rig.heartbeat());
    const control::Sensors& after = port.sensors();
    CHECK(after.wheel.rejected == 3);
    CHECK(after.flywheel.rejected == 3);
    CHECK(after.pressure.rejected == 3);
    CHECK(after.maneuver.rejected == 3);
    CHECK(after.wheel.received == before.wheel.received);
    CHECK(after.wheel.edge_count == before.wheel.edge_count);
    CHECK(after.wheel.edge_time == before.wheel.edge_time);
    CHECK(after.flywheel.edge_count == before.flywheel.edge_count);
    CHECK(after.pressure.pressure_Pa == before.pressure.pressure_Pa);
    CHECK(after.maneuver.demand_Pa == before.maneuver.demand_Pa);
    CHECK(after.maneuver.arm);
    CHECK(after.rig_heartbeat_received == before.rig_heartbeat_received);
    for (const Role role : {Role::wheel, Role::flywheel, Role::pressure, Role::maneuver, Role::rig_heartbeat}) {
        CHECK(port.stats(role).accepted == 1);
        CHECK(port.stats(role).wrong_length == 2);
        CHECK(port.stats(role).wrong_crc == 1);
    }
}

TEST_CASE("edge counts and times go on across the roll-over of their fields", "[CAN-050]") {
    RigPort rig(ours(), kStep);
    ControllerPort port(ours(), kStep);
    // Two field widths of time (859 s) and many of counts, from just below a roll-over.
    std::uint32_t count = 0xFFFF'FF00U;
    std::int64_t ticks = (std::int64_t{1} << 32) - 1000;
    port.accept(rig.wheel({.edge_count = count, .edge_time = Time{ticks * 100}, .speed_radps = 0.0F}));
    const control::SpeedInput first = port.sensors().wheel;
    CHECK(first.edge_time == Time{ticks * 100});
    std::mt19937 random(53);
    const std::uint32_t count_0 = count;
    const std::int64_t ticks_0 = ticks;
    bool same = true;
    while (ticks - ticks_0 < (std::int64_t{1} << 33)) {
        count += std::uniform_int_distribution<std::uint32_t>(0, 0xFFFF)(random);
        ticks += std::uniform_int_distribution<std::int64_t>(0, 40'000'000)(random);
        const Time within_tick{ticks * 100 + std::uniform_int_distribution<std::int64_t>(0, 99)(random)};
        port.accept(rig.wheel({.edge_count = count, .edge_time = within_tick, .speed_radps = 0.0F}));
        const control::SpeedInput& now = port.sensors().wheel;
        same = same && now.edge_count - first.edge_count == count - count_0 && now.edge_time - first.edge_time == Time{(ticks - ticks_0) * 100};
    }
    CHECK(same);
    CHECK(port.stats(Role::wheel).rejected() == 0);
}

TEST_CASE("an edge before the zero of the sensor's clock lies in its own tick", "[CAN-050]") {
    RigPort rig(ours(), kStep);
    ControllerPort port(ours(), kStep);
    const auto time_after = [&](std::int64_t edge_ns) {
        port.accept(rig.wheel({.edge_count = 0, .edge_time = Time{edge_ns}, .speed_radps = 0.0F}));
        return port.sensors().wheel.edge_time;
    };
    const Time first = time_after(-150);
    CHECK(time_after(-50) - first == Time{100});
    CHECK(time_after(50) - first == Time{200});
}

TEST_CASE("a layout knows which laws it has a code for", "[CTL-330]") {
    CHECK(ours().maneuver.has(control::Law::pressure_bias));
    CHECK(foreign().maneuver.has(control::Law::threshold));
    CHECK_FALSE(foreign().maneuver.has(control::Law::pressure_bias));
}

TEST_CASE("a law or state that does not exist is refused", "[CAN-050]") {
    RigPort rig(ours(), kStep);
    ControllerPort port(ours(), kStep);
    ManeuverSample maneuver;
    for (int law = 0; law < 8; ++law) {
        maneuver.law = static_cast<control::Law>(law);
        port.accept(rig.maneuver(maneuver));
    }
    CHECK(port.stats(Role::maneuver).accepted == 6);
    CHECK(port.stats(Role::maneuver).wrong_value == 2);
    CHECK(port.sensors().maneuver.rejected == 2);
    CHECK(port.sensors().maneuver.law == control::Law::peak_slip);
    control::Command command;
    for (int state = 0; state < 16; ++state) {
        command.state = static_cast<control::State>(state);
        rig.accept(port.status(command));
    }
    CHECK(rig.stats(Role::status).accepted == 8);
    CHECK(rig.stats(Role::status).wrong_value == 8);
    CHECK(rig.controller().state == control::State::safe);
}

TEST_CASE("one-shot inputs last one step; the link's state as long as it holds, and at least one step", "[CAN-050]") {
    ControllerPort port(ours(), kStep);
    port.note_missed_periods(3);
    CHECK(port.sensors().missed_periods == 3);
    CHECK_FALSE(port.sensors().command_unsent);
    port.note_command_unsent();
    CHECK(port.sensors().command_unsent);
    port.clear_one_shots();
    CHECK(port.sensors().missed_periods == 0);
    CHECK_FALSE(port.sensors().command_unsent);

    LinkStatus link;
    port.note_link(link);
    CHECK_FALSE(port.sensors().bus_off);
    link.bus_off_events = 1;  // bus-off and back between two steps
    port.note_link(link);
    CHECK(port.sensors().bus_off);
    port.note_link(link);
    CHECK_FALSE(port.sensors().bus_off);
    link.up = false;
    for (int i = 0; i < 3; ++i) {
        port.note_link(link);
        port.clear_one_shots();
        CHECK(port.sensors().bus_off);
    }
    link.up = true;
    port.note_link(link);
    CHECK_FALSE(port.sensors().bus_off);
}

TEST_CASE("no memory is allocated per frame or step", "[CAN-045]") {
    for (const Layout* layout : {&ours(), &foreign()}) {
        RigPort rig(*layout, kStep);
        ControllerPort port(*layout, kStep);
        RoundedLink link(*layout, kStep);
        Loopback hub;
        Bus& a = hub.connect();
        Bus& b = hub.connect();
        std::array<Frame, 16> frames;
        RigSample sample = some_sample();
        control::Command command;
        const std::size_t before = allocations;
        for (int step = 0; step < 500; ++step) {
            sample.wheel.edge_count += 2;
            sample.emergency_stop = step % 7 == 0;
            std::size_t count = rig.due_frames(sample, frames);
            frames[count++] = rig.sync(static_cast<std::uint32_t>(step));
            frames[count - 1].data[0] ^= 1U;
            for (std::size_t i = 0; i < count; ++i) a.send(frames[i]);
            count = b.receive(frames);
            for (std::size_t i = 0; i < count; ++i) port.accept(frames[i]);
            port.note_link(b.status());
            command.current_mA = link.sense(sample, Time{step}).pressure.pressure_Pa * 1e-6F;
            port.clear_one_shots();
            count = port.due_frames(command, frames);
            for (std::size_t i = 0; i < count; ++i) b.send(frames[i]);
            count = a.receive(frames);
            for (std::size_t i = 0; i < count; ++i) rig.accept(frames[i]);
        }
        CHECK(allocations == before);
        CHECK(rig.controller().current_mA == link.current_mA(command));
    }
}

TEST_CASE("the link counts as down for one step after a bus-off that came and went between two", "[CAN-050][CAN-201]") {
    ControllerPort port(ours(), kStep);
    LinkStatus link;
    const auto reported = [&] {
        port.note_link(link);
        return port.sensors().bus_off;
    };
    CHECK_FALSE(reported());
    ++link.bus_off_events;
    CHECK(reported());
    CHECK_FALSE(reported());
    link.bus_off = true;
    CHECK(reported());
    CHECK(reported());
    link.bus_off = false;
    link.up = false;
    CHECK(reported());
    link.up = true;
    CHECK_FALSE(reported());
}
