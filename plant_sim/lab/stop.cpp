#include <fmt/core.h>

#include <array>
#include <memory>

#include "firmware/can/candump.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/in_process.hpp"
#include "plant_sim/study/trajectory.hpp"
#include "rig_bridge/pictures/stop_picture.hpp"

namespace plant_sim::lab {

namespace {

struct StopCommand {
    StopOptions scenario;
    std::string json;
    std::string trajectory;
    std::filesystem::path picture;
    std::string bus_log;

    int run() const {
        const StopInputs s = load_scenario(scenario);
        if (s.brake) {
            const std::string notice = extrapolation_notice(*s.brake);
            if (!notice.empty()) fmt::print(stderr, "rig-lab: {}\n", notice);
        }
        const bool along_runway = !s.plant.rig.runway.patches.empty();
        study::Trajectory course(along_runway);
        std::string log;
        const auto on_step = [&](const study::RigSession& session, const antiskid::can::ControllerView& view, double current_mA) {
            if (!trajectory.empty() || !picture.empty()) course.record(session, view, current_mA);
        };
        const auto on_frame = [&](const antiskid::can::Frame& frame) {
            if (bus_log.empty()) return;
            std::array<char, antiskid::can::kCandumpLineMax + 1> line{};
            const std::size_t length = antiskid::can::format_candump(frame.received, "vcan0", frame, line);
            log.append(line.data(), length).push_back('\n');
        };
        const study::RunResult result = study::run_in_process(s.controller, s.layout, s.plant.rig, s.session, study::Link::frames, on_step, on_frame);
        const study::StopReport report = s.report(scenario, result);
        if (json != "-") fmt::print("{}", study::to_table(report));
        if (!json.empty()) settings::deliver(json, study::to_json(report));
        if (!bus_log.empty()) settings::deliver(bus_log, log);
        if (!trajectory.empty()) settings::deliver(trajectory, course.csv());
        if (!picture.empty()) pictures::draw_stop(course.rows(), picture, s.title(scenario), s.session.plan.touchdown_s + s.session.plan.settle_s);
        s.save_brake(scenario, result.figures.energy_brake_J);
        return result.came_to_rest ? 0 : 1;
    }
};

}  // namespace

LabVerb stop_verb(CLI::App& lab) {
    const auto stop = std::make_shared<StopCommand>();
    CLI::App* verb = lab.add_subcommand("stop", "One braking maneuver in closed loop: the real controller against the plant.");
    stop->scenario.add_to(*verb);
    stop->scenario.brake.add_to(*verb);
    settings::add_json(*verb, stop->json, "result");
    settings::result_file(verb->add_option("--trajectory", stop->trajectory, "every period as CSV; - for standard output"));
    settings::add_picture(*verb, stop->picture, "speeds, slip and pressures");
    settings::result_file(verb->add_option("--bus-log", stop->bus_log, "every frame, as candump writes them"));
    verb->footer(
        "Examples:\n"
        "  rig-lab stop --maneuver heavy --surface wet_asphalt --slip 0.24 --json -\n"
        "  rig-lab stop --surface ice --law threshold --picture ice.png\n"
        "  rig-lab stop --runway config/runways/wet_middle.toml --picture wet.png\n"
        "  rig-lab stop --brake worn\n"
        "  rig-lab stop --brake-state brake.json   # each stop wears it");
    return {verb, [stop] { return stop->run(); }};
}

}  // namespace plant_sim::lab
