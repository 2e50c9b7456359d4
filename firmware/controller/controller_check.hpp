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

/// What the check knows of the world. check_controller() brings the real one.
struct CheckContext {
    std::function<MachineFacts(const MachineNeeds&)> machine;
    std::function<CanLink(const std::string&)> link;
    /// Opens the bus for these identifiers, or throws std::runtime_error saying why not.
    std::function<std::unique_ptr<can::Bus>(std::span<const std::uint16_t>)> open;
    host::Clock& clock;
    /// Runs the work, which takes about so long, with the loop's rights and waits for its end.
    std::function<void(control::Time expected, const std::function<void()>& work)> on_loop_thread;
};

/// Without a valve step it sends nothing. A configuration that cannot be read is a check that failed. `stop` ends it early.
[[nodiscard]] Report controller_report(const controller::Options& options, const CheckContext& context, const std::atomic<bool>& stop);

/// On this machine; returns the exit status. `options.check` is set.
[[nodiscard]] int check_controller(const controller::Options& options);

}  // namespace antiskid::controller
