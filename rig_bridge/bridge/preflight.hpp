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
#include "firmware/preflight/can_link.hpp"
#include "firmware/preflight/check.hpp"
#include "firmware/preflight/machine.hpp"
#include "rig_bridge/bridge/options.hpp"
#include "rig_bridge/bridge/setup.hpp"
#include "rig_bridge/modbus/client.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace rig {

using antiskid::preflight::Check;
using antiskid::preflight::Checks;

/// A second of listening to everybody.
struct BusHeard {
    std::string refusal;  ///< why nothing could be heard
    antiskid::can::BusView view;
    std::array<antiskid::can::MessageStats, antiskid::can::kRoleCount> stats{};
    std::string two_controllers;  ///< what shows that there are; empty: nothing does
    antiskid::can::Time until{};  ///< when listening ended, on the clock of the frames

    [[nodiscard]] const antiskid::can::MessageStats& of(antiskid::can::Role role) const { return stats[static_cast<std::size_t>(role)]; }
};

struct LedgerFacts {
    bool there = false;
    std::string refusal;  ///< damaged, held, or not to be written
    std::vector<Campaign> campaigns;
};

struct PreflightDoors {
    std::function<antiskid::preflight::MachineFacts(const antiskid::preflight::MachineNeeds&)> machine;
    std::function<antiskid::preflight::CanLink(const std::string& interface)> link;
    std::function<LedgerFacts(const std::filesystem::path&)> ledger;
    /// After it has been looked at for a while, without a word to it.
    std::function<Snapshot(const Setup&)> plc;
    std::function<BusHeard(const Setup&)> bus;
    /// Who has the rig already, as rig_held() says it; empty: nobody.
    std::function<std::string(const Setup&)> holder;
};

/// Link, map version, heartbeat, plausible registers, each interlock, state, and the rig at rest.
[[nodiscard]] Checks plc_checks(const Snapshot& plc, const Setup& setup);
/// No other bridge of this computer has the rig.
[[nodiscard]] Check free_check(const std::string& holder);
/// No other bridge talks on the bus, and one controller at the most.
[[nodiscard]] Check only_bridge_check(const BusHeard& heard);
[[nodiscard]] Check only_controller_check(const BusHeard& heard);
/// Sensors and controller are heard, the controller has no fault, and there is no other of it or of the bridge.
[[nodiscard]] Checks bus_checks(const BusHeard& heard, const Setup& setup);
/// Whole, free, writable; and of this configuration where it has this scenario's campaign. `ledger`: empty: none is asked for.
[[nodiscard]] Checks ledger_checks(const LedgerFacts& facts, const std::filesystem::path& ledger, const Setup& setup);

/// A configuration that cannot be read is a check that failed.
[[nodiscard]] antiskid::preflight::Report preflight_report(const PreflightCommand& command, const PreflightDoors& doors);

}  // namespace rig
