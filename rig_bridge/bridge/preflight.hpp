/// `rig-bridge preflight`: PLC, bus, controller, ledger and computer before the wheel turns. Read-only: no register is written, no frame sent. Facts
/// in, checks out; preflight_verb.cpp gathers the real facts, tests supply their own.
#pragma once

#include <array>
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

/// Result of listening to the bus for a second.
struct BusReception {
    std::string rejection;  ///< why nothing could be heard
    antiskid::can::BusView view;
    std::array<antiskid::can::MessageStats, antiskid::can::kRoleCount> stats{};
    std::string two_controllers;  ///< evidence of them; empty: none
    antiskid::can::Time until{};  ///< when listening ended, on the clock of the frames

    [[nodiscard]] const antiskid::can::MessageStats& of(antiskid::can::Role role) const { return stats[static_cast<std::size_t>(role)]; }
};

struct LedgerFacts {
    bool there = false;
    std::string rejection;  ///< why it cannot be used: damaged, held or not writable
    std::vector<record::Campaign> campaigns;
};

struct PreflightContext {
    std::function<antiskid::controller::MachineFacts(const antiskid::controller::MachineNeeds&)> machine;
    std::function<antiskid::controller::CanLink(const std::string& interface)> link;
    std::function<LedgerFacts(const std::filesystem::path&)> ledger;
    /// Reads the PLC for a while without writing to it.
    std::function<modbus::Snapshot(const BridgeSetup&)> plc;
    std::function<BusReception(const BridgeSetup&)> bus;
    /// Who holds the rig, by rig_held(); empty: nobody.
    std::function<std::string(const BridgeSetup&)> holder;
};

/// Link, map version, heartbeat, plausible registers, each interlock, state, and the rig at rest.
[[nodiscard]] Checks plc_checks(const modbus::Snapshot& plc, const BridgeSetup& setup);
/// Checks that no other bridge on this computer holds the rig.
[[nodiscard]] Check free_check(const std::string& holder);
/// Checks that no other bridge and at most one controller sends on the bus.
[[nodiscard]] Check only_bridge_check(const BusReception& reception);
[[nodiscard]] Check only_controller_check(const BusReception& reception);
/// Checks that frames of sensors and controller arrive, the controller has no fault, and there is no second controller or bridge.
[[nodiscard]] Checks bus_checks(const BusReception& reception, const BridgeSetup& setup);
/// Checks that the ledger is undamaged, free and writable, and a campaign of this scenario has this configuration. `ledger` empty: no check.
[[nodiscard]] Checks ledger_checks(const LedgerFacts& facts, const std::filesystem::path& ledger, const BridgeSetup& setup);

/// An unreadable configuration is reported as a failed check.
[[nodiscard]] antiskid::controller::Report preflight_report(const PreflightCommand& command, const PreflightContext& context);

}  // namespace rig::bridge
