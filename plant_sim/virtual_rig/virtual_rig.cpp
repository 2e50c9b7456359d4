/// virtual-rig: the simulated rig on CAN; runs one maneuver, or with `serve` as many as a rig bridge requests. See --help.

#include <fmt/core.h>

#include <unistd.h>
#include <cmath>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/can/roles.hpp"
#include "firmware/can/socket_can.hpp"
#include "firmware/can/value_names.hpp"
#include "firmware/host/realtime.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/command_line.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/rig_session.hpp"
#include "plant_sim/study/trajectory.hpp"
#include "plant_sim/virtual_rig/rig_node.hpp"
#include "plant_sim/virtual_rig/serve_command.hpp"
#include "rig_bridge/pictures/stop_picture.hpp"

namespace {

using antiskid::control::Time;

/// Shows a maneuver in one live line on standard error; without a terminal as plain lines, one per simulated second.
class Progress {
  public:
    Progress() : terminal_(::isatty(STDERR_FILENO) == 1) {}
    void show(const study::RigSession& session, const antiskid::can::ControllerView& controller) {
        constexpr double kLive_s = 0.05;
        constexpr double kPlain_s = 1.0;
        const plant::Rig& rig = session.rig();
        const study::StopPhase phase = session.pilot().phase();
        if (rig.time_s() < next_s_ && phase == phase_) return;
        phase_ = phase;
        next_s_ = rig.time_s() + (terminal_ ? kLive_s : kPlain_s);
        constexpr std::size_t kBar = 24;
        const double share = 1.0 - rig.wheel().v_mps / rig.parameters().brake_on_mps;
        fmt::print(stderr, "{}[{}] {:6.2f} s {:<10} {:5.1f} m/s  slip {:5.2f}  {:5.1f} MPa  {:7.1f} m  {}{}", terminal_ ? "\r" : "",
                   settings::bar(share, kBar), rig.time_s(), study::name(phase), rig.wheel().v_mps, rig.forces().slip, rig.pressure_Pa() * 1e-6,
                   session.distance_m(), antiskid::can::kStateNames[static_cast<std::size_t>(controller.state)], terminal_ ? "\x1b[K" : "\n");
        std::fflush(stderr);
        shown_ = true;
    }
    /// Ends the live line.
    void finish() {
        if (terminal_ && shown_) fmt::print(stderr, "\n");
    }

  private:
    bool terminal_;
    double next_s_ = 0.0;
    study::StopPhase phase_ = study::StopPhase::done;
    bool shown_ = false;
};

struct Options {
    plant_sim::StopOptions scenario;
    std::string interface;
    std::string clock = "sync";
    std::filesystem::path out;
    int answer_timeout_ms = 1000;
    int patience_ms = 10000;
    int priority = 70;
    std::string json;               ///< file, "-" for standard output, or empty
    std::filesystem::path picture;  ///< empty: none
};

/// The options, or the exit status when there is nothing to run.
std::optional<int> parse(int argc, char** argv, Options& o) {
    CLI::App app{
        "The virtual rig: plant, sensors and pilot behind the rig's CAN frames. Runs one maneuver against antiskid-controller. `virtual-rig serve` "
        "is the rig without the pilot, for rig-bridge: see virtual-rig serve --help.",
        "virtual-rig"};
    app.set_version_flag("--version", ANTISKID_VERSION);
    app.add_option("--can", o.interface, "CAN interface, e.g. vcan0")->required()->type_name("IF");
    settings::one_of(app.add_option("--clock", o.clock, "sync: lockstep, as fast as both can; timer: real time"), {"sync", "timer"})
        ->capture_default_str();
    settings::add_out(app, o.out, "for trajectory.csv and result.json");
    settings::add_json(app, o.json, "result");
    settings::add_picture(app, o.picture, "speeds, slip and pressures");
    app.add_option("--answer-timeout", o.answer_timeout_ms, "lockstep: longest wait for a valve command")
        ->check(CLI::Range(1, 3'600'000))
        ->type_name("MS")
        ->capture_default_str();
    app.add_option("--patience", o.patience_ms, "longest wait for the controller to appear")
        ->check(CLI::Range(1, 3'600'000))
        ->type_name("MS")
        ->capture_default_str();
    app.add_option("--priority", o.priority, "SCHED_FIFO priority with --clock timer; 0: ordinary scheduling")
        ->check(CLI::Range(0, 99))
        ->capture_default_str();
    o.scenario.add_to(app);
    o.scenario.brake.add_to(app);
    app.footer(
        "Examples:\n"
        "  virtual-rig --can vcan0 --maneuver heavy --surface dry_asphalt --slip 0.24 --out out/stop\n"
        "  virtual-rig --can vcan0 --clock timer --surface snow --law threshold\n"
        "  virtual-rig --can vcan0 --runway config/runways/flooded.toml --picture flooded.png\n"
        "  virtual-rig --can vcan0 --brake-state brake.json\n"
        "Exit status: 0 the maneuver ran to standstill; 1 it did not (controller silent, interface gone, no standstill);\n"
        "2 mistake on the command line or in a configuration file; 130 stopped by Ctrl-C.");
    app.add_subcommand("serve", "the rig without the pilot, for rig-bridge; first on the command line");
    return settings::parse(app, argc, argv);
}

int run(const Options& o, const plant_sim::StopInputs& s) {
    if (s.brake) {
        const std::string notice = plant_sim::extrapolation_notice(*s.brake);
        if (!notice.empty()) fmt::print(stderr, "virtual-rig: {}\n", notice);
    }
    antiskid::host::StopSignals signals;
    const antiskid::can::IdList wanted = antiskid::can::ids(s.layout, antiskid::can::kToRig);
    antiskid::can::SocketCan bus(o.interface, wanted.span());
    antiskid::host::MonotonicClock clock;
    study::RigSession session(s.plant.rig, s.session);
    const Time period(std::llround(s.session.period_s * 1e9));
    plant_sim::RigNode node(session, s.layout, bus, clock, period);

    const bool along_runway = !s.plant.rig.runway.patches.empty();
    study::Trajectory trajectory(along_runway);
    Progress progress;
    const auto observe = [&](const study::RigSession& now, const antiskid::can::ControllerView& view, double current_mA) {
        if (!o.out.empty() || !o.picture.empty()) trajectory.record(now, view, current_mA);
        progress.show(now, view);
    };
    const Time millisecond{1'000'000};
    plant_sim::NodeResult result;
    if (o.clock == "sync") {
        result = node.run_lockstep(o.answer_timeout_ms * millisecond, o.patience_ms * millisecond, signals.stop(), observe);
    } else {
        if (const auto rejected = antiskid::host::lock_memory()) fmt::print(stderr, "virtual-rig: {}\n", *rejected);
        for (const std::string& rejected : antiskid::host::enter_realtime({.priority = o.priority, .cpu = {}})) {
            fmt::print(stderr, "virtual-rig: {}\n", rejected);
        }
        result = node.run_realtime(o.patience_ms * millisecond, signals.stop(), observe);
    }
    progress.finish();

    study::StopReport report = s.report(o.scenario);
    report.figures = session.figures();
    report.faults = result.faults;
    report.frames_sent = result.frames_sent;
    report.frames_received = result.frames_received;
    report.frames_lost = result.frames_lost;
    report.overruns = result.overruns;
    if (o.json != "-") fmt::print("{}", study::to_table(report));
    settings::deliver(o.json, study::to_json(report));
    if (!o.out.empty()) {
        settings::write_file(o.out / "trajectory.csv", trajectory.csv());
        settings::write_file(o.out / "result.json", study::to_json(report));
    }
    if (!o.picture.empty()) pictures::draw_stop(trajectory.rows(), o.picture, s.title(o.scenario), session.pilot().brake_on_s());
    // A maneuver without brake-on wears nothing and does not count.
    const double taken_J = session.rig().wheel().energy_brake_J;
    if (taken_J > 0.0) s.save_brake(o.scenario, taken_J);
    if (!result.reason.empty()) fmt::print(stderr, "virtual-rig: {}\n", result.reason);
    if (result.ending == plant_sim::Ending::stopped) return signals.exit_status();
    return result.ending == plant_sim::Ending::done ? 0 : 1;
}

/// Configuration errors end with status 2, later ones with 1.
int load_and_run(const Options& options) {
    std::optional<plant_sim::StopInputs> scenario;
    try {
        scenario = plant_sim::load_scenario(options.scenario);
        if (options.clock == "sync" && !scenario->layout[antiskid::can::Role::sync].bound) {
            throw std::invalid_argument("--clock sync needs a layout with a [sync] message; this one has none");
        }
    } catch (const std::exception& e) {
        fmt::print(stderr, "virtual-rig: {}\n", e.what());
        return 2;
    }
    return run(options, *scenario);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc > 1 && std::string_view(argv[1]) == "serve") return plant_sim::serve_command(argc - 1, argv + 1);
        Options options;
        if (const auto status = parse(argc, argv, options)) return *status;
        return load_and_run(options);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "virtual-rig: %s\n", e.what());
        return 1;
    }
}
