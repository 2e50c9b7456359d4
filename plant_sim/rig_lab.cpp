/// rig-lab: studies in process, faster than real time. See --help.

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <array>
#include <exception>
#include <iterator>
#include <string>

#include "config/reader/atomic_file.hpp"
#include "firmware/can/candump.hpp"
#include "plant_sim/scenario_options.hpp"
#include "plant_sim/study/drive.hpp"
#include "plant_sim/study/in_process.hpp"
#include "plant_sim/study/picture.hpp"
#include "plant_sim/study/trajectory.hpp"

namespace {

/// To a file, whole or not at all; "-" is standard output.
void deliver(const std::string& where, std::string_view text) {
    if (where == "-")
        fmt::print("{}", text);
    else
        settings::write_file(where, text);
}

struct StopCommand {
    plant_sim::ScenarioOptions scenario;
    std::string json;
    std::string trajectory;
    std::string picture;
    std::string bus_log;

    int run() const {
        const plant_sim::Scenario s = plant_sim::load_scenario(scenario);
        study::Trajectory rows;
        std::string log;
        const auto on_step = [&](const study::RigSession& session, const antiskid::can::ControllerView& view,
                                 double current_mA) {
            if (!trajectory.empty() || !picture.empty()) rows.record(session, view, current_mA);
        };
        const auto on_frame = [&](const antiskid::can::Frame& frame) {
            if (bus_log.empty()) return;
            std::array<char, antiskid::can::kCandumpLineMost + 1> line{};
            const std::size_t length = antiskid::can::format_candump(frame.received, "vcan0", frame, line);
            log.append(line.data(), length).push_back('\n');
        };
        const study::RunResult result = study::run_in_process(s.controller, s.layout, s.plant.rig, s.session,
                                                              study::Link::frames, on_step, on_frame);
        study::StopReport report = s.report(scenario);
        report.figures = result.figures;
        report.faults = result.faults;
        report.frames_sent = result.frames_sent;
        report.frames_received = result.frames_received;
        if (json != "-") fmt::print("{}", study::to_table(report));
        if (!json.empty()) deliver(json, study::to_json(report));
        if (!bus_log.empty()) deliver(bus_log, log);
        if (!trajectory.empty()) deliver(trajectory, rows.csv());
        if (!picture.empty()) {
            const std::string csv = trajectory.empty() || trajectory == "-" ? picture + ".csv" : trajectory;
            if (csv != trajectory) settings::write_file(csv, rows.csv());
            study::draw_stop(csv, picture, s.title(scenario),
                             s.session.plan.touchdown_s + s.session.plan.settle_s);
        }
        return result.came_to_rest ? 0 : 1;
    }
};

struct DriveCommand {
    plant::ManeuverChoice choice;
    std::filesystem::path config = "config";
    std::filesystem::path input;
    std::string output;

    int run() const {
        const plant::LoadedRig rig = plant::load_rig(config, choice);
        deliver(output, study::drive(rig.rig, study::read_profile(input)));
        return 0;
    }
};

void add_stop(CLI::App& app, StopCommand& stop) {
    CLI::App* verb = app.add_subcommand(
        "stop", "One braking maneuver in closed loop: the real controller against the plant.");
    stop.scenario.add_to(*verb);
    verb->add_option("--json", stop.json, "result as JSON: a file, or - for standard output");
    verb->add_option("--trajectory", stop.trajectory, "trajectory as CSV");
    verb->add_option("--picture", stop.picture, "picture of speeds, slip and pressures (PNG)");
    verb->add_option("--bus-log", stop.bus_log, "every frame, as candump writes them");
    verb->footer(
        "Examples:\n"
        "  rig-lab stop --maneuver heavy --surface wet_asphalt --slip 0.24 --json -\n"
        "  rig-lab stop --surface ice --law threshold --picture ice.png");
}

void add_drive(CLI::App& app, DriveCommand& drive) {
    CLI::App* verb =
        app.add_subcommand("drive", "Open loop: the plant alone under a pressure or current profile.");
    verb->add_option("--maneuver", drive.choice.maneuver, "mass and speed")->capture_default_str();
    verb->add_option("--surface", drive.choice.surface, "runway")->capture_default_str();
    verb->add_option("--input", drive.input,
                     "CSV: time_s,pressure_Pa or time_s,current_mA, linear between rows")
        ->required();
    verb->add_option("--output", drive.output, "CSV, or - for standard output")->required();
    verb->add_option("--mass", drive.choice.mass_kg, "kg, instead of the maneuver's");
    verb->add_option("--speed", drive.choice.speed_mps, "m/s, instead of the maneuver's");
    verb->add_option("--mu-b", drive.choice.friction, "mean brake friction instead of a new brake's");
    verb->add_option("--config", drive.config, "directory of the configuration files")->capture_default_str();
    verb->footer(
        "Example:\n  rig-lab drive --maneuver light --surface wet_asphalt --input pressure.csv --output "
        "motion.csv");
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"rig-lab: studies of controller and plant in process, without a bus.", "rig-lab"};
    app.set_version_flag("--version", ANTISKID_VERSION);
    app.require_subcommand(1);
    StopCommand stop;
    DriveCommand drive;
    add_stop(app, stop);
    add_drive(app, drive);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        const int status = app.exit(e);
        return status == 0 ? 0 : 2;
    }
    try {
        return app.got_subcommand("stop") ? stop.run() : drive.run();
    } catch (const std::exception& e) {
        fmt::print(stderr, "rig-lab: {}\n", e.what());
        return 2;
    }
}
