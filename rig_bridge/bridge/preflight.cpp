#include "rig_bridge/bridge/preflight.hpp"

#include <optional>
#include <stdexcept>

#include "firmware/host/settings/error.hpp"

namespace rig {

namespace {

namespace preflight = antiskid::preflight;

preflight::MachineNeeds needs_of(const PreflightCommand& command) {
    constexpr double kManeuver_bytes = 10e6;  // bus.log of the longest
    return {.program = "rig-bridge",
            .priority = command.rig.priority,
            .cpu = {},
            .record = command.rig.out.empty() ? "." : command.rig.out,
            .record_bytes = kManeuver_bytes * command.maneuvers};
}

}  // namespace

preflight::Report preflight_report(const PreflightCommand& command, const PreflightDoors& doors) {
    std::optional<Setup> setup;
    std::string refusal;
    try {
        setup = load_setup(command.rig);
    } catch (const settings::Error& error) {
        refusal = error.what();
    } catch (const std::invalid_argument& error) {
        refusal = error.what();
    }
    const preflight::MachineNeeds needs = needs_of(command);
    const preflight::MachineFacts facts = doors.machine(needs);
    preflight::Report report{
        .program = needs.program,
        .interface = command.rig.interface,
        .config_hash = setup ? setup->config_hash : std::string(),
        .checks = {preflight::judged(
            "configuration", setup.has_value(),
            {.measured = setup ? setup->config_hash : refusal, .required = "read, every value in its range", .remedy = "mend that line"})}};
    report.checks.push_back(scheduler_check(facts, needs));
    append(report.checks, clock_checks(facts));
    report.checks.push_back(record_check(facts, needs));
    append(report.checks, can_link_checks(doors.link(command.rig.interface), command.rig.interface, command.bitrate));
    if (!setup) {
        report.checks.push_back(preflight::skipped("PLC, bus, ledger", "no configuration", "all of them good"));
        return report;
    }
    report.checks.push_back(free_check(doors.holder(*setup)));
    append(report.checks, plc_checks(doors.plc(*setup), *setup));
    append(report.checks, bus_checks(doors.bus(*setup), *setup));
    const auto ledger = command.rig.out.empty() ? std::filesystem::path() : ledger_file(command.rig.out);
    append(report.checks, ledger_checks(ledger.empty() ? LedgerFacts{} : doors.ledger(ledger), ledger, *setup));
    return report;
}

}  // namespace rig
