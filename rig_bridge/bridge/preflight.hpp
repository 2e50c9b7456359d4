/// `rig-bridge preflight`: PLC, bus, controller, ledger and computer before the wheel turns. Reads only: nothing is commanded, no register
/// written, no frame sent. Facts in, checks out; preflight_verb.cpp brings the facts of the world, tests their own.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "firmware/can/message_stats.hpp"
#include "firmware/can/observer.hpp"
#include "firmware/controller/can_link.hpp"
#include "firmware/controller/check.hpp"
#include "firmware/controller/machine.hpp"
#include "rig_bridge/bridge/bridge_setup.hpp"
#include "rig_bridge/bridge/options.hpp"
#include "rig_bridge/modbus/client.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace rig::bridge {

using antiskid::controller::Check;
using antiskid::controller::Checks;

/// A second of listening to everybody.
struct BusReception {
    std::string rejection;  ///< why nothing could be heard
    antiskid::can::BusView view;
    std::array<antiskid::can::MessageStats, antiskid::can::kRoleCount> stats{};
    std::string two_controllers;  ///< what shows that there are; empty: nothing does
    antiskid::can::Time until{};  ///< when listening ended, on the clock of the frames

    [[nodiscard]] const antiskid::can::MessageStats& of(antiskid::can::Role role) const { return stats[static_cast<std::size_t>(role)]; }
};

struct LedgerFacts {
    bool there = false;
    std::string rejection;  ///< damaged, held, or not to be written
    std::vector<record::Campaign> campaigns;
};

struct PreflightContext {
    std::function<antiskid::controller::MachineFacts(const antiskid::controller::MachineNeeds&)> machine;
    std::function<antiskid::controller::CanLink(const std::string& interface)> link;
    std::function<LedgerFacts(const std::filesystem::path&)> ledger;
    /// After it has been looked at for a while, without a word to it.
    std::function<modbus::Snapshot(const BridgeSetup&)> plc;
    std::function<BusReception(const BridgeSetup&)> bus;
    /// Who has the rig already, as rig_held() says it; empty: nobody.
    std::function<std::string(const BridgeSetup&)> holder;
};

/// Link, map version, heartbeat, plausible registers, each interlock, state, and the rig at rest.
[[nodiscard]] Checks plc_checks(const modbus::Snapshot& plc, const BridgeSetup& setup);
/// No other bridge of this computer has the rig.
[[nodiscard]] Check free_check(const std::string& holder);
/// No other bridge talks on the bus, and one controller at the most.
[[nodiscard]] Check only_bridge_check(const BusReception& reception);
[[nodiscard]] Check only_controller_check(const BusReception& reception);
/// Sensors and controller are heard, the controller has no fault, and there is no other of it or of the bridge.
[[nodiscard]] Checks bus_checks(const BusReception& reception, const BridgeSetup& setup);
/// Whole, free, writable; and of this configuration where it has this scenario's campaign. `ledger`: empty: none is asked for.
[[nodiscard]] Checks ledger_checks(const LedgerFacts& facts, const std::filesystem::path& ledger, const BridgeSetup& setup);

/// A configuration that cannot be read is a check that failed.
[[nodiscard]] antiskid::controller::Report preflight_report(const PreflightCommand& command, const PreflightContext& context);

}  // namespace rig::bridge
