#include <fmt/format.h>

#include <memory>

#include "firmware/host/settings/progress.hpp"
#include "plant_sim/lab/campaign_options.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "rig_bridge/wear/learn_population.hpp"
#include "rig_bridge/wear/on_threads.hpp"
#include "rig_bridge/wear/population_io.hpp"

namespace plant_sim::lab {

namespace {

struct PopulationCommand {
    std::vector<std::filesystem::path> sources;
    std::vector<std::filesystem::path> healthy;
    rig::replay::OutOfTolerance off = rig::replay::OutOfTolerance::left_out;
    std::string origin;
    wear::LearnSettings settings;
    std::filesystem::path out = "out/wear";
    std::string json_file;  ///< "-": standard output

    int run() {
        std::vector<wear::Campaign> campaigns = rig::replay::load_campaigns(sources, off);
        if (!origin.empty())
            for (wear::Campaign& c : campaigns) c.origin = origin;
        settings.healthy = rig::replay::load_campaigns(healthy, off);
        const wear::Population p = wear::learn_population(campaigns, settings, settings::step_progress("steps"));
        print_table(json_file,
                    "Learnt from brakes {}: scatter {:.5f} of which {:.5f} remembers, by {:.2f} from one maneuver to the next; offset of a brake "
                    "{:.5f}, drift {:.6f} "
                    "in 1 MJ; log of its energy {:.3f} about a member's; health limits {:.2f} gradual, {:.2f} sudden, {:.2f} glazing\n",
                    p.provenance.sentence(), std::hypot(p.scatter.remembered, p.scatter.fresh), p.scatter.remembered, p.scatter.memory,
                    p.spread.offset, p.scatter.drift_per_root_MJ, p.spread.log_energy_scale, p.limits.gradual, p.limits.sudden, p.limits.glazing);
        write_json(out / "population.json", json_file, wear::to_json(p));
        print_table(json_file, "Written to {}: population.json\n", out.string());
        return 0;
    }
};

}  // namespace

LabVerb wear_population_verb(CLI::App& wear) {
    const auto command = std::make_shared<PopulationCommand>();
    command->settings.threads = wear::all_cores();
    CLI::App* verb =
        wear.add_subcommand("population", "What several brakes that were worn out have in common and how they differ: for forecast and watch.");
    settings::existing_path(verb->add_option("SOURCE", command->sources,
                                             "campaigns as for `wear table`, or directories of CSV files; three brakes at least, better twenty"))
        ->required();
    verb->add_option("--limit", command->settings.limit,
                     "mean friction that forecasts will ask about; intervals are calibrated for it (default: between the middle and the end of the "
                     "brakes' lives)")
        ->check(CLI::Range(0.001, 1.5));
    settings::existing_path(verb->add_option(
        "--healthy", command->healthy,
        "campaigns of other brakes that were healthy: health limits are learnt from them (default: from the same brakes, each given the others)"));
    add_out_of_tolerance_flag(*verb, command->off);
    add_origin(*verb, command->origin);
    settings::add_seed(*verb, command->settings.fit.seed);
    settings::add_threads(*verb, command->settings.threads);
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory of population.json");
    verb->footer("Example:\n  rig-lab wear population campaigns/ --healthy healthy/ --limit 0.2 --out out/wear");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
