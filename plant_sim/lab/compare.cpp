#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/in_process.hpp"

namespace plant_sim::lab {

namespace {

struct CompareCommand {
    StopOptions scenario;
    std::vector<std::filesystem::path> runways;
    std::vector<std::string> laws{"slip", "threshold"};
    std::string json;

    /// The runways where some are given, otherwise all surfaces.
    [[nodiscard]] std::vector<rig::ManeuverChoice> roads() const {
        std::vector<rig::ManeuverChoice> all;
        const auto add = [&]() -> rig::ManeuverChoice& { return all.emplace_back(scenario.choice); };
        for (const std::filesystem::path& runway : runways) add().runway = runway;
        if (!all.empty()) return all;
        for (const std::string& surface : rig::surface_names(scenario.config)) add().surface = surface;
        return all;
    }

    [[nodiscard]] study::StopReport stop(const rig::ManeuverChoice& choice, const std::string& law) const {
        StopOptions options = scenario;
        options.choice = choice;
        options.law = law;
        const StopInputs s = load_scenario(options);
        const study::RunResult result = study::run_in_process(s.controller, s.layout, s.plant.rig, s.session, study::Link::rounded);
        study::StopReport report = s.report(options);
        report.figures = result.figures;
        report.faults = result.faults;
        return report;
    }

    /// Markdown, so that the table can stand in a page as it is.
    int run() const {
        const auto roads = this->roads();
        const auto maneuvers = rig::maneuver_names(scenario.config);
        const std::size_t all = roads.size() * maneuvers.size();
        std::string columns = "surface|maneuver";
        for (const std::string& law : laws) {
            columns += fmt::format("|{} law: J_mu:.4f|distance (m):.1f", law);
            if (&law == &laws.front()) columns += "|longest lock (ms):.0f";
        }
        auto table = settings::TextTable::markdown(columns);
        settings::Json rows = settings::Json::array();
        std::vector<double> sums(laws.size());
        std::size_t done = 0;
        for (rig::ManeuverChoice choice : roads) {
            for (const std::string& maneuver : maneuvers) {
                choice.maneuver = maneuver;
                table.add(choice.road(), maneuver);
                for (std::size_t i = 0; i < laws.size(); ++i) {
                    const study::StopReport report = stop(choice, laws[i]);
                    const study::StopFigures& f = report.figures;
                    sums[i] += f.j_mu / static_cast<double>(all);
                    rows.push_back(settings::parse_json(study::to_json(report)));
                    table.add(f.j_mu, f.stop_distance_m);
                    if (i == 0) table.add(f.longest_lock_s * 1e3);
                }
                ++done;
                if (::isatty(STDERR_FILENO) == 1) fmt::print(stderr, "\r{} of {} scenarios{}", done, all, done == all ? "\n" : "");
            }
        }
        table.add("mean", "", sums[0], "", "");
        for (std::size_t i = 1; i < laws.size(); ++i) table.add(sums[i], "");
        print_table(json, "{}", table.text());
        if (!json.empty()) settings::deliver(json, settings::json_page(rows));
        return 0;
    }
};

}  // namespace

LabVerb compare_verb(CLI::App& lab) {
    const auto compare = std::make_shared<CompareCommand>();
    CLI::App* verb = lab.add_subcommand("compare", "The slip law against the threshold law on all surfaces and maneuvers.");
    settings::one_of(verb->add_option("--laws", compare->laws, "to compare; the first is the one whose locks are shown"),
                     {"slip", "peak_slip", "threshold", "pressure_bias"})
        ->delimiter(',')
        ->capture_default_str();
    verb->add_option("--slip", compare->scenario.slip, "slip reference")->check(CLI::Range(0.0, 0.5))->capture_default_str();
    settings::add_seed(*verb, compare->scenario.seed);
    settings::add_config_directory(*verb, compare->scenario.config);
    verb->add_option("--mu-b", compare->scenario.choice.friction, "mean brake friction instead of a new brake's");
    settings::existing_file(verb->add_option("--runway", compare->runways, "runways instead of the surfaces, files as in config/runways"));
    settings::add_json(*verb, compare->json, "every stop");
    verb->footer(
        "Examples:\n  rig-lab compare --slip 0.24 --json compare.json\n"
        "  rig-lab compare --laws slip,peak_slip,threshold,pressure_bias\n"
        "  rig-lab compare --runway config/runways/wet_smooth.toml --runway config/runways/wet_grooved.toml");
    return {verb, [compare] { return compare->run(); }};
}

}  // namespace plant_sim::lab
