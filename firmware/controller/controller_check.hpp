/// `antiskid-controller --check`: the machine, the CAN interface, what the rig sends, the loop's timing and, when asked for, the valve.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "firmware/can/bus.hpp"
#include "firmware/controller/can_link.hpp"
#include "firmware/controller/check.hpp"
#include "firmware/controller/machine.hpp"
#include "firmware/controller/options.hpp"
#include "firmware/host/clock.hpp"

namespace antiskid::controller {

/// Access of the check to machine, bus and clock. check_controller() passes the real ones.
struct CheckContext {
    std::function<MachineFacts(const MachineNeeds&)> machine;
    std::function<CanLink(const std::string&)> link;
    /// Opens the bus for these identifiers, or throws std::runtime_error with the reason.
    std::function<std::unique_ptr<can::Bus>(std::span<const std::uint16_t>)> open;
    host::Clock& clock;
    /// Runs `work`, which takes about `expected`, with the scheduling of the loop's thread, and waits for its end.
    std::function<void(control::Time expected, const std::function<void()>& work)> on_loop_thread;
};

/// Sends frames only for a valve step. An unreadable configuration is reported as a failed check. `stop` ends it early.
[[nodiscard]] Report controller_report(const controller::Options& options, const CheckContext& context, const std::atomic<bool>& stop);

/// Checks this machine; returns the exit status. `options.check` must be set.
[[nodiscard]] int check_controller(const controller::Options& options);

}  // namespace antiskid::controller
