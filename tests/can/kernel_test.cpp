// SocketCan against a kernel that refuses, lies and stumbles.
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <span>
#include <string>
#include <vector>

#include "firmware/can/socket_can.hpp"
#include "tests/can/fake_kernel.hpp"
#include "tests/can/kernel_socket.hpp"
#include "tests/catch.hpp"

using antiskid::can::Frame;
using antiskid::can::SocketCan;
using antiskid::can::SocketCanOptions;
using can_test::FakeKernel;
using namespace kernel_test;

TEST_CASE("whatever the kernel refuses while a socket is set up is named, and no descriptor stays open", "[CAN-080]") {
    struct Case {
        void (*set)(FakeKernel&);
        std::string interface, expected;
    };
    const std::vector<Case> cases{
        {[](FakeKernel& k) { k.socket_error = EAFNOSUPPORT; }, "can0", "this kernel has no CAN (`modprobe can_raw`"},
        {[](FakeKernel& k) { k.socket_error = EPROTONOSUPPORT; }, "can0", "run under `./rig vcan -- COMMAND`"},
        {[](FakeKernel& k) { k.socket_error = EMFILE; }, "can0", "cannot be opened: Too many open files"},
        {[](FakeKernel& k) { k.index_error = ENODEV; }, "can0",
         "does not exist: plug the adapter in, then `ip link set can0 up type can bitrate 1000000` (`ip -br "
         "link show type can`"},
        {[](FakeKernel& k) { k.index_error = ENODEV; }, "vcan0",
         "does not exist: make it with `ip link add dev vcan0 type vcan` and `ip link set vcan0 up`"},
        {[](FakeKernel& k) { k.index_error = EPERM; }, "can0", "cannot be looked up: Operation not permitted"},
        {[](FakeKernel& k) { k.hardware = ARPHRD_ETHER; }, "eth0", "is no CAN interface"},
        {[](FakeKernel& k) { k.flags_error = ENXIO; }, "can0", "has no flags: No such device or address"},
        {[](FakeKernel& k) { k.flags = 0; }, "can0", "is down: `ip link set can0 up type can bitrate 1000000`"},
        {[](FakeKernel& k) { k.flags = IFF_RUNNING; }, "vcan0", "is down: `ip link set vcan0 up`"},
        {[](FakeKernel& k) {
             k.option_errors[{SOL_CAN_RAW, CAN_RAW_FILTER}] = EINVAL;
         },
         "can0", "refused the filters: Invalid"},
        {[](FakeKernel& k) {
             k.option_errors[{SOL_CAN_RAW, CAN_RAW_ERR_FILTER}] = EINVAL;
         },
         "can0", "refused error frames"},
        {[](FakeKernel& k) {
             k.option_errors[{SOL_SOCKET, SO_TIMESTAMPNS}] = EINVAL;
         },
         "can0", "refused time stamps"},
        {[](FakeKernel& k) {
             k.option_errors[{SOL_SOCKET, SO_RXQ_OVFL}] = EINVAL;
         },
         "can0", "refused the drop counter"},
        {[](FakeKernel& k) {
             k.option_errors[{SOL_SOCKET, SO_RCVBUF}] = EINVAL;
         },
         "can0", "refused the receive buffer"},
        {[](FakeKernel& k) {
             k.option_errors[{SOL_SOCKET, SO_SNDBUF}] = EINVAL;
         },
         "can0", "refused the send buffer"},
        {[](FakeKernel& k) { k.bind_error = EADDRINUSE; }, "can0", "cannot be bound: Address already in use"},
        {[](FakeKernel&) {}, "", "is no interface name: expected 1 to 15 characters"},
        {[](FakeKernel&) {}, "sixteen-letters.", "is no interface name"},
    };
    for (const Case& c : cases) {
        FakeKernel kernel;
        c.set(kernel);
        CHECK_THAT(rejection(c.interface), ContainsSubstring("CAN interface '" + c.interface + "' ") && ContainsSubstring(c.expected));
        CHECK(kernel.open.empty());
    }
}

TEST_CASE(
    "the socket asks the kernel for the wanted identifiers, every error, stamps and drops, and a small send "
    "queue",
    "[CAN-081][CAN-080]") {
    FakeKernel kernel;
    kernel.address_error = EINVAL;  // an interface that does not say what it is gets the benefit of the doubt
    {
        const SocketCan bus("fifteen-letters", kWanted, SocketCanOptions{.receive_buffer_bytes = 4711});
        CHECK(bus.descriptor() == *kernel.open.begin());
        CHECK(kernel.looked_up == "fifteen-letters");
        CHECK(kernel.bound_index == 7);
        const auto filters = value<std::array<can_filter, 2>>(kernel.options[{SOL_CAN_RAW, CAN_RAW_FILTER}]);
        CHECK(filters[0].can_id == 0x110);
        CHECK(filters[1].can_id == 0x120);
        CHECK(filters[1].can_mask == (CAN_EFF_FLAG | CAN_SFF_MASK));
        CHECK(value<can_err_mask_t>(kernel.options[{SOL_CAN_RAW, CAN_RAW_ERR_FILTER}]) == CAN_ERR_MASK);
        CHECK(value<int>(kernel.options[{SOL_SOCKET, SO_TIMESTAMPNS}]) == 1);
        CHECK(value<int>(kernel.options[{SOL_SOCKET, SO_RXQ_OVFL}]) == 1);
        CHECK(value<int>(kernel.options[{SOL_SOCKET, SO_RCVBUF}]) == 4711);
        CHECK(value<int>(kernel.options[{SOL_SOCKET, SO_SNDBUF}]) == 1);
        CHECK(bus.status().up);
    }
    CHECK(kernel.open.empty());
}

TEST_CASE("frames that are no data frames of ours are counted, never delivered", "[CAN-081][CAN-080]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    kernel.arrivals = {data(0x110, 8, 1), data(0x110 | CAN_RTR_FLAG, 8, 2), data(0x110 | CAN_EFF_FLAG, 8, 3), data(0x110, 9, 4), data(0x120, 0, 5)};
    FakeKernel::Arrival cut = data(0x110, 8, 6);
    cut.length = CANFD_MTU;
    kernel.arrivals.push_back(cut);
    std::array<Frame, 10> frames;
    REQUIRE(bus.receive(frames) == 2);
    CHECK(frames[0].id == 0x110);
    CHECK(frames[0].length == 8);
    CHECK(frames[0].data[0] == 1);
    CHECK(frames[1].id == 0x120);
    CHECK(frames[1].length == 0);
    CHECK(bus.status().malformed == 4);
    CHECK(bus.receive(frames) == 0);
}

TEST_CASE("a batch is as large as the caller's room, and never larger than its own", "[CAN-080]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    for (unsigned i = 0; i < 100; ++i) kernel.arrivals.push_back(data(0x110, 1, static_cast<std::uint8_t>(i)));
    std::array<Frame, 100> frames;
    CHECK(bus.receive(std::span(frames).first(3)) == 3);
    CHECK(bus.receive(frames) == SocketCan::kBatch);
    CHECK(frames[0].data[0] == 3);
    CHECK(bus.receive(frames) == SocketCan::kBatch);
    CHECK(bus.receive(frames) == SocketCan::kBatch);
    CHECK(bus.receive(frames) == 1);
    CHECK(frames[0].data[0] == 99);
}

TEST_CASE("no room for frames is no error of the link, whatever failed before", "[CAN-080]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    kernel.arrivals.push_back(data(0x110, 1, 7));
    errno = ENETDOWN;
    CHECK(bus.receive({}) == 0);
    CHECK(bus.status().up);
    CHECK(take(bus) == 1);
}

TEST_CASE("the kernel's drop counter is followed across its roll-over", "[CAN-080]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    const auto after = [&](std::uint32_t drops) {
        kernel.arrivals.push_back(data(0x110, 1, 0));
        kernel.arrivals.back().drops = drops;
        static_cast<void>(take(bus));
        return bus.status().receive_dropped;
    };
    CHECK(after(3) == 3);
    CHECK(after(3) == 3);
    CHECK(after(0xFFFF'FFF0U) == 0xFFFF'FFF0U);
    CHECK(after(5) == 5);
}

TEST_CASE("bus-off lasts until the chip restarts or a frame arrives; sending alone does not end it", "[CAN-080]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    const auto error = [&](std::uint32_t classes) {
        kernel.arrivals.push_back(error_frame(classes));
        CHECK(take(bus) == 0);
    };
    error(CAN_ERR_CRTL);
    CHECK(bus.status().error_frames == 1);
    CHECK(bus.status().up);
    error(CAN_ERR_BUSOFF);
    CHECK(bus.status().bus_off);
    CHECK_FALSE(bus.status().up);
    CHECK(bus.send({}));
    CHECK_FALSE(bus.status().up);
    error(CAN_ERR_RESTARTED);
    CHECK_FALSE(bus.status().bus_off);
    CHECK(bus.status().up);
    error(CAN_ERR_BUSOFF);
    kernel.arrivals.push_back(data(0x110, 8, 0));
    CHECK(take(bus) == 1);
    CHECK_FALSE(bus.status().bus_off);
    CHECK(bus.status().up);
    CHECK(bus.status().bus_off_events == 2);
    CHECK(bus.status().error_frames == 4);
}

TEST_CASE("only an interface that is down or gone takes the link down; what can be sent again brings it up", "[CAN-080]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    std::uint32_t dropped = 0;
    for (const int error : {ENOBUFS, EAGAIN, EIO}) {
        kernel.send_error = error;
        CHECK_FALSE(bus.send({}));
        CHECK(bus.status().up);
        CHECK(bus.status().transmit_dropped == ++dropped);
    }
    for (const int error : {ENETDOWN, ENODEV, ENXIO}) {
        kernel.send_error = error;
        CHECK_FALSE(bus.send({}));
        CHECK_FALSE(bus.status().up);
        kernel.send_error = 0;
        CHECK(bus.send({}));
        CHECK(bus.status().up);
        kernel.receive_error = error;
        CHECK(take(bus) == 0);
        CHECK_FALSE(bus.status().up);
        kernel.arrivals.push_back(data(0x110, 8, 0));
        CHECK(take(bus) == 1);
        CHECK(bus.status().up);
    }
    CHECK(bus.status().transmit_dropped == 6);
}

TEST_CASE("what is sent is a classic data frame, whatever the caller's frame says", "[CAN-080]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    CHECK(bus.send({.id = 0x7FF, .length = 3, .data = {1, 2, 3, 4, 5, 6, 7, 8}, .received = {}}));
    CHECK(bus.send({.id = 0xFFFF'FFFF, .length = 64, .data = {}, .received = {}}));
    REQUIRE(kernel.sent.size() == 2);
    CHECK(kernel.sent[0].can_id == 0x7FF);
    CHECK(kernel.sent[0].can_dlc == 3);
    CHECK(kernel.sent[0].data[7] == 8);
    CHECK(kernel.sent[1].can_id == 0x7FF);
    CHECK(kernel.sent[1].can_dlc == 8);
}

TEST_CASE("a period's frames go out by one call, in order; what follows one that was refused is given up", "[CAN-058]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    std::array<Frame, SocketCan::kMaxSent + 1> frames{};
    for (std::uint32_t i = 0; i < frames.size(); ++i) frames[i].id = 0x100 + i;
    CHECK(bus.send_all({}) == 0);
    CHECK(kernel.calls.empty());
    CHECK(bus.send_all(std::span(frames).first(3)) == 3);
    CHECK(kernel.calls == std::vector<std::string>{"send"});
    REQUIRE(kernel.sent.size() == 3);
    CHECK(kernel.sent[0].can_id == 0x100);
    CHECK(kernel.sent[2].can_id == 0x102);
    CHECK(bus.status().transmit_dropped == 0);

    kernel.room = 2;
    CHECK(bus.send_all(std::span(frames).first(3)) == 2);
    CHECK(bus.status().transmit_dropped == 1);
    kernel.room = 0;
    CHECK(bus.send_all(std::span(frames).first(3)) == 0);
    CHECK(bus.status().transmit_dropped == 4);
    CHECK(bus.status().up);
    kernel.room = SIZE_MAX;
    CHECK(bus.send_all(frames) == SocketCan::kMaxSent);
    CHECK(bus.status().transmit_dropped == 5);

    kernel.send_error = ENETDOWN;
    CHECK(bus.send_all(std::span(frames).first(1)) == 0);
    CHECK_FALSE(bus.status().up);
    kernel.send_error = 0;
    CHECK(bus.send_all(std::span(frames).first(1)) == 1);
    CHECK(bus.status().up);
}

TEST_CASE("newest_only: no frame is put behind one of an earlier call that still waits", "[CAN-058]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted, SocketCanOptions{.newest_only = true});
    const std::array<Frame, 2> frames{};
    CHECK(bus.send_all(frames) == 2);
    CHECK(kernel.calls == std::vector<std::string>{"look at the queue", "send"});
    kernel.queued_bytes = 768;
    CHECK(bus.send_all(frames) == 0);
    CHECK(bus.status().transmit_dropped == 2);
    CHECK(bus.status().up);
    CHECK(kernel.sent.size() == 2);
    kernel.memory_error = ENOPROTOOPT;  // a kernel that does not say
    CHECK(bus.send_all(frames) == 2);
    kernel.memory_error = 0;
    kernel.queued_bytes = 0;
    CHECK(bus.send_all(frames) == 2);
}

TEST_CASE("a megabyte of received frames is asked for, unless another size is wanted", "[CAN-080]") {
    FakeKernel kernel;
    const auto asked = [&kernel] { return value<int>(kernel.options.at({SOL_SOCKET, SO_RCVBUF})); };
    const SocketCan usual("can0", kWanted);
    CHECK(asked() == 1'048'576);
    const SocketCan small("can0", kWanted, {.receive_buffer_bytes = 4096});
    CHECK(asked() == 4096);
}
