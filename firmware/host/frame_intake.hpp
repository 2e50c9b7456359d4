/// Passes frames from the bus to the controller's port, in order and bounded in number.
#pragma once

#include <array>
#include <cstddef>

#include "firmware/can/bus.hpp"
#include "firmware/can/controller_port.hpp"

namespace antiskid::host {

class FrameIntake {
  public:
    /// Largest number of frames taken in one call: more than ten times what 1 Mbit/s can carry in 1 ms. The rest waits for the next call.
    static constexpr std::size_t kMax = 256;

    struct Taken {
        std::size_t frames = 0;
        bool full = false;              ///< stopped at kMax, more may be waiting
        bool sync = false;              ///< the last one was an accepted SYNC
        control::Time sync_received{};  ///< reception of the last frame taken, on the clock of the bus
    };

    /// Both must outlive the intake.
    FrameIntake(can::Bus& bus, can::ControllerPort& port) : bus_(bus), port_(port) {}

    /// Takes all frames that have arrived, with one call to the bus unless they exceed a batch. A reception time later than `now` (the frame arrived
    /// during this call) becomes `now`.
    Taken drain(control::Time now);

    /// Takes frames up to and including the next SYNC; waits up to `longest` if none has arrived. All count as received at `now`, the lockstep time.
    /// Frames after SYNC wait for the next call.
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
