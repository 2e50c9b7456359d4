#include "firmware/controller/controller_check.hpp"

#include <chrono>
#include <optional>
#include <stdexcept>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/roles.hpp"
#include "firmware/controller/controller_setup.hpp"
#include "firmware/controller/listener.hpp"
#include "firmware/controller/valve_step.hpp"
#include "firmware/host/control_loop.hpp"
#include "firmware/host/frame_intake.hpp"
#include "firmware/host/pacer.hpp"
#include "firmware/host/settings/error.hpp"

namespace antiskid::controller {

namespace {

/// Where the loop is timed when there is no bus.
class NoBus final : public can::Bus {
  public:
    std::size_t receive(std::span<can::Frame> /*frames*/) override { return 0; }
    bool send(const can::Frame& /*frame*/) override { return false; }
    bool wait(can::Time /*timeout*/) override { return false; }
    [[nodiscard]] can::LinkStatus status() const override { return {.up = false}; }
};

MachineNeeds needs_of(const controller::Options& options) {
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

Check config_check(const controller::Options& options, const std::optional<controller::ControllerSetup>& setup, const std::string& rejection) {
    const std::string& wanted = options.check->expect_hash;
    if (!setup)
        return judged("configuration", false, {.measured = rejection, .required = "read, every value in its range", .remedy = "mend that line"});
    return judged("configuration", wanted.empty() || wanted == setup->config_hash,
                  {.measured = setup->config_hash,
                   .required = wanted.empty() ? "read, every value in its range" : wanted,
                   .remedy = "git diff, or the copy that was meant: --config, --dbc, --binding"});
}

std::unique_ptr<can::Bus> open_bus(const controller::ControllerSetup& setup, const CheckContext& context, std::string& rejection) {
    can::IdList wanted = can::ids(setup.layout, can::kToController);
    for (const can::Role role : can::kToRig)
        if (setup.layout[role].bound) wanted.add(setup.layout[role].id);
    try {
        return context.open(wanted.span());
    } catch (const std::runtime_error& error) {
        rejection = error.what();
        return nullptr;
    }
}

Check valve_step(const controller::ControllerSetup& setup, can::Bus& bus, host::Clock& clock, const std::atomic<bool>& stop) {
    ValveStep step(setup.control);
    can::ControllerPort port(setup.layout, setup.period);
    host::FrameIntake intake(bus, port);
    host::TimerPacer pacer(clock, setup.period, intake);
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
    for (std::uint32_t i = 0; i < host::ControlLoop::kSafeAttempts && sent < host::ControlLoop::kSafeCommands; ++i) {
        if (bus.send(port.valve_command(setup.control.valve.safe_current_mA))) ++sent;
        clock.sleep_until(clock.now() + setup.period);
    }
    return step.result();
}

Checks loop_checks(const controller::Options& options, const controller::ControllerSetup& setup, const CheckContext& context,
                   const std::atomic<bool>& stop) {
    const controller::CheckRequest& request = *options.check;
    std::string rejection;
    const std::unique_ptr<can::Bus> bus = open_bus(setup, context, rejection);
    NoBus none;
    can::Bus& heard_on = bus ? *bus : none;
    const control::Time duration = std::chrono::seconds{request.timing_s};
    Reception reception;
    context.on_loop_thread(duration, [&] { reception = listen(setup, heard_on, context.clock, duration, stop); });
    Checks checks{judged("CAN socket", bus != nullptr, {.measured = bus ? "open" : rejection, .required = "open", .remedy = "as it says"})};
    append(checks, bus ? frame_checks(reception, setup, options.interface) : frame_checks_skipped(setup, "nothing is heard"));
    append(checks, timing_checks(reception, setup.period));

    const std::string required = "pressure follows a small step";
    if (!request.valve_step) {
        checks.push_back(skipped("valve step", "not asked for: --valve-step", required));
        return checks;
    }
    const std::string why = bus ? why_not_to_move_the_valve(reception, setup.control) : "no bus";
    if (!why.empty()) {
        checks.push_back(
            judged("valve step", false, {.measured = "refused, valve untouched: " + why, .required = required, .remedy = "mend that first"}));
        return checks;
    }
    Check step;
    context.on_loop_thread(ValveStep::kHold + ValveStep::kRelease, [&] { step = valve_step(setup, *bus, context.clock, stop); });
    checks.push_back(std::move(step));
    return checks;
}

}  // namespace

Report controller_report(const controller::Options& options, const CheckContext& context, const std::atomic<bool>& stop) {
    std::optional<controller::ControllerSetup> setup;
    std::string rejection;
    try {
        setup = controller::load_setup(options);
    } catch (const settings::Error& error) {
        rejection = error.what();
    }
    const MachineNeeds needs = needs_of(options);
    const MachineFacts facts = context.machine(needs);
    Report report{.program = needs.program,
                  .interface = options.interface,
                  .config_hash = setup ? setup->config_hash : std::string(),
                  .checks = {config_check(options, setup, rejection)}};
    append(report.checks, real_time_checks(facts, needs));
    append(report.checks, clock_checks(facts));
    report.checks.push_back(record_check(facts, needs));
    append(report.checks, can_link_checks(context.link(options.interface), options.interface, options.check->bitrate));
    if (setup)
        append(report.checks, loop_checks(options, *setup, context, stop));
    else
        report.checks.push_back(skipped("frames, timing, valve", "no configuration", "all of them good"));
    return report;
}

}  // namespace antiskid::controller
