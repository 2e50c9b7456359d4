#include "rig_bridge/bridge/start_checks.hpp"

#include <fmt/core.h>

#include <array>
#include <span>
#include <stdexcept>

#include "firmware/can/roles.hpp"
#include "firmware/can/socket_can.hpp"
#include "rig_bridge/bridge/senders.hpp"

namespace rig::bridge {

using antiskid::can::Role;

namespace {

/// Thirty status frames of each controller: enough to tell two from one.
constexpr antiskid::can::Time kListen{300'000'000};
constexpr double kManeuver_bytes = 10e6;  // of the longest

std::string failed(const Checks& checks) {
    std::string text = "not started";
    for (const Check& check : checks) {
        if (check.verdict != antiskid::controller::CheckResult::fail) continue;
        text += fmt::format("\n  {}: {}; required: {}. Next: {}", check.name, check.measured, check.required, check.remedy);
    }
    return text;
}

}  // namespace

Checks start_checks(const StartFacts& facts, const std::string& interface, const std::filesystem::path& record) {
    // Which bit rate is right only `preflight --bitrate` is told.
    Checks checks = can_link_checks(facts.link, interface, facts.link.bitrate);
    checks.push_back(
        record_check(facts.machine,
                     {.program = "rig-bridge", .priority = 0, .cpu = {}, .record = record.empty() ? "." : record, .record_bytes = kManeuver_bytes}));
    if (!facts.bus.rejection.empty()) return checks;
    checks.push_back(only_bridge_check(facts.bus));
    checks.push_back(only_controller_check(facts.bus));
    return checks;
}

NotFit::NotFit(const Checks& checks) : std::runtime_error(failed(checks)) {}

void check_start(const BridgeSetup& setup, const std::filesystem::path& record) {
    StartFacts facts{.link = antiskid::controller::can_link(setup.options.interface), .machine = {}, .bus = listen_to_bus(setup, kListen)};
    antiskid::controller::look_at_record(facts.machine, record.empty() ? "." : record);
    const Checks checks = start_checks(facts, setup.options.interface, record);
    for (const Check& check : checks)
        if (check.verdict == antiskid::controller::CheckResult::fail) throw NotFit(checks);
}

BusReception listen_to_bus(const antiskid::can::Layout& layout, antiskid::can::Bus& bus, antiskid::host::Clock& clock, antiskid::can::Time length) {
    BusReception reception;
    antiskid::can::Observer observer(layout);
    DuplicateSenders senders(layout);
    std::array<antiskid::can::Frame, antiskid::can::SocketCan::kBatch> frames;
    const antiskid::can::Time end = clock.now() + length;
    for (reception.until = clock.now(); reception.until < end; reception.until = clock.now()) {
        for (const antiskid::can::Frame& frame : std::span(frames).first(bus.receive_within(antiskid::can::Bus::kLongestWait, frames))) {
            (void)observer.accept(frame);
            senders.accept(frame);
        }
    }
    reception.view = observer.view();
    reception.two_controllers = senders.two_controllers();
    for (const Role role : antiskid::can::kEveryRole) reception.stats[static_cast<std::size_t>(role)] = observer.stats(role);
    return reception;
}

BusReception listen_to_bus(const BridgeSetup& setup, antiskid::can::Time length) {
    try {
        antiskid::can::SocketCan bus(setup.options.interface, antiskid::can::ids(setup.layout, antiskid::can::kEveryRole).span());
        antiskid::host::MonotonicClock clock;
        return listen_to_bus(setup.layout, bus, clock, length);
    } catch (const std::runtime_error& error) {
        BusReception reception;
        reception.rejection = error.what();
        return reception;
    }
}

}  // namespace rig::bridge
