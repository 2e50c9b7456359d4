#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "plant_sim/lab/margins_input.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/margins/margins_report.hpp"

namespace plant_sim {

namespace {

namespace margins = study::margins;

struct MarginsCommand {
    ScenarioOptions scenario;
    margins::StudyOptions options;
    bool constant_slip = false;
    double picture_mps = 30.0;
    std::filesystem::path out = "out/margins";

    int run() {
        // CLI::Range lets a value pass that is no number.
        if (!std::isfinite(picture_mps))
            throw std::invalid_argument("--picture-speed must be a number from 5 to 49");
        const MarginsInput input = load_margins_input(scenario);
        std::filesystem::create_directories(out);  // refused now, not when the study is over
        options.slip_reference = scenario.slip;
        options.low_speed_fall = !constant_slip;
        options.requirement = input.settings.requirement;

        const bool terminal = ::isatty(STDERR_FILENO) == 1;
        const auto cells = margins::study_cells(
            input.cases, input.scenarios.front().controller, input.settings.pid, options,
            [terminal](std::size_t done, std::size_t all) {
                if (terminal)
                    fmt::print(stderr, "\r{} of {} scenarios{}", done, all, done == all ? "\n" : "");
            });
        const margins::ReportHead head{.config_hash = input.config_hash,
                                       .version = ANTISKID_VERSION,
                                       .options = options,
                                       .pid = input.settings.pid};
        deliver((out / "results.json").string(), margins::to_json(input.cases, cells, head));
        margins::draw_plant(input.cases, options.slip_reference, picture_mps, out / "margins.png");
        margins::draw_margins(input.cases, cells, options.requirement, out / "margins_speed.png");
        fmt::print("{}", margins::to_table(input.cases, cells, head));
        return 0;
    }
};

}  // namespace

LabVerb margins_verb(CLI::App& lab) {
    const auto command = std::make_shared<MarginsCommand>();
    CLI::App* verb = lab.add_subcommand(
        "margins",
        "Phase and gain margins of the slip loop, all surfaces and maneuvers over the speed range.");
    verb->add_option("--slip", command->scenario.slip, "slip reference")
        ->check(CLI::Range(0.01, 0.5))
        ->capture_default_str();
    verb->add_option("--speeds", command->options.speeds, "speeds from brake-on to drop-out")
        ->check(CLI::Range(2, 200))
        ->capture_default_str();
    verb->add_flag("--constant-slip", command->constant_slip,
                   "the reference does not fall at low speed: the paper's exact law");
    verb->add_option("--mu-b", command->scenario.choice.friction,
                     "mean brake friction instead of a new brake's");
    verb->add_option("--picture-speed", command->picture_mps, "speed of margins.png, m/s")
        ->check(CLI::Range(5.0, 49.0))
        ->capture_default_str();
    verb->add_option("--config", command->scenario.config, "directory of the configuration files")
        ->capture_default_str();
    verb->add_option("--controller", command->scenario.controller,
                     "controller configuration (default: CONFIG/controller.toml)");
    verb->add_option("--out", command->out,
                     "directory of results.json, margins.png (Fig. 11) and margins_speed.png")
        ->capture_default_str();
    verb->footer(
        "Two loops: the shipped law with its observer and predictor, and the paper's PID on measured slip "
        "with the gains of "
        "CONFIG/margins.toml.\nExamples:\n  rig-lab margins\n  rig-lab margins --constant-slip --speeds 20 "
        "--out out/exact");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim
