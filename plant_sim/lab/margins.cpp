#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "config/reader/atomic_file.hpp"
#include "plant_sim/lab/campaign_progress.hpp"
#include "plant_sim/lab/margins_input.hpp"
#include "plant_sim/lab/tyre_options.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/margins/margins_report.hpp"
#include "plant_sim/study/margins/tyres.hpp"

namespace plant_sim {

namespace {

namespace margins = study::margins;

struct MarginsCommand {
    ScenarioOptions scenario;
    TyreOptions tyre;
    margins::StudyOptions options;
    bool constant_slip = false;
    double picture_mps = 30.0;
    std::filesystem::path out = "out/margins";
    std::string json_file;  ///< "-": standard output

    int run() {
        // CLI::Range lets a value pass that is no number.
        if (!std::isfinite(picture_mps))
            throw std::invalid_argument("--picture-speed must be a number from 5 to 49");
        MarginsInput input = load_margins_input(scenario);
        const auto tyres = tyre.tyres(input.cases.front().rig.wheel.compliance);
        settings::create_directories(out);  // refused now, not when the study is over
        options.slip_reference = scenario.slip;
        options.low_speed_fall = !constant_slip;
        options.requirement = input.settings.requirement;

        std::vector<margins::TyreRow> rows;
        margins::ReportHead head{.config_hash = input.config_hash,
                                 .version = ANTISKID_VERSION,
                                 .options = options,
                                 .pid = input.settings.pid};
        for (std::size_t i = 0; i < tyres.size(); ++i) {
            for (margins::Scenario& s : input.cases) s.rig.wheel.compliance = tyres[i];
            const auto cells = margins::study_cells(input.cases, input.scenarios.front().controller,
                                                    input.settings.pid, options, progress(i, tyres.size()));
            if (tyres.size() > 1) {
                rows.push_back(margins::tyre_row(tyres[i], cells, options.requirement));
                continue;
            }
            head.tyre = margins::tyre_name(tyres[i]);
            keep_json(out / "results.json", json_file, margins::to_json(input.cases, cells, head));
            margins::draw_plant(input.cases, options.slip_reference, picture_mps, out / "margins.png");
            margins::draw_margins(input.cases, cells, head, out / "margins_speed.png");
            print_table(json_file, "{}{}", margins::to_table(input.cases, cells, head),
                        margins::excited_table(input.cases, cells));
            print_table(json_file, "Written to {}: results.json margins.png margins_speed.png\n",
                        out.string());
        }
        if (rows.empty()) return 0;
        keep_json(out / "results.json", json_file, margins::to_json(rows, head));
        print_table(json_file, "{}Written to {}: results.json\n", margins::to_table(rows, head),
                    out.string());
        return 0;
    }

    [[nodiscard]] static margins::Progress progress(std::size_t before, std::size_t tyres) {
        return [=, show = step_progress("scenarios")](std::size_t done, std::size_t all) {
            show(before * all + done, tyres * all);
        };
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
    command->tyre.add_to(*verb);
    verb->add_option("--mu-b", command->scenario.choice.friction,
                     "mean brake friction instead of a new brake's");
    verb->add_option("--picture-speed", command->picture_mps, "speed of margins.png, m/s")
        ->check(CLI::Range(5.0, 49.0))
        ->capture_default_str();
    settings::add_config_directory(*verb, command->scenario.config);
    settings::existing_file(verb->add_option("--controller", command->scenario.controller,
                                             "controller configuration (default: CONFIG/controller.toml)"));
    settings::add_json(*verb, command->json_file, "results");
    verb->add_option("--out", command->out,
                     "directory of results.json, margins.png (Fig. 11) and margins_speed.png")
        ->capture_default_str()
        ->type_name("DIRECTORY");
    verb->footer(
        "Two loops: the shipped law with its observer and predictor, and the paper's PID on measured slip "
        "with the gains of "
        "CONFIG/margins.toml.\nExamples:\n  rig-lab margins\n  rig-lab margins --constant-slip --speeds 20 "
        "--out out/exact\n  rig-lab margins --tyre ring --frequency 50,80,120 --damping 0.03,0.10 "
        "--belt-share 0.25,0.45");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim
