#include "rig_bridge/bridge/preflight.hpp"

#include <optional>
#include <stdexcept>

#include "firmware/host/settings/error.hpp"

namespace rig::bridge {

namespace {

namespace controller = antiskid::controller;

controller::MachineNeeds needs_of(const PreflightCommand& command) {
    constexpr double kManeuver_bytes = 10e6;  // bus.log of the longest
    return {.program = "rig-bridge",
            .priority = command.rig.priority,
            .cpu = {},
            .record = command.rig.out.empty() ? "." : command.rig.out,
            .record_bytes = kManeuver_bytes * command.maneuvers};
}

}  // namespace

controller::Report preflight_report(const PreflightCommand& command, const PreflightContext& context) {
    std::optional<BridgeSetup> setup;
    std::string rejection;
    try {
        setup = load_setup(command.rig);
    } catch (const settings::Error& error) {
        rejection = error.what();
    } catch (const std::invalid_argument& error) {
        rejection = error.what();
    }
    const controller::MachineNeeds needs = needs_of(command);
    const controller::MachineFacts facts = context.machine(needs);
    controller::Report report{
        .program = needs.program,
        .interface = command.rig.interface,
        .config_hash = setup ? setup->config_hash : std::string(),
        .checks = {controller::judged(
            "configuration", setup.has_value(),
            {.measured = setup ? setup->config_hash : rejection, .required = "read, every value in its range", .remedy = "mend that line"})}};
    report.checks.push_back(scheduler_check(facts, needs));
    append(report.checks, clock_checks(facts));
    report.checks.push_back(record_check(facts, needs));
    append(report.checks, can_link_checks(context.link(command.rig.interface), command.rig.interface, command.bitrate));
    if (!setup) {
        report.checks.push_back(controller::skipped("PLC, bus, ledger", "no configuration", "all of them good"));
        return report;
    }
    report.checks.push_back(free_check(context.holder(*setup)));
    append(report.checks, plc_checks(context.plc(*setup), *setup));
    append(report.checks, bus_checks(context.bus(*setup), *setup));
    const auto ledger = command.rig.out.empty() ? std::filesystem::path() : ledger_file(command.rig.out);
    append(report.checks, ledger_checks(ledger.empty() ? LedgerFacts{} : context.ledger(ledger), ledger, *setup));
    return report;
}

}  // namespace rig::bridge
