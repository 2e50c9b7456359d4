#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/command_line.hpp"
#include "plant_sim/lab/campaign_progress.hpp"
#include "plant_sim/lab/margins_input.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/margins/margins_report.hpp"
#include "plant_sim/study/margins/tyres.hpp"
#include "rig_bridge/rig/compliance.hpp"

namespace plant_sim::lab {

namespace {

namespace margins = study::margins;

/// A tyre from the command line, in the place of the one that the rig's file has.
/// The keys of [tyre] in the rig's file. Numbers may be lists: then every combination of them is a tyre.
struct TyreOptions {
    std::string model;  ///< empty: as the rig's file has it
    std::vector<double> belt_share{0.35}, frequency_Hz{80.0}, damping{0.06};
    std::vector<double> length_m{0.20}, floor_m{0.02};

    void add_to(CLI::App& app);

    /// One at least; `own` where none is named. Throws std::invalid_argument where a number belongs to another model.
    [[nodiscard]] std::vector<rig::Compliance> tyres(const rig::Compliance& own) const;

  private:
    std::vector<const CLI::Option*> of_ring_, of_relaxation_;
};

const CLI::Option* list(CLI::App& app, const std::string& name, std::vector<double>& numbers, double min, double max, const std::string& what) {
    return app.add_option(name, numbers, what)
        ->delimiter(',')
        ->check([min, max](const std::string& text) {
            // CLI::Range lets a value pass that is no number.
            double number = 0.0;
            const bool good = CLI::detail::lexical_cast(text, number) && number >= min && number <= max;
            return good ? std::string() : fmt::format("{} is not from {:g} to {:g}", text, min, max);
        })
        ->capture_default_str();
}

void reject(const std::vector<const CLI::Option*>& options, const std::string& model) {
    for (const CLI::Option* o : options)
        if (o->count() > 0) throw std::invalid_argument(o->get_name() + " needs --tyre " + model);
}

void TyreOptions::add_to(CLI::App& app) {
    settings::one_of(app.add_option("--tyre", model, "static (the paper's), ring or relaxation, in the place of the rig file's [tyre]"),
                     {"static", "ring", "relaxation"});
    of_ring_ = {list(app, "--belt-share", belt_share, 0.01, 0.9, "ring: of J_w that is belt; a list makes a table"),
                list(app, "--frequency", frequency_Hz, 5.0, 1000.0, "ring: rim against belt, Hz; or a list"),
                list(app, "--damping", damping, 0.0, 1.0, "ring: of that mode, of critical; or a list")};
    of_relaxation_ = {list(app, "--length", length_m, 0.001, 2.0, "relaxation: length at no slip, m; or a list"),
                      list(app, "--floor", floor_m, 0.001, 2.0, "relaxation: it is nowhere shorter, m; or a list")};
}

std::vector<rig::Compliance> TyreOptions::tyres(const rig::Compliance& own) const {
    if (model != "ring") reject(of_ring_, "ring");
    if (model != "relaxation") reject(of_relaxation_, "relaxation");
    rig::Compliance one = own;
    if (model.empty()) return {one};
    one.ring = {};
    one.relaxation = {};
    std::vector<rig::Compliance> all;
    if (model == "static") all.push_back(one);
    if (model == "ring") {
        for (const double frequency : frequency_Hz)
            for (const double zeta : damping)
                for (const double share : belt_share) {
                    one.ring = {.belt_share = share, .frequency_Hz = frequency, .damping = zeta};
                    all.push_back(one);
                }
    }
    if (model == "relaxation") {
        for (const double length : length_m)
            for (const double floor : floor_m) {
                one.relaxation = {.length_m = length, .floor_m = floor};
                all.push_back(one);
            }
    }
    return all;
}

struct MarginsCommand {
    StopOptions scenario;
    TyreOptions tyre;
    margins::StudyOptions options;
    bool constant_slip = false;
    double picture_mps = 30.0;
    std::filesystem::path out = "out/margins";
    std::string json_file;  ///< "-": standard output

    int run() {
        // CLI::Range lets a value pass that is no number.
        if (!std::isfinite(picture_mps)) throw std::invalid_argument("--picture-speed must be a number from 5 to 49");
        MarginsInput input = load_margins_input(scenario);
        const auto tyres = tyre.tyres(input.cases.front().rig.wheel.compliance);
        settings::create_directories(out);  // refused now, not when the study is over
        options.slip_reference = scenario.slip;
        options.low_speed_fall = !constant_slip;
        options.requirement = input.settings.requirement;

        std::vector<margins::TyreRow> rows;
        margins::ReportHead head{.config_hash = input.config_hash, .version = ANTISKID_VERSION, .options = options, .pid = input.settings.pid};
        for (std::size_t i = 0; i < tyres.size(); ++i) {
            for (margins::StopConditions& s : input.cases) s.rig.wheel.compliance = tyres[i];
            const auto cells =
                margins::study_cells(input.cases, input.scenarios.front().controller, input.settings.pid, options, progress(i, tyres.size()));
            if (tyres.size() > 1) {
                rows.push_back(margins::tyre_row(tyres[i], cells, options.requirement));
                continue;
            }
            head.tyre = margins::tyre_name(tyres[i]);
            keep_json(out / "results.json", json_file, margins::to_json(input.cases, cells, head));
            margins::draw_plant(input.cases, options.slip_reference, picture_mps, out / "margins.png");
            margins::draw_margins(input.cases, cells, head, out / "margins_speed.png");
            print_table(json_file, "{}{}", margins::to_table(input.cases, cells, head), margins::excited_table(input.cases, cells));
            print_table(json_file, "Written to {}: results.json margins.png margins_speed.png\n", out.string());
        }
        if (rows.empty()) return 0;
        keep_json(out / "results.json", json_file, margins::to_json(rows, head));
        print_table(json_file, "{}Written to {}: results.json\n", margins::to_table(rows, head), out.string());
        return 0;
    }

    [[nodiscard]] static margins::Progress progress(std::size_t before, std::size_t tyres) {
        return [=, show = step_progress("scenarios")](std::size_t done, std::size_t all) { show(before * all + done, tyres * all); };
    }
};

}  // namespace

LabVerb margins_verb(CLI::App& lab) {
    const auto command = std::make_shared<MarginsCommand>();
    CLI::App* verb = lab.add_subcommand("margins", "Phase and gain margins of the slip loop, all surfaces and maneuvers over the speed range.");
    verb->add_option("--slip", command->scenario.slip, "slip reference")->check(CLI::Range(0.01, 0.5))->capture_default_str();
    verb->add_option("--speeds", command->options.speeds, "speeds from brake-on to drop-out")->check(CLI::Range(2, 200))->capture_default_str();
    verb->add_flag("--constant-slip", command->constant_slip, "the reference does not fall at low speed: the paper's exact law");
    command->tyre.add_to(*verb);
    verb->add_option("--mu-b", command->scenario.choice.friction, "mean brake friction instead of a new brake's");
    verb->add_option("--picture-speed", command->picture_mps, "speed of margins.png, m/s")->check(CLI::Range(5.0, 49.0))->capture_default_str();
    settings::add_config_directory(*verb, command->scenario.config);
    settings::existing_file(
        verb->add_option("--controller", command->scenario.controller, "controller configuration (default: CONFIG/controller.toml)"));
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory of results.json, margins.png (Fig. 11) and margins_speed.png");
    verb->footer(
        "Two loops: the shipped law with its observer and predictor, and the paper's PID on measured slip "
        "with the gains of "
        "CONFIG/margins.toml.\nExamples:\n  rig-lab margins\n  rig-lab margins --constant-slip --speeds 20 "
        "--out out/exact\n  rig-lab margins --tyre ring --frequency 50,80,120 --damping 0.03,0.10 "
        "--belt-share 0.25,0.45");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
