#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

#include "firmware/host/settings/error.hpp"
#include "rig_bridge/bridge/preflight.hpp"
#include "rig_bridge/bridge/rig_hold.hpp"
#include "rig_bridge/bridge/start_checks.hpp"
#include "rig_bridge/bridge/verbs.hpp"

namespace rig::bridge {

namespace {

using namespace std::chrono_literals;

/// Without calls of command() or alive() the client only reads.
modbus::Snapshot look_at_plc(const BridgeSetup& setup) {
    constexpr auto kLong = 1s;      // many polls, and several watchdog times
    constexpr auto kPatience = 3s;  // for the first connection
    const modbus::ModbusClient client(setup.map, modbus::parse_plc_address(setup.options.plc));
    const auto began = std::chrono::steady_clock::now();
    while (client.snapshot().link == modbus::LinkState::connecting && std::chrono::steady_clock::now() - began < kPatience)
        std::this_thread::sleep_for(20ms);
    std::this_thread::sleep_for(kLong);
    return client.snapshot();
}

LedgerFacts look_at_ledger(const std::filesystem::path& ledger) {
    LedgerFacts facts{.there = std::filesystem::exists(ledger), .rejection = {}, .campaigns = {}};
    if (!facts.there) return facts;
    try {
        facts.campaigns = record::read_campaigns(ledger);
        facts.rejection = record::held_by_another(ledger).value_or("");
    } catch (const std::runtime_error& error) {
        facts.rejection = error.what();
    }
    if (facts.rejection.empty() && access(ledger.c_str(), W_OK) != 0)
        facts.rejection = ledger.string() + ": " + std::generic_category().message(errno);
    return facts;
}

}  // namespace

int run_preflight(const PreflightCommand& command) {
    const PreflightContext context{
        .machine = [](const antiskid::controller::MachineNeeds& needs) { return antiskid::controller::machine_facts(needs); },
        .link = [](const std::string& interface) { return antiskid::controller::can_link(interface); },
        .ledger = look_at_ledger,
        .plc = look_at_plc,
        .bus = [](const BridgeSetup& setup) { return listen_to_bus(setup, 1s); },
        .holder = [](const BridgeSetup& setup) { return rig_held(hold_places(setup)).value_or(""); }};
    return deliver(preflight_report(command, context), command.json);
}

}  // namespace rig::bridge
