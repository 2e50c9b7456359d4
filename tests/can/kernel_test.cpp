// SocketCan against a kernel that refuses, lies and stumbles.
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "firmware/can/socket_can.hpp"
#include "tests/can/fake_kernel.hpp"
#include "tests/catch.hpp"

using antiskid::can::Frame;
using antiskid::can::SocketCan;
using antiskid::can::SocketCanOptions;
using antiskid::can::Time;
using can_test::FakeKernel;

namespace {

constexpr std::array<std::uint16_t, 2> kWanted{0x110, 0x120};

FakeKernel::Arrival data(std::uint32_t id, std::uint8_t length, std::uint8_t first) {
    FakeKernel::Arrival arrival;
    arrival.frame.can_id = id;
    arrival.frame.can_dlc = length;
    arrival.frame.data[0] = first;
    return arrival;
}

FakeKernel::Arrival error_frame(std::uint32_t classes) {
    return data(CAN_ERR_FLAG | classes, 8, 0);
}

/// Why `interface` was refused.
std::string refusal(const std::string& interface) {
    try {
        const SocketCan bus(interface, kWanted);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "";
}

template <typename T>
T value(const std::vector<unsigned char>& bytes) {
    T out{};
    REQUIRE(bytes.size() == sizeof out);
    std::memcpy(&out, bytes.data(), sizeof out);
    return out;
}

std::size_t take(SocketCan& bus) {
    std::array<Frame, SocketCan::kBatch> frames;
    return bus.receive(frames);
}

}  // namespace

TEST_CASE("whatever the kernel refuses while a socket is set up is named, and no descriptor stays open",
          "[CAN-080][CAN-200]") {
    struct Case {
        void (*set)(FakeKernel&);
        std::string interface, expected;
    };
    const std::vector<Case> cases{
        {[](FakeKernel& k) { k.socket_error = EAFNOSUPPORT; }, "can0",
         "this kernel has no CAN (`modprobe can_raw`"},
        {[](FakeKernel& k) { k.socket_error = EPROTONOSUPPORT; }, "can0",
         "run under `./rig vcan -- COMMAND`"},
        {[](FakeKernel& k) { k.socket_error = EMFILE; }, "can0", "cannot be opened: Too many open files"},
        {[](FakeKernel& k) { k.index_error = ENODEV; }, "can0",
         "does not exist: plug the adapter in, then `ip link set can0 up type can bitrate 1000000` (`ip -br "
         "link show type can`"},
        {[](FakeKernel& k) { k.index_error = ENODEV; }, "vcan0",
         "does not exist: make it with `ip link add dev vcan0 type vcan` and `ip link set vcan0 up`"},
        {[](FakeKernel& k) { k.index_error = EPERM; }, "can0",
         "cannot be looked up: Operation not permitted"},
        {[](FakeKernel& k) { k.hardware = ARPHRD_ETHER; }, "eth0", "is no CAN interface"},
        {[](FakeKernel& k) { k.flags_error = ENXIO; }, "can0", "has no flags: No such device or address"},
        {[](FakeKernel& k) { k.flags = 0; }, "can0",
         "is down: `ip link set can0 up type can bitrate 1000000`"},
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
        CHECK_THAT(refusal(c.interface), ContainsSubstring("CAN interface '" + c.interface + "' ") &&
                                             ContainsSubstring(c.expected));
        CHECK(kernel.open.empty());
    }
}

TEST_CASE(
    "the socket asks the kernel for the wanted identifiers, every error, stamps and drops, and a small send "
    "queue",
    "[CAN-086][CAN-200]") {
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

TEST_CASE("frames that are no data frames of ours are counted, never delivered", "[CAN-087][CAN-200]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    kernel.arrivals = {data(0x110, 8, 1), data(0x110 | CAN_RTR_FLAG, 8, 2), data(0x110 | CAN_EFF_FLAG, 8, 3),
                       data(0x110, 9, 4), data(0x120, 0, 5)};
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

TEST_CASE("a batch is as large as the caller's room, and never larger than its own", "[CAN-200]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    for (unsigned i = 0; i < 100; ++i)
        kernel.arrivals.push_back(data(0x110, 1, static_cast<std::uint8_t>(i)));
    std::array<Frame, 100> frames;
    CHECK(bus.receive(std::span(frames).first(3)) == 3);
    CHECK(bus.receive(frames) == SocketCan::kBatch);
    CHECK(frames[0].data[0] == 3);
    CHECK(bus.receive(frames) == SocketCan::kBatch);
    CHECK(bus.receive(frames) == SocketCan::kBatch);
    CHECK(bus.receive(frames) == 1);
    CHECK(frames[0].data[0] == 99);
}

TEST_CASE("no room for frames is no error of the link, whatever failed before", "[CAN-200]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    kernel.arrivals.push_back(data(0x110, 1, 7));
    errno = ENETDOWN;
    CHECK(bus.receive({}) == 0);
    CHECK(bus.status().up);
    CHECK(take(bus) == 1);
}

TEST_CASE("the kernel's drop counter is followed across its roll-over", "[CAN-083][CAN-200]") {
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

TEST_CASE("bus-off lasts until the chip restarts or a frame arrives; sending alone does not end it",
          "[CAN-082][CAN-200]") {
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

TEST_CASE("only an interface that is down or gone takes the link down; what can be sent again brings it up",
          "[CAN-085][CAN-200]") {
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

TEST_CASE("what is sent is a classic data frame, whatever the caller's frame says", "[CAN-200]") {
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

TEST_CASE("a period's frames go out by one call, in order; what follows one that was refused is given up",
          "[CAN-210]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    std::array<Frame, SocketCan::kMostSent + 1> frames{};
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
    CHECK(bus.send_all(frames) == SocketCan::kMostSent);
    CHECK(bus.status().transmit_dropped == 5);

    kernel.send_error = ENETDOWN;
    CHECK(bus.send_all(std::span(frames).first(1)) == 0);
    CHECK_FALSE(bus.status().up);
    kernel.send_error = 0;
    CHECK(bus.send_all(std::span(frames).first(1)) == 1);
    CHECK(bus.status().up);
}

TEST_CASE("newest_only: no frame is put behind one of an earlier call that still waits", "[CAN-211]") {
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

TEST_CASE("a wait that one identifier ends is one call, and the bell never stays full", "[CAN-212]") {
    FakeKernel kernel;
    {
        SocketCan bus("can0", kWanted, SocketCanOptions{.wakes = kWanted[1]});
        CHECK(kernel.open.size() == 3);
        const auto filter = value<can_filter>(kernel.options[{SOL_CAN_RAW, CAN_RAW_FILTER}]);
        CHECK(filter.can_id == kWanted[1]);
        CHECK(filter.can_mask == (CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_SFF_MASK));
        CHECK(bus.wait(Time{1'500'000}));
        CHECK(kernel.calls == std::vector<std::string>{"wait for the bell"});
        CHECK(kernel.waited.back() == Time{1'500'000});
        for (std::size_t ring = 1; ring < 10 * SocketCan::kBatch; ++ring) CHECK(bus.wait(Time{1}));
        CHECK(std::count(kernel.calls.begin(), kernel.calls.end(), "receive") == 10);
        kernel.calls.clear();
        kernel.poll_answer = 0;
        CHECK_FALSE(bus.wait(Time{1}));
        CHECK(kernel.calls == std::vector<std::string>{"wait for the bell", "receive"});
    }
    CHECK(kernel.open.empty());
}

TEST_CASE("a bell that cannot be had is an error, and no descriptor stays open", "[CAN-212][CAN-200]") {
    FakeKernel kernel;
    int& error = GENERATE(false, true) ? kernel.epoll_error : kernel.epoll_add_error;
    error = EMFILE;
    CHECK_THROWS_WITH(SocketCan("can0", kWanted, SocketCanOptions{.wakes = kWanted[1]}),
                      ContainsSubstring("'can0' cannot be waited for"));
    CHECK(kernel.open.empty());
}

TEST_CASE("a long wait and the reception after it are one call, a short wait is exact", "[CAN-210]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    std::array<Frame, 4> frames;
    kernel.arrivals = {data(0x110, 8, 1), data(0x110, 8, 2)};
    CHECK(bus.receive_within(SocketCan::kLongestWait, frames) == 2);
    CHECK(kernel.calls == std::vector<std::string>{"wait and receive"});
    CHECK(bus.receive_within(SocketCan::kLongestWait, frames) == 0);  // in vain

    kernel.calls.clear();
    kernel.arrivals = {data(0x110, 8, 3)};
    CHECK(bus.receive_within(Time{1'500'000}, frames) == 1);
    CHECK(kernel.calls == std::vector<std::string>{"wait", "receive"});
    CHECK(kernel.waited.back() == Time{1'500'000});
    kernel.poll_answer = 0;
    CHECK(bus.receive_within(Time{1'500'000}, frames) == 0);
    CHECK(kernel.calls.back() == "wait");
    const auto limit = value<timeval>(kernel.options[{SOL_SOCKET, SO_RCVTIMEO}]);
    CHECK(Time{limit.tv_sec * 1'000'000'000 + limit.tv_usec * 1000} == SocketCan::kLongestWait);
}

TEST_CASE("waiting asks for the time that is left, never for less than none", "[CAN-200]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    CHECK(bus.wait(Time{2'500'000'000}));
    CHECK(kernel.waited.back() == Time{2'500'000'000});
    kernel.poll_answer = 0;
    CHECK_FALSE(bus.wait(Time{-5}));
    CHECK(kernel.waited.back() == Time{0});
    kernel.poll_answer = -1;
    CHECK_FALSE(bus.wait(Time{1}));
    CHECK(kernel.waited.back() == Time{1});
}

TEST_CASE("the clocks are compared by the least disturbed of three readings", "[CAN-081][CAN-200]") {
    FakeKernel kernel;
    const auto error_after = [&](std::deque<Time> takes) {
        const int before = kernel.readings;
        kernel.reading_takes = std::move(takes);
        SocketCan bus("can0", kWanted);
        CHECK(kernel.readings - before == 3 - static_cast<int>(kernel.reading_takes.size()));
        kernel.reading_takes.clear();
        kernel.arrivals.push_back(data(0x110, 0, 0));
        kernel.arrivals.back().wall = Time{1'000'000} + kernel.wall_ahead;
        std::array<Frame, 1> frames;
        REQUIRE(bus.receive(frames) == 1);
        return frames[0].received - Time{1'000'000};
    };
    // The wall clock is read at the beginning of each reading: the middle is off by half of what the reading took.
    CHECK(error_after({Time{40'000}, Time{10}, Time{10}}) == Time{20'000});
    CHECK(error_after({Time{100'000}, Time{200'000}, Time{60'000}}) == Time{30'000});
    CHECK(error_after({Time{100'000}, Time{50'000}, Time{10}}) == Time{25'000});
    CHECK(error_after({Time{100'000}, Time{100'000}, Time{300'000}}) == Time{50'000});
}

TEST_CASE("stamps that leap or go back cost a look at the clocks and nothing else", "[CAN-081][CAN-200]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    std::array<Frame, 1> frames;
    const auto received = [&](Time true_time, Time wall) {
        kernel.arrivals.push_back(data(0x110, 0, 0));
        kernel.arrivals.back().wall = wall;
        REQUIRE(bus.receive(frames) == 1);
        return frames[0].received - true_time;
    };
    constexpr Time kHalfReading{500};
    CHECK(received(Time{1'000'000}, Time{1'000'000} + kernel.wall_ahead) == kHalfReading);
    const int settled = kernel.readings;
    CHECK(received(Time{3'000'000}, Time{3'000'000} + kernel.wall_ahead) == kHalfReading);
    CHECK(kernel.readings == settled);
    kernel.wall_ahead += Time{3'600'000'000'000};
    CHECK(received(Time{3'100'000}, Time{3'100'000} + kernel.wall_ahead) == kHalfReading);
    CHECK(kernel.readings == settled + 1);
    kernel.wall_ahead -= Time{7'200'000'000'000};
    CHECK(received(Time{3'200'000}, Time{3'200'000} + kernel.wall_ahead) == kHalfReading);
    CHECK(kernel.readings == settled + 2);
}

TEST_CASE("a frame without a stamp is old, so that nobody takes it for fresh", "[CAN-081][CAN-200]") {
    FakeKernel kernel;
    SocketCan bus("can0", kWanted);
    for (const bool foreign_note : {false, true}) {
        kernel.arrivals.push_back(data(0x110, 0, 0));
        kernel.arrivals.back().stamped = false;
        kernel.arrivals.back().foreign_note = foreign_note;
        std::array<Frame, 1> frames;
        REQUIRE(bus.receive(frames) == 1);
        CHECK(frames[0].received == -kernel.wall_ahead + Time{500});
    }
}

TEST_CASE("a megabyte of received frames is asked for, unless another size is wanted", "[CAN-200]") {
    FakeKernel kernel;
    const auto asked = [&kernel] { return value<int>(kernel.options.at({SOL_SOCKET, SO_RCVBUF})); };
    const SocketCan usual("can0", kWanted);
    CHECK(asked() == 1'048'576);
    const SocketCan small("can0", kWanted, {.receive_buffer_bytes = 4096});
    CHECK(asked() == 4096);
}
