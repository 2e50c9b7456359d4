/// SocketCan over real AF_CAN sockets. Run by `./rig vcan --`, which gives vcan0 and the right to make interfaces.
#include "firmware/can/socket_can.hpp"

#include <array>
#include <string>
#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/can/roles.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"
#include "tests/vcan/real_bus.hpp"

using namespace antiskid;
using namespace antiskid::can;
using can_test::ours;
using control::Time;
using namespace real_bus;

TEST_CASE("frames arrive as they were sent, with a monotonic time stamp", "[CAN-081]") {
    SocketCan a("vcan0", kWanted);
    SocketCan b("vcan0", kWanted);
    std::array<Frame, 4> frames;
    CHECK(b.receive(frames) == 0);
    CHECK_FALSE(b.wait(Time{1'000'000}));
    const Time before = monotonic();
    for (std::uint8_t length = 0; length <= 8; ++length) {
        const Frame sent{.id = 0x120, .length = length, .data = {1, 2, 3, 4, 5, 6, 7, 8}, .received = {}};
        REQUIRE(a.send(sent));
        REQUIRE(b.wait(kPatience));
        REQUIRE(b.receive(frames) == 1);
        CHECK(frames[0].id == 0x120);
        CHECK(frames[0].length == length);
        for (std::size_t i = 0; i < length; ++i) CHECK(frames[0].data[i] == i + 1);
        // A tenth of a second of room: a wall-clock stamp would be off by decades.
        CHECK(frames[0].received > before - Time{100'000'000});
        CHECK(frames[0].received < monotonic() + Time{100'000'000});
    }
    CHECK(a.receive(frames) == 0);  // not one's own
    CHECK(b.status().malformed == 0);
    CHECK(b.status().up);
}

TEST_CASE("more frames than fit into one call wait for the next, in order", "[CAN-081]") {
    SocketCan a("vcan0", kWanted);
    SocketCan b("vcan0", kWanted);
    for (std::uint32_t i = 0; i < 100; ++i) REQUIRE(a.send(numbered(0x110, i)));
    SocketCan last("vcan0", std::array<std::uint16_t, 1>{0x120});
    REQUIRE(a.send(numbered(0x120, 100)));
    REQUIRE(last.wait(kPatience));  // then all before it have arrived, too
    std::array<Frame, 64> frames;
    CHECK(b.receive(frames) == SocketCan::kBatch);
    CHECK(number_of(frames[0]) == 0);
    CHECK(b.receive(std::span(frames).first(3)) == 3);
    CHECK(number_of(frames[2]) == SocketCan::kBatch + 2);
    std::vector<Frame> rest = drain(b);
    REQUIRE(rest.size() == 101 - SocketCan::kBatch - 3);
    rest.pop_back();
    CHECK(number_of(rest.back()) == 99);
}

TEST_CASE("error frames are counted; bus-off lasts until the chip restarts or frames arrive", "[CAN-080]") {
    SocketCan bus("vcan0", kWanted);
    SocketCan other("vcan0", {});
    using Status = antiskid::can::LinkStatus;
    const auto errors = [](std::uint32_t count) { return [count](const Status& status) { return status.error_frames == count; }; };
    shell("cansend vcan0 20000004#0004000000000000");
    CHECK(await_status(bus, errors(1)));
    CHECK(bus.status().up);

    shell("cansend vcan0 20000040#0000000000000000");
    CHECK(await_status(bus, errors(2)));
    CHECK(bus.status().bus_off);
    CHECK_FALSE(bus.status().up);
    CHECK(bus.status().bus_off_events == 1);
    shell("cansend vcan0 20000100#0000000000000000");
    CHECK(await_status(bus, errors(3)));
    CHECK_FALSE(bus.status().bus_off);
    CHECK(bus.status().up);

    shell("cansend vcan0 20000040#0000000000000000");
    CHECK(await_status(bus, errors(4)));
    CHECK(bus.send(numbered(0x200, 0)));  // a queue that takes frames is no proof of a bus
    CHECK(bus.status().bus_off);
    CHECK(other.send(numbered(0x110, 1)));
    CHECK(await(bus, 1).size() == 1);
    CHECK_FALSE(bus.status().bus_off);
    CHECK(bus.status().up);
    CHECK(bus.status().bus_off_events == 2);
    CHECK(bus.status().error_frames == 4);
}

TEST_CASE("frames that the kernel dropped are counted to the last one", "[CAN-080]") {
    SocketCan a("vcan0", kWanted);
    SocketCan b("vcan0", kWanted, {.receive_buffer_bytes = 1});
    std::size_t received = 0;
    for (int round = 0; round < 3; ++round) {
        for (std::uint32_t i = 0; i < 300; ++i) REQUIRE(a.send(numbered(0x110, i)));
        received += await(b, 1).size();
    }
    REQUIRE(a.send(numbered(0x110, 0)));  // carries the counter
    received += await(b, 1).size();
    CHECK(b.status().receive_dropped > 0);
    CHECK(received + b.status().receive_dropped == 901);
    CHECK(a.status().transmit_dropped == 0);
}

TEST_CASE("a full transmit queue gives frames up, counts them, and never sends them later", "[CAN-080]") {
    const Interface slow("vcan6");
    SocketCan b("vcan6", kWanted);
    // Some 60 frames a second drain. A short queue of the interface refuses first; of a long one, our own buffer.
    for (const std::string& queue_bytes : {std::string("64"), std::string("100000")}) {
        SocketCan a("vcan6", kWanted);
        shell("tc qdisc add dev vcan6 root tbf rate 8kbit burst 32 limit " + queue_bytes);
        std::vector<std::uint32_t> taken;
        std::uint32_t number = 0;
        for (; number < 200; ++number) {
            if (a.send(numbered(0x110, number))) taken.push_back(number);
        }
        INFO("queue of " << queue_bytes << " bytes");
        CHECK_FALSE(taken.empty());
        CHECK(taken.size() <= 16);
        CHECK(a.status().transmit_dropped == 200 - taken.size());
        CHECK(a.status().up);
        const Time deadline = monotonic() + kPatience;
        while (!a.send(numbered(0x110, ++number)) && monotonic() < deadline) {
            static_cast<void>(a.wait(Time{5'000'000}));
        }
        taken.push_back(number);
        std::vector<std::uint32_t> arrived;
        while (arrived.size() < taken.size() && b.wait(kPatience)) {
            for (const Frame& frame : drain(b)) arrived.push_back(number_of(frame));
        }
        CHECK(arrived == taken);
        shell("tc qdisc del dev vcan6 root");
        CHECK(drain(b).empty());
    }
}

TEST_CASE("newest_only: after a jam one call's frames are old, and right behind them comes the newest", "[CAN-058]") {
    const Interface slow("vcan6");
    SocketCan b("vcan6", kWanted);
    SocketCan a("vcan6", kWanted, {.newest_only = true});
    // Some 8 frames a second drain: few while all are sent, on a slow machine too.
    shell("tc qdisc add dev vcan6 root tbf rate 1kbit burst 32 limit 100000");
    std::vector<std::uint32_t> taken;
    std::uint32_t number = 0;
    const auto send_next = [&] {
        const std::array<Frame, 2> frames{numbered(0x110, number), numbered(0x120, number)};
        const std::size_t count = a.send_all(frames);
        if (count == 2) taken.push_back(number);
        ++number;
        return count;
    };
    while (number < 200) send_next();
    CHECK(taken.size() <= 3);  // two frames go at once, and one call's wait
    CHECK(a.status().transmit_dropped == 2 * (200 - taken.size()));
    const Time deadline = monotonic() + kPatience;
    while (send_next() == 0 && monotonic() < deadline) static_cast<void>(a.wait(Time{1'000'000}));
    CHECK(taken.back() == number - 1);
    std::vector<std::uint32_t> arrived;
    while (arrived.size() < 2 * taken.size() && b.wait(kPatience))
        for (const Frame& frame : drain(b)) arrived.push_back(number_of(frame));
    REQUIRE(arrived.size() == 2 * taken.size());
    for (std::size_t i = 0; i < arrived.size(); ++i) CHECK(arrived[i] == taken[i / 2]);
}

TEST_CASE("of one period's frames only that which is waited for ends the wait, and all of them are there", "[CAN-058]") {
    SocketCan a("vcan0", kWanted);
    SocketCan b("vcan0", kWanted, {.wakes = kWanted[1]});
    std::array<Frame, 4> frames;
    CHECK(a.send(numbered(0x110, 0)));
    CHECK_FALSE(b.wait(Time{5'000'000}));
    CHECK(b.receive(frames) == 1);
    for (std::uint32_t period = 0; period < 1000; ++period) {  // more than the wake socket holds unread
        const std::array<Frame, 2> sent{numbered(0x110, period), numbered(0x120, period)};
        REQUIRE(a.send_all(sent) == 2);
        REQUIRE(b.wait(kPatience));
        REQUIRE(b.receive(frames) == 2);
        REQUIRE(number_of(frames[1]) == period);
    }
    // A program that was held up finds the wake socket full, and is woken again after that.
    for (std::uint32_t period = 0; period < 1000; ++period) REQUIRE(a.send(numbered(0x120, period)));
    while (b.receive(frames) > 0) continue;
    while (b.wait(Time{1'000'000})) continue;
    for (int turn = 0; turn < 100; ++turn) CHECK_FALSE(b.wait(Time{100'000}));
    CHECK(a.send(numbered(0x120, 1)));
    CHECK(b.wait(kPatience));
    CHECK(b.receive(frames) == 1);
}

TEST_CASE("a long wait ends with a frame, or in good time without", "[CAN-058]") {
    SocketCan a("vcan0", kWanted);
    SocketCan b("vcan0", kWanted);
    std::array<Frame, 4> frames;
    const Time began = monotonic();
    CHECK(b.receive_within(SocketCan::kLongestWait, frames) == 0);
    CHECK(monotonic() - began >= SocketCan::kLongestWait);
    CHECK(b.receive_within(Time{1'500'000}, frames) == 0);
    const std::array<Frame, 2> sent{numbered(0x110, 1), numbered(0x120, 2)};
    CHECK(a.send_all(sent) == 2);
    std::size_t count = b.receive_within(SocketCan::kLongestWait, frames);
    if (count == 1) count += b.receive_within(SocketCan::kLongestWait, frames);
    CHECK(count == 2);
}

TEST_CASE("foreign traffic at full load does not get in, and loses us nothing", "[CAN-081]") {
    SocketCan a("vcan0", kWanted);
    SocketCan b("vcan0", kWanted);
    shell("cangen vcan0 -g 0 -i -I 555 -L 8 -n 30000 & cangen vcan0 -g 0 -i -e -L 8 -n 10000 &");
    std::uint32_t received = 0;
    std::uint32_t wrong = 0;
    for (std::uint32_t sent = 0; sent < 3000; ++sent) {
        while (!a.send(numbered(0x110, sent))) static_cast<void>(a.wait(Time{1'000'000}));
        for (const Frame& frame : drain(b)) {
            wrong += frame.id == 0x110 && number_of(frame) == received ? 0 : 1;
            ++received;
        }
    }
    received += static_cast<std::uint32_t>(await(b, 3000 - received).size());
    CHECK(received == 3000);
    CHECK(wrong == 0);
    CHECK(b.status().receive_dropped == 0);
    CHECK(b.status().malformed == 0);
    shell("while pgrep -x cangen >/dev/null; do sleep 0.1; done");
}

TEST_CASE("remote, extended and FD frames are not used", "[CAN-081]") {
    const Interface fd("vcan2");
    shell("ip link set vcan2 down && ip link set vcan2 mtu 72 && ip link set vcan2 up");
    SocketCan bus("vcan2", kWanted);
    shell("cansend vcan2 110#R && cansend vcan2 110#R8");
    CHECK(await_status(bus, [](const auto& status) { return status.malformed == 2; }));
    shell("cansend vcan2 00000110#1122334455667788 && cansend vcan2 110##3112233445566778899AABBCC");
    shell("cansend vcan2 110#1122334455667788");
    CHECK(await(bus, 1).size() == 1);  // the one after those that must not get in
    CHECK(bus.status().malformed == 2);
}

TEST_CASE("both ports agree over a real bus as they do without one", "[CAN-058][CAN-081]") {
    SocketCan rig_bus("vcan0", ids(ours(), kToRig).span());
    SocketCan controller_bus("vcan0", ids(ours(), kToController).span());
    RigPort rig(ours(), kStep);
    ControllerPort port(ours(), kStep);
    std::array<Frame, 16> frames;
    RigSample sample;
    bool same = true;
    for (std::uint32_t step = 0; step < 2000; ++step) {
        sample.wheel.edge_count += step % 5;
        sample.wheel.edge_time += kStep;
        sample.pressure_Pa = 500.0F * static_cast<float>(step);
        for (std::size_t count = rig.due_frames(sample, frames), i = 0; i < count; ++i) REQUIRE(rig_bus.send(frames[i]));
        REQUIRE(rig_bus.send(rig.sync(step)));
        while (port.sync_count() <= step) {
            REQUIRE(controller_bus.wait(kPatience));
            for (std::size_t count = controller_bus.receive(frames), i = 0; i < count; ++i) port.accept(frames[i]);
        }
        same = same && port.sync_number() == step && port.sensors().wheel.edge_count == sample.wheel.edge_count &&
               port.sensors().pressure.pressure_Pa == sample.pressure_Pa;
        control::Command command;
        command.current_mA = 0.02F * static_cast<float>(step);
        for (std::size_t count = port.due_frames(command, frames), i = 0; i < count; ++i) {
            REQUIRE(controller_bus.send(frames[i]));
        }
        while (rig.stats(Role::valve).accepted <= step) {
            REQUIRE(rig_bus.wait(kPatience));
            for (std::size_t count = rig_bus.receive(frames), i = 0; i < count; ++i) rig.accept(frames[i]);
        }
        same = same && rig.controller().current_mA == static_cast<float>(ours().valve_current_mA.rounded(static_cast<double>(command.current_mA)));
    }
    CHECK(same);
    for (const Role role : {Role::wheel, Role::flywheel, Role::pressure, Role::maneuver, Role::rig_heartbeat, Role::sync}) {
        CHECK(port.stats(role).rejected() == 0);
        CHECK(port.stats(role).lost == 0);
    }
    CHECK(port.unknown_ids() == 0);
    CHECK(rig.unknown_ids() == 0);
    CHECK(controller_bus.status().receive_dropped == 0);
}
