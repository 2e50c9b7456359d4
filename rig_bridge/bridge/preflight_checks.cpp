#include <fmt/core.h>
#include <fmt/ranges.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "firmware/can/value_names.hpp"
#include "firmware/host/seconds.hpp"
#include "rig_bridge/bridge/preflight.hpp"

namespace rig::bridge {

namespace {

using antiskid::can::Role;
using antiskid::control::State;
using antiskid::controller::judged;
using antiskid::controller::skipped;
using antiskid::host::seconds;

Check link_check(const modbus::Snapshot& plc, const BridgeSetup& setup) {
    // A map that is refused was read over a link that works.
    const bool good = plc.link == modbus::LinkState::connected || plc.link == modbus::LinkState::map_rejected;
    Check check = judged("PLC link", good,
                         {.measured = good                ? fmt::format("{} readings", plc.counters.polls)
                                      : plc.error.empty() ? std::string("no answer")
                                                          : plc.error,
                          .required = setup.options.plc + " answers",
                          .remedy = "cable, address, PLC in RUN; is its Modbus server on, and this computer on its list of peers?"});
    check.figures = {{"requests", static_cast<double>(plc.counters.requests)}, {"timeouts", static_cast<double>(plc.counters.timeouts)}};
    return check;
}

Check heartbeat_check(const modbus::Snapshot& plc, const Freshness& limits) {
    const double age_s = plc.plc_watchdog_age_s;
    return judged("PLC heartbeat", age_s <= limits.watchdog_s,
                  {.measured = std::isfinite(age_s) ? fmt::format("moved {:.0f} ms ago", 1e3 * age_s) : std::string("stands still"),
                   .required = fmt::format("plc_watchdog moves within {:.0f} ms", 1e3 * limits.watchdog_s),
                   .remedy = "the PLC's program does not run, or counts another register"});
}

Check registers_check(const modbus::Snapshot& plc, const Freshness& limits) {
    std::vector<std::string> wrong;
    for (std::size_t i = 0; i < kMeasuredCount; ++i) {
        const auto q = static_cast<Measured>(i);
        if (plc.fresh(q, limits.registers_s)) continue;
        wrong.push_back(plc.quality[i] == ValueQuality::good ? fmt::format("{} old", name(q))
                                                             : fmt::format("{} {} ({:g})", name(q), name(plc.quality[i]), plc.values[i]));
    }
    return judged("PLC registers", wrong.empty(),
                  {.measured = wrong.empty() ? fmt::format("{} good", kMeasuredCount) : fmt::format("{}", fmt::join(wrong, ", ")),
                   .required = "each read, fresh, in its range",
                   .remedy = "sensor, or address, type, scale, range and word order of the register map"});
}

Check interlock_check(const modbus::Snapshot& plc, Interlock interlock) {
    const auto bits = static_cast<unsigned>(plc.value(Measured::interlocks));
    const bool good = ((bits >> static_cast<unsigned>(interlock)) & 1U) != 0;
    return judged(fmt::format("interlock {}", name(interlock)), good,
                  {.measured = good ? "good" : "open", .required = "good", .remedy = "find out who or what opened it (docs/user/rig_manual.md)"});
}

Check state_check(const modbus::Snapshot& plc, bool bridge_resets) {
    const bool ready = plc.value(Measured::plc_state) == static_cast<double>(PlcState::ready);
    // Without a bridge its watchdog has tripped: that is as it should be.
    return judged("PLC state", ready || bridge_resets,
                  {.measured = ready           ? "ready"
                               : bridge_resets ? "tripped: the bridge resets it at its start"
                                               : "tripped",
                   .required = bridge_resets ? "ready, or to be reset by the bridge" : "ready",
                   .remedy = "reset it by hand, or leave --no-reset out"});
}

Check rest_check(const modbus::Snapshot& plc) {
    constexpr double kStands_mps = 0.1;
    const double speed = plc.value(Measured::flywheel_speed_mps);
    const bool touches = plc.value(Measured::wheel_on_rim) != 0.0;
    return judged("rig at rest", std::abs(speed) < kStands_mps && !touches,
                  {.measured = fmt::format("rim {:.2f} m/s, wheel {}", speed, touches ? "on the rim" : "off it"),
                   .required = fmt::format("below {} m/s, wheel off the rim", kStands_mps),
                   .remedy = "wait until the flywheel stands; retract the sledge by the PLC"});
}

std::string rejected_text(const antiskid::can::MessageStats& stats) {
    std::string text = fmt::format("{} refused", stats.rejected());
    auto add = [&text, before = ": "](std::uint32_t count, std::string_view reason) mutable {
        if (count != 0) text += std::exchange(before, ", ") + std::string(reason);
    };
    add(stats.wrong_counter, "counter");
    add(stats.wrong_crc, "CRC");
    add(stats.wrong_length, "length");
    add(stats.wrong_value, "value");
    return text;
}

Check frames_check(const BusReception& reception, const BridgeSetup& setup, Role role, antiskid::can::Time received, double limit_s,
                   std::string remedy) {
    const antiskid::can::MessageStats& stats = reception.of(role);
    const bool fresh = received != antiskid::control::kNever && seconds(reception.until - received) <= limit_s;
    const std::string age =
        stats.accepted == 0 ? std::string("no good one") : fmt::format("newest {:.0f} ms old", 1e3 * seconds(reception.until - received));
    return judged(fmt::format("{} frames", antiskid::can::name(role)), fresh && stats.rejected() == 0,
                  {.measured = fmt::format("{} good, {}; {}", stats.accepted, rejected_text(stats), age),
                   .required = fmt::format("0x{:03X} within {:.0f} ms, none refused", setup.layout[role].id, 1e3 * limit_s),
                   .remedy = std::move(remedy)});
}

Check controller_check(const antiskid::can::ControllerView& controller, const std::string& interface) {
    if (controller.status_received == antiskid::control::kNever) return skipped("controller state", "not heard", "standby, no fault");
    std::vector<std::string_view> faults;
    for (std::size_t i = 0; i < antiskid::control::kFaultCount; ++i)
        if (controller.faults.contains(static_cast<antiskid::control::Fault>(i))) faults.push_back(antiskid::can::kFaultNames.at(i));
    // Until a bridge speaks its self-test cannot end.
    const bool waits = controller.state == State::standby || controller.state == State::self_test;
    return judged("controller state", waits && faults.empty(),
                  {.measured = fmt::format("{}{}{}", antiskid::can::kStateNames.at(static_cast<std::size_t>(controller.state)),
                                           faults.empty() ? "" : ": ", fmt::join(faults, ", ")),
                   .required = "standby, or self_test until the bridge speaks; no fault",
                   .remedy = fmt::format("docs/user/faults.md; antiskid-controller --can {} --check", interface)});
}

}  // namespace

Checks plc_checks(const modbus::Snapshot& plc, const BridgeSetup& setup) {
    Checks checks{link_check(plc, setup)};
    const std::string version = fmt::format("version {}", setup.map.version);
    if (plc.link != modbus::LinkState::connected && plc.link != modbus::LinkState::map_rejected) {
        checks.push_back(skipped("PLC register map", "no link", version));
        return checks;
    }
    const bool same = plc.link == modbus::LinkState::connected;
    checks.push_back(
        judged("PLC register map", same,
               {.measured = same ? version : plc.error, .required = version, .remedy = "give the map of the PLC's program: --registers FILE"}));
    if (!same) return checks;  // nothing else of it is believed
    checks.push_back(heartbeat_check(plc, setup.limits));
    checks.push_back(registers_check(plc, setup.limits));
    if (!plc.fresh(Measured::interlocks, setup.limits.registers_s)) return checks;
    for (std::size_t i = 0; i < kInterlockCount; ++i) checks.push_back(interlock_check(plc, static_cast<Interlock>(i)));
    checks.push_back(state_check(plc, setup.options.reset));
    checks.push_back(rest_check(plc));
    return checks;
}

Check free_check(const std::string& holder) {
    return judged("rig free", holder.empty(),
                  {.measured = holder.empty() ? std::string("nobody has it") : holder,
                   .required = "no other bridge of this computer on its interface or PLC",
                   .remedy = "wait until that bridge has ended, or ask it to end"});
}

Check only_bridge_check(const BusReception& reception) {
    const std::uint32_t others = reception.of(Role::maneuver).accepted + reception.of(Role::maneuver).rejected();
    return judged("only bridge", others == 0,
                  {.measured = others == 0 ? std::string("no other") : fmt::format("another one sent {} commands", others),
                   .required = "no other",
                   .remedy = "end the other bridge first: it has the rig"});
}

Check only_controller_check(const BusReception& reception) {
    const bool one = reception.two_controllers.empty();
    return judged("only controller", one,
                  {.measured = one ? std::string("no other") : reception.two_controllers,
                   .required = "one",
                   .remedy = "end one of them: pgrep -a antiskid-contro on this computer, or the other node"});
}

Checks bus_checks(const BusReception& reception, const BridgeSetup& setup) {
    const std::string& interface = setup.options.interface;
    Checks checks{judged("CAN socket", reception.rejection.empty(),
                         {.measured = reception.rejection.empty() ? "open" : reception.rejection, .required = "open", .remedy = "as it says"})};
    if (!reception.rejection.empty()) return checks;
    const std::string cable = fmt::format("candump {}; then cable, node, DBC and binding", interface);
    const double sensors_s = setup.limits.sensors_s;
    const auto& view = reception.view;
    checks.push_back(frames_check(reception, setup, Role::wheel, view.wheel.received, sensors_s, cable));
    checks.push_back(frames_check(reception, setup, Role::flywheel, view.flywheel.received, sensors_s, cable));
    checks.push_back(frames_check(reception, setup, Role::pressure, view.pressure.received, sensors_s, cable));
    const auto& controller = view.controller;
    const std::string start = fmt::format("systemctl start antiskid-controller@{0}, or antiskid-controller --can {0} --cpu 1", interface);
    checks.push_back(frames_check(reception, setup, Role::status, controller.status_received, setup.limits.controller_s, start));
    checks.push_back(controller_check(controller, interface));
    checks.push_back(only_controller_check(reception));
    checks.push_back(only_bridge_check(reception));
    return checks;
}

Checks ledger_checks(const LedgerFacts& facts, const std::filesystem::path& ledger, const BridgeSetup& setup) {
    const std::string required = "whole, free, yours to write";
    if (ledger.empty()) return {skipped("ledger", "no --out", required)};
    Checks checks{judged("ledger", facts.rejection.empty(),
                         {.measured = !facts.rejection.empty() ? facts.rejection
                                      : facts.there            ? fmt::format("whole, {} campaigns", facts.campaigns.size())
                                                               : std::string("none yet"),
                          .required = required,
                          .remedy = fmt::format("sqlite3 {} .recover, or end the program that holds it", ledger.string())})};
    for (const record::Campaign& campaign : facts.campaigns) {
        if (campaign.name != setup.scenario.name) continue;
        // --regulate adds files of its own to the hash, so that another one need not be wrong.
        checks.push_back(judged("campaign's configuration", campaign.config_hash == setup.config_hash,
                                {.measured = setup.config_hash,
                                 .required = campaign.config_hash,
                                 .remedy = "the files as they were when it began, or campaign --go-on-changed"},
                                antiskid::controller::CheckResult::warn));
    }
    return checks;
}

}  // namespace rig::bridge
