/// A real vcan interface, and frames on it.
#pragma once

#include <array>
#include <cstdlib>
#include <ctime>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "firmware/can/socket_can.hpp"

namespace real_bus {

using namespace antiskid::can;

inline constexpr Time kStep{1'000'000};
inline constexpr Time kPatience{5'000'000'000};

inline void shell(const std::string& command) {
    if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
}

/// A virtual interface of its own, up, gone at the end.
class Interface {
  public:
    /// `before`: a shell command that runs before it is up.
    explicit Interface(std::string interface, const std::string& before = "true") : name_(std::move(interface)) {
        shell("ip link add dev " + name_ + " type vcan && " + before + " && ip link set " + name_ + " up");
    }
    Interface(const Interface&) = delete;
    Interface& operator=(const Interface&) = delete;
    ~Interface() { static_cast<void>(std::system(("ip link del " + name_ + " 2>/dev/null").c_str())); }

  private:
    std::string name_;
};

inline constexpr std::array<std::uint16_t, 2> kWanted{0x110, 0x120};

inline Frame numbered(std::uint16_t id, std::uint32_t number) {
    Frame frame{.id = id, .length = 8, .data = {}, .received = {}};
    for (std::size_t i = 0; i < 4; ++i) frame.data[i] = static_cast<std::uint8_t>(number >> (8 * i));
    return frame;
}

inline std::uint32_t number_of(const Frame& frame) {
    return std::uint32_t{frame.data[0]} | std::uint32_t{frame.data[1]} << 8U | std::uint32_t{frame.data[2]} << 16U |
           std::uint32_t{frame.data[3]} << 24U;
}

/// Everything that is there now.
inline std::vector<Frame> drain(Bus& bus) {
    std::vector<Frame> all;
    std::array<Frame, 16> batch;
    while (const std::size_t count = bus.receive(batch)) all.insert(all.end(), batch.begin(), batch.begin() + count);
    return all;
}

/// The same, once at least `count` are there: the kernel delivers in its own time.
inline std::vector<Frame> await(Bus& bus, std::size_t count) {
    std::vector<Frame> all = drain(bus);
    while (all.size() < count && bus.wait(kPatience)) {
        const std::vector<Frame> more = drain(bus);
        all.insert(all.end(), more.begin(), more.end());
    }
    return all;
}

/// Until the status says so; no data frame may arrive meanwhile.
template <typename Told>
inline bool await_status(Bus& bus, const Told& told) {
    while (drain(bus).empty()) {
        if (told(bus.status())) return true;
        if (!bus.wait(kPatience)) return false;
    }
    return false;
}

inline Time monotonic() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return Time{std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec};
}

}  // namespace real_bus
