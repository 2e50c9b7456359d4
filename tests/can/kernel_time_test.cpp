// How SocketCan waits and stamps, against a kernel that stumbles.
#include <linux/can/raw.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <vector>

#include "firmware/can/socket_can.hpp"
#include "tests/can/fake_kernel.hpp"
#include "tests/can/kernel_socket.hpp"
#include "tests/catch.hpp"

using antiskid::can::Frame;
using antiskid::can::SocketCan;
using antiskid::can::SocketCanOptions;
using antiskid::can::Time;
using can_test::FakeKernel;
using namespace kernel_test;

TEST_CASE("a wait that one identifier ends is one call, and the wake socket never stays full", "[CAN-058]") {
    FakeKernel kernel;
    {
        SocketCan bus("can0", kWanted, SocketCanOptions{.wakes = kWanted[1]});
        CHECK(kernel.open.size() == 3);
        const auto filter = value<can_filter>(kernel.options[{SOL_CAN_RAW, CAN_RAW_FILTER}]);
        CHECK(filter.can_id == kWanted[1]);
        CHECK(filter.can_mask == (CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_SFF_MASK));
        CHECK(bus.wait(Time{1'500'000}));
        CHECK(kernel.calls == std::vector<std::string>{"wait for the wake socket"});
        CHECK(kernel.waited.back() == Time{1'500'000});
        for (std::size_t event = 1; event < 10 * SocketCan::kBatch; ++event) CHECK(bus.wait(Time{1}));
        CHECK(std::count(kernel.calls.begin(), kernel.calls.end(), "receive") == 10);
        kernel.calls.clear();
        kernel.poll_answer = 0;
        CHECK_FALSE(bus.wait(Time{1}));
        CHECK(kernel.calls == std::vector<std::string>{"wait for the wake socket", "receive"});
    }
    CHECK(kernel.open.empty());
}

TEST_CASE("a wake socket that cannot be opened is an error, and no descriptor stays open", "[CAN-058][CAN-080]") {
    FakeKernel kernel;
    int& error = GENERATE(false, true) ? kernel.epoll_error : kernel.epoll_add_error;
    error = EMFILE;
    CHECK_THROWS_WITH(SocketCan("can0", kWanted, SocketCanOptions{.wakes = kWanted[1]}), ContainsSubstring("'can0' cannot be waited for"));
    CHECK(kernel.open.empty());
}

TEST_CASE("a long wait and the reception after it are one call, a short wait is exact", "[CAN-058]") {
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

TEST_CASE("waiting asks for the time that is left, never for less than none", "[CAN-080]") {
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

TEST_CASE("the clocks are compared by the least disturbed of three readings", "[CAN-081][CAN-080]") {
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

TEST_CASE("stamps that leap or go back cost a look at the clocks and nothing else", "[CAN-081][CAN-080]") {
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

TEST_CASE("a frame without a stamp is old, so that nobody takes it for fresh", "[CAN-081][CAN-080]") {
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
