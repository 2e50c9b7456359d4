/// A socket on the fake kernel, and what arrives there.
#pragma once

#include <linux/can/error.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "firmware/can/socket_can.hpp"
#include "tests/can/fake_kernel.hpp"
#include "tests/catch.hpp"

namespace kernel_test {

using antiskid::can::Frame;
using antiskid::can::SocketCan;
using can_test::FakeKernel;

inline constexpr std::array<std::uint16_t, 2> kWanted{0x110, 0x120};

inline FakeKernel::Arrival data(std::uint32_t id, std::uint8_t length, std::uint8_t first) {
    FakeKernel::Arrival arrival;
    arrival.frame.can_id = id;
    arrival.frame.can_dlc = length;
    arrival.frame.data[0] = first;
    return arrival;
}

inline FakeKernel::Arrival error_frame(std::uint32_t classes) {
    return data(CAN_ERR_FLAG | classes, 8, 0);
}

/// Why `interface` was refused.
inline std::string rejection(const std::string& interface) {
    try {
        const SocketCan bus(interface, kWanted);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "";
}

template <typename T>
inline T value(const std::vector<unsigned char>& bytes) {
    T out{};
    REQUIRE(bytes.size() == sizeof out);
    std::memcpy(&out, bytes.data(), sizeof out);
    return out;
}

inline std::size_t take(SocketCan& bus) {
    std::array<Frame, SocketCan::kBatch> frames;
    return bus.receive(frames);
}

}  // namespace kernel_test
