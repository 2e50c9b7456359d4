/// The real-time loop: one wait, one receive, a step, one send, a record. Nothing in it allocates, locks, logs
/// or throws.
///
/// The valve command goes first, so that nothing delays it; in lockstep it goes last, because the rig moves
/// on when it has it.
#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/can/bus.hpp"
#include "firmware/can/controller_port.hpp"
#include "firmware/control/controller.hpp"
#include "firmware/host/clock.hpp"
#include "firmware/host/cycle_record.hpp"
#include "firmware/host/loop_statistics.hpp"
#include "firmware/host/pacer.hpp"

namespace antiskid::host {

struct LoopSettings {
    Time period{};
    float safe_current_mA = 0.0F;
    bool valve_last = false;  ///< lockstep
};

/// What the loop works with; all of it must outlive the loop.
struct LoopContext {
    Clock& clock;
    Pacer& pacer;
    can::Bus& bus;
    can::ControllerPort& port;
    control::Controller& controller;
    CycleRing& ring;
};

class ControlLoop {
  public:
    /// Closing commands: as many as must get through, and how often at most that is tried, one period apart.
    static constexpr std::uint32_t kSafeCommands = 3;
    static constexpr std::uint32_t kSafeAttempts = 100;
    /// In lockstep every so many-th step is timed: the rig waits for all that the loop does, and in a virtual machine
    /// a reading of the clock costs as much as a reception.
    static constexpr std::uint64_t kTimedSteps = 16;

    ControlLoop(const LoopSettings& settings, const LoopContext& context) : settings_(settings), context_(context) {}

    /// Until `stop`; then the valve's safe current, kSafeCommands times, is the last that the bus gets from
    /// here.
    void run(const std::atomic<bool>& stop);

    /// Once run() has returned.
    [[nodiscard]] const LoopStatistics& statistics() const { return statistics_; }

  private:
    void cycle(const Wake& wake);
    [[nodiscard]] std::uint32_t send_due(const control::Command& command);
    void send_safe_current();

    LoopSettings settings_;
    LoopContext context_;
    LoopStatistics statistics_;
    Time last_woke_{};
};

}  // namespace antiskid::host
