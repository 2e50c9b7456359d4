#include "rig_bridge/replay/controller_replay.hpp"

#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>

#include "firmware/can/roles.hpp"
#include "firmware/control/controller.hpp"
#include "firmware/host/control_loop.hpp"

namespace rig::replay {

using antiskid::can::Role;

namespace {

/// What the loop sends goes to the comparison; what it receives comes through the pacer.
class ComparedBus final : public antiskid::can::Bus {
  public:
    explicit ComparedBus(FrameComparison& comparison) : comparison_(comparison) {}
    std::size_t receive(std::span<Frame>) override { return 0; }
    bool send(const Frame& frame) override {
        comparison_.replayed(frame);
        return true;
    }
    bool wait(Time) override { return false; }
    [[nodiscard]] antiskid::can::LinkStatus status() const override { return {}; }

  private:
    FrameComparison& comparison_;
};

/// Nothing in the loop depends on it but the pauses between closing commands.
class NoClock final : public antiskid::host::Clock {
  public:
    [[nodiscard]] Time now() override { return {}; }
    void sleep_until(Time) override {}
};

/// Large: on the heap.
struct Machine {
    Machine(const antiskid::controller::ControllerSetup& setup, const PacerSettings& settings, LogReader& log)
        : comparison(setup.layout),
          bus(comparison),
          port(setup.layout, setup.period),
          controller(setup.control),
          pacer(settings, setup.layout, log, port, comparison) {}

    FrameComparison comparison;
    ComparedBus bus;
    NoClock clock;
    antiskid::can::ControllerPort port;
    antiskid::control::Controller controller;
    RecordedPacer pacer;
    antiskid::host::CycleRing ring;  // nobody reads it: full, it takes no more
};

}  // namespace

bool ControllerReplayReport::same() const {
    const FrameComparison::Count& commands = count(Role::valve);
    bool none = commands.compared > 0 && commands.only_recorded == 0;
    for (const Role role : antiskid::can::kToRig) none = none && count(role).different == 0;
    return none;
}

ControllerReplayReport replay_controller(const std::filesystem::path& file, const LogOptions& options,
                                         const antiskid::controller::ControllerSetup& setup, ReplayClock clock, LogWarnings& warnings) {
    const auto began = std::chrono::steady_clock::now();
    LogOptions with_layout = options;
    with_layout.layout = &setup.layout;
    LogReader log(file, with_layout, warnings);
    const float safe_mA = setup.control.valve.safe_current_mA;
    const auto m = std::make_unique<Machine>(setup, PacerSettings{.clock = clock, .period = setup.period, .safe_current_mA = safe_mA}, log);
    const auto loop = std::make_unique<antiskid::host::ControlLoop>(
        antiskid::host::LoopSettings{.period = setup.period, .safe_current_mA = safe_mA, .valve_last = true},
        antiskid::host::LoopContext{
            .clock = m->clock, .pacer = m->pacer, .bus = m->bus, .port = m->port, .controller = m->controller, .ring = m->ring});
    const std::atomic<bool> stop{false};
    loop->run(stop);
    m->comparison.finish();

    ControllerReplayReport report;
    report.log = file.string();
    report.lockstep = m->pacer.lockstep();
    report.steps = loop->statistics().steps;
    report.unsynchronised = m->pacer.unsynchronised();
    report.steps_before_log = m->pacer.steps_before_log();
    report.unanswered = m->pacer.unanswered();
    for (const Role role : antiskid::can::kToRig) report.counts[static_cast<std::size_t>(role)] = m->comparison.count(role);
    report.first = m->comparison.first();
    report.largest = m->comparison.largest();
    report.recorded_s = std::chrono::duration<double>(m->pacer.duration()).count();
    report.took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    report.lines = log.lines();
    report.warnings = warnings.summary();
    report.config_hash = setup.config_hash;
    if (report.steps == 0)
        throw std::runtime_error(file.string() +
                                 ": holds no valve command of this layout (see the warnings above; --dbc and --binding "
                                 "choose the layout)");
    return report;
}

}  // namespace rig::replay
