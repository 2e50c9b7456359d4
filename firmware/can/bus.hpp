/// The bus as the programs see it: a real SocketCAN interface or the in-process loopback.
///
/// Nothing here allocates, locks, throws or logs after construction: both ends may be used from a real-time
/// thread.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/can/frame.hpp"

namespace antiskid::can {

/// What the link itself reports; counts run from construction and roll over at 2^32.
struct LinkStatus {
    bool up = true;                  ///< false: interface down, gone, or bus-off
    bool bus_off = false;            ///< the controller chip left the bus
    std::uint32_t error_frames = 0;  ///< error frames of any class
    std::uint32_t bus_off_events = 0;
    std::uint32_t receive_dropped = 0;   ///< dropped by the kernel because our receive queue was full
    std::uint32_t transmit_dropped = 0;  ///< discarded because the queue was full or the link down; never sent later
    std::uint32_t malformed = 0;         ///< remote, extended, FD or over-long frames, ignored
};

class Bus {
  public:
    /// Longest time that one call waits. A wait of this length may end some ms late; shorter waits are exact and can cost one more system call.
    static constexpr Time kLongestWait{20'000'000};

    virtual ~Bus() = default;

    /// Moves frames that have arrived into `frames`, oldest first; returns how many. Never waits.
    virtual std::size_t receive(std::span<Frame> frames) = 0;

    /// Like receive(), but if no frame has arrived, waits for one: at most `timeout`, and at most kLongestWait.
    virtual std::size_t receive_within(Time timeout, std::span<Frame> frames) {
        const std::size_t count = receive(frames);
        return count > 0 || !wait(timeout) ? count : receive(frames);
    }

    /// Sends the frame at once, or discards it and returns false if the queue is full or the link is down. Never waits or retries.
    virtual bool send(const Frame& frame) = 0;

    /// Sends the frames of one period in order, without waiting; returns how many were taken. After the first frame that is not taken the rest is
    /// discarded.
    virtual std::size_t send_all(std::span<const Frame> frames) {
        std::size_t taken = 0;
        while (taken < frames.size() && send(frames[taken])) ++taken;
        return taken;
    }

    /// Waits until a frame can be received or `timeout` has passed; false after a time-out.
    virtual bool wait(Time timeout) = 0;

    [[nodiscard]] virtual LinkStatus status() const = 0;
};

}  // namespace antiskid::can
