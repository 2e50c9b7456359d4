#include "firmware/preflight/controller_check.hpp"

#include <chrono>
#include <optional>
#include <stdexcept>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/roles.hpp"
#include "firmware/host/control_loop.hpp"
#include "firmware/host/frame_intake.hpp"
#include "firmware/host/pacer.hpp"
#include "firmware/host/settings/error.hpp"
#include "firmware/host/setup.hpp"
#include "firmware/preflight/listener_checks.hpp"
#include "firmware/preflight/valve_step.hpp"

namespace antiskid::preflight {

namespace {

/// Where the loop is timed when there is no bus.
class NoBus final : public can::Bus {
  public:
    std::size_t receive(std::span<can::Frame> /*frames*/) override { return 0; }
    bool send(const can::Frame& /*frame*/) override { return false; }
    bool wait(can::Time /*timeout*/) override { return false; }
    [[nodiscard]] can::LinkStatus status() const override { return {.up = false}; }
};

MachineNeeds needs_of(const rt::Options& options) {
    constexpr double kReport_bytes = 10e6;  // JSON at exit, and the system's own log
    MachineNeeds needs{.program = "antiskid-controller",
                       .priority = options.realtime.priority,
                       .cpu = options.realtime.cpu,
                       .record = ".",
                       .record_bytes = kReport_bytes};
    const std::filesystem::path report = options.json;
    if (report.has_parent_path()) needs.record = report.parent_path();
    return needs;
}

Check config_check(const rt::Options& options, const std::optional<rt::Setup>& setup, const std::string& refusal) {
    const std::string& wanted = options.check->expect_hash;
    if (!setup)
        return judged("configuration", false, {.measured = refusal, .required = "read, every value in its range", .remedy = "mend that line"});
    return judged("configuration", wanted.empty() || wanted == setup->config_hash,
                  {.measured = setup->config_hash,
                   .required = wanted.empty() ? "read, every value in its range" : wanted,
                   .remedy = "git diff, or the copy that was meant: --config, --dbc, --binding"});
}

std::unique_ptr<can::Bus> open_bus(const rt::Setup& setup, const Doors& doors, std::string& refusal) {
    can::IdList wanted = can::ids(setup.layout, can::kToController);
    for (const can::Role role : can::kToRig)
        if (setup.layout[role].bound) wanted.add(setup.layout[role].id);
    try {
        return doors.open(wanted.span());
    } catch (const std::runtime_error& error) {
        refusal = error.what();
        return nullptr;
    }
}

Check valve_step(const rt::Setup& setup, can::Bus& bus, rt::Clock& clock, const std::atomic<bool>& stop) {
    ValveStep step(setup.control);
    can::ControllerPort port(setup.layout, setup.period);
    rt::FrameIntake intake(bus, port);
    rt::TimerPacer pacer(clock, setup.period, intake);
    constexpr int kFirstFrames = 20;  // until each sensor has been heard
    int periods = 0;
    while (!step.over()) {
        const auto wake = pacer.next(stop);
        if (!wake) {
            step.abort("ended by a signal");
            break;
        }
        port.note_link(bus.status());
        if (++periods > kFirstFrames && !bus.send(port.valve_command(step.step(port.sensors(), wake->now))))
            step.abort("the bus does not take the command");
        port.clear_one_shots();
    }
    std::uint32_t sent = 0;
    for (std::uint32_t i = 0; i < rt::ControlLoop::kSafeAttempts && sent < rt::ControlLoop::kSafeCommands; ++i) {
        if (bus.send(port.valve_command(setup.control.valve.safe_current_mA))) ++sent;
        clock.sleep_until(clock.now() + setup.period);
    }
    return step.result();
}

Checks loop_checks(const rt::Options& options, const rt::Setup& setup, const Doors& doors, const std::atomic<bool>& stop) {
    const rt::CheckRequest& request = *options.check;
    std::string refusal;
    const std::unique_ptr<can::Bus> bus = open_bus(setup, doors, refusal);
    NoBus none;
    can::Bus& heard_on = bus ? *bus : none;
    const control::Time duration = std::chrono::seconds{request.timing_s};
    Heard heard;
    doors.on_loop_thread(duration, [&] { heard = listen(setup, heard_on, doors.clock, duration, stop); });
    Checks checks{judged("CAN socket", bus != nullptr, {.measured = bus ? "open" : refusal, .required = "open", .remedy = "as it says"})};
    append(checks, bus ? frame_checks(heard, setup, options.interface) : frame_checks_skipped(setup, "nothing is heard"));
    append(checks, timing_checks(heard, setup.period));

    const std::string required = "pressure follows a small step";
    if (!request.valve_step) {
        checks.push_back(skipped("valve step", "not asked for: --valve-step", required));
        return checks;
    }
    const std::string why = bus ? why_not_to_move_the_valve(heard, setup.control) : "no bus";
    if (!why.empty()) {
        checks.push_back(
            judged("valve step", false, {.measured = "refused, valve untouched: " + why, .required = required, .remedy = "mend that first"}));
        return checks;
    }
    Check step;
    doors.on_loop_thread(ValveStep::kHold + ValveStep::kRelease, [&] { step = valve_step(setup, *bus, doors.clock, stop); });
    checks.push_back(std::move(step));
    return checks;
}

}  // namespace

Report controller_report(const rt::Options& options, const Doors& doors, const std::atomic<bool>& stop) {
    std::optional<rt::Setup> setup;
    std::string refusal;
    try {
        setup = rt::load_setup(options);
    } catch (const settings::Error& error) {
        refusal = error.what();
    }
    const MachineNeeds needs = needs_of(options);
    const MachineFacts facts = doors.machine(needs);
    Report report{.program = needs.program,
                  .interface = options.interface,
                  .config_hash = setup ? setup->config_hash : std::string(),
                  .checks = {config_check(options, setup, refusal)}};
    append(report.checks, real_time_checks(facts, needs));
    append(report.checks, clock_checks(facts));
    report.checks.push_back(record_check(facts, needs));
    append(report.checks, can_link_checks(doors.link(options.interface), options.interface, options.check->bitrate));
    if (setup)
        append(report.checks, loop_checks(options, *setup, doors, stop));
    else
        report.checks.push_back(skipped("frames, timing, valve", "no configuration", "all of them good"));
    return report;
}

}  // namespace antiskid::preflight
