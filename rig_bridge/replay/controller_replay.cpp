#include "rig_bridge/replay/controller_replay.hpp"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <chrono>
#include <iterator>
#include <memory>
#include <stdexcept>

#include "firmware/can/candump.hpp"
#include "firmware/can/roles.hpp"
#include "firmware/control/controller.hpp"
#include "firmware/host/control_loop.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"

namespace rig::replay {

using antiskid::can::Role;

namespace {

/// Frames sent by the loop are compared; received frames come through the pacer.
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

/// The loop uses it only for the pauses between closing commands.
class NoClock final : public antiskid::host::Clock {
  public:
    [[nodiscard]] Time now() override { return {}; }
    void sleep_until(Time) override {}
};

/// Too large for the stack.
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
    antiskid::host::CycleRing ring;  // never read: when it is full, records are dropped
};

/// Text of a frame: "100#8D000000".
std::string text_of(const Frame& frame) {
    std::array<char, antiskid::can::kCandumpLineMax> line{};
    const std::size_t size = antiskid::can::format_candump(Time{0}, "x", frame, line);
    const std::string_view text(line.data(), size);
    return std::string(text.substr(text.rfind(' ') + 1));
}

std::string described(Role role, const Frame& frame, const antiskid::can::Layout& layout) {
    if (role != Role::valve) return text_of(frame);
    const antiskid::can::Signal& current = layout.valve_current_mA;
    return fmt::format("{} ({:.3f} mA)", text_of(frame), current.value(antiskid::can::Payload(frame.data).read(current)));
}

double seconds(const FrameDifference& difference) {
    return std::chrono::duration<double>(difference.time).count();
}

double factor(const ControllerReplayReport& r) {
    return r.took_s > 0.0 ? r.recorded_s / r.took_s : 0.0;
}

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
                                 ": holds no valve command of this layout (see the warnings above; --dbc and --binding choose the layout)");
    return report;
}

std::string to_text(const ControllerReplayReport& r, const antiskid::can::Layout& layout) {
    std::string text;
    const auto out = std::back_inserter(text);
    fmt::format_to(
        out, "{}: {} steps, {}\n", r.log, r.steps,
        r.lockstep ? "in lockstep (SYNC in the log): exactly the recorded ones" : "bounded by the recorded valve commands (no SYNC in the log)");
    if (!r.lockstep)
        text +=
            "  A frame that came between the controller's wake-up and its command is one step early here, and inputs are older by\n  that time: "
            "single commands may differ by a small amount.\n";
    if (r.steps_before_log.value_or(1) != 0) {
        std::uint64_t settling = 0;
        for (const FrameComparison::Count& c : r.counts) settling += c.settling;
        fmt::format_to(
            out,
            "  {}: the replayed one starts anew at the log's first sample;\n  {} frames beside commands were not compared while it tested itself\n",
            r.steps_before_log ? "the controller was running when the log began, as its counters say"
                               : "the controller's counters follow no session: frames are missing at the log's start",
            settling);
    }
    if (r.unsynchronised > 0) fmt::format_to(out, "  {} steps by the controller's own clock: SYNC failed to come\n", r.unsynchronised);
    if (r.unanswered > 0) fmt::format_to(out, "  {} samples without an answer\n", r.unanswered);
    auto table = settings::TextTable::screen("frames:<22|compared:>10|differ:>10|only in log:>15|only replayed:>15");
    for (const Role role : antiskid::can::kToRig) {
        if (!layout[role].bound) continue;
        const FrameComparison::Count& c = r.count(role);
        table.add(antiskid::can::name(role), c.compared, c.different, c.only_recorded, c.only_replayed);
    }
    text += table.text();
    const auto tell = [&](std::string_view which, const FrameDifference& d) {
        fmt::format_to(out, "{}: line {}, {:.6f} s, {}: expected {}, got {}\n", which, d.line, seconds(d), antiskid::can::name(d.role),
                       described(d.role, d.recorded, layout), described(d.role, d.replayed, layout));
    };
    if (r.first) tell("first difference", *r.first);
    if (r.largest) tell("largest difference of valve current", *r.largest);
    const FrameComparison::Count& commands = r.count(Role::valve);
    fmt::format_to(out, "{} of {} command frames differ\n", commands.different + commands.only_recorded, commands.compared + commands.only_recorded);
    fmt::format_to(out, "{:.3f} s recorded, replayed in {:.3f} s: {:.0f} times real time\n", r.recorded_s, r.took_s, factor(r));
    if (!r.warnings.empty()) fmt::format_to(out, "warnings of the log: {}\n", r.warnings);
    return text;
}

std::string to_json(const ControllerReplayReport& r, const antiskid::can::Layout& layout) {
    auto messages = settings::Json::object();
    for (const Role role : antiskid::can::kToRig) {
        const FrameComparison::Count& c = r.count(role);
        messages[std::string(antiskid::can::name(role))] = {{"compared", c.compared},
                                                            {"different", c.different},
                                                            {"settling", c.settling},
                                                            {"only_recorded", c.only_recorded},
                                                            {"only_replayed", c.only_replayed}};
    }
    settings::Json root{{"log", r.log},
                        {"version", ANTISKID_VERSION},
                        {"config_hash", r.config_hash},
                        {"clock", r.lockstep ? "sync" : "timer"},
                        {"steps", r.steps},
                        {"unsynchronised_steps", r.unsynchronised},
                        {"unanswered_samples", r.unanswered},
                        {"within_session", r.steps_before_log.value_or(1) != 0},
                        {"messages", messages},
                        {"first_difference", nullptr},
                        {"largest_difference", nullptr},
                        {"recorded_s", r.recorded_s},
                        {"took_s", r.took_s},
                        {"times_real_time", factor(r)},
                        {"lines", r.lines},
                        {"warnings", r.warnings}};
    if (r.first)
        root["first_difference"] = {{"line", r.first->line},
                                    {"time_s", seconds(*r.first)},
                                    {"message", antiskid::can::name(r.first->role)},
                                    {"expected", described(r.first->role, r.first->recorded, layout)},
                                    {"got", described(r.first->role, r.first->replayed, layout)}};
    if (r.largest)
        root["largest_difference"] = {
            {"line", r.largest->line}, {"time_s", seconds(*r.largest)}, {"current_mA", current_difference_mA(*r.largest, layout)}};
    return settings::json_page(root);
}

}  // namespace rig::replay
