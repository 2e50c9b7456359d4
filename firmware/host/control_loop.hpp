/// The real-time loop: one wait, one receive, a step, one send, a record. Nothing in it allocates, locks, logs
/// or throws.
///
/// The valve command goes first, so that nothing delays it; in lockstep it goes last, because the rig continues as soon as it receives it.
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
    /// On exit the safe current is sent one period apart until the bus has taken kSafeCommands of them, in at most kSafeAttempts attempts.
    static constexpr std::uint32_t kSafeCommands = 3;
    static constexpr std::uint32_t kSafeAttempts = 100;
    /// In lockstep only every kTimedSteps-th step is timed: the rig waits for the loop, and in a virtual machine reading the clock costs as much as
    /// receiving a frame.
    static constexpr std::uint64_t kTimedSteps = 16;

    ControlLoop(const LoopSettings& settings, const LoopContext& context) : settings_(settings), context_(context) {}

    /// Runs until `stop` is set; the last frames that it sends are kSafeCommands valve commands with the safe current.
    void run(const std::atomic<bool>& stop);

    /// Valid after run() has returned.
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
