/// From the bus to the controller's port, in order and bounded.
#pragma once

#include <array>
#include <cstddef>

#include "firmware/can/bus.hpp"
#include "firmware/can/controller_port.hpp"

namespace antiskid::host {

class FrameIntake {
  public:
    /// Most frames taken in one call: more than ten times what 1 Mbit/s can carry in 1 ms. What is left stays
    /// in the kernel's queue.
    static constexpr std::size_t kMax = 256;

    struct Taken {
        std::size_t frames = 0;
        bool full = false;              ///< stopped at kMost, there may be more
        bool sync = false;              ///< the last one was an accepted SYNC
        control::Time sync_received{};  ///< its reception, on the clock of the bus
    };

    /// Both must outlive the intake.
    FrameIntake(can::Bus& bus, can::ControllerPort& port) : bus_(bus), port_(port) {}

    /// All that has arrived, by one call to the bus unless there is more than a batch. A reception later than `now` (a frame that came while this
    /// call ran) becomes `now`.
    Taken drain(control::Time now);

    /// Up to and including the next SYNC, waiting up to `longest` where nothing is there; all of them count as
    /// received at `now`, the lockstep time. Frames behind SYNC wait for the next call.
    Taken take_until_sync(control::Time now, control::Time longest = {});

  private:
    [[nodiscard]] bool has_next(bool first, control::Time longest);

    can::Bus& bus_;
    can::ControllerPort& port_;
    std::array<can::Frame, 32> batch_{};
    std::size_t next_ = 0;
    std::size_t end_ = 0;
};

}  // namespace antiskid::host
