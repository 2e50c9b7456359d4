#include <fmt/format.h>

#include <memory>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/robust/report.hpp"

namespace plant_sim::lab {

namespace {

struct RobustCommand {
    robust::RobustPlanOptions options;
    unsigned threads = 0;
    std::filesystem::path out = "out/robust";
    std::string json_file;  ///< "-": standard output
    bool pictures = true;

    [[nodiscard]] int run(study::team::Team& team) const {
        const robust::RobustPlan plan = robust::load_plan(options);
        antiskid::host::StopSignals signals;
        settings::Progress progress(static_cast<std::int64_t>(plan.stops()), 0, "stops");
        const std::vector<robust::DrawnStop> rows =
            robust::run(plan,
                        {.threads = threads_in(team, threads),
                         .stop = &signals.stop(),
                         .progress = [&](std::size_t done) { progress.show(static_cast<std::int64_t>(done)); }},
                        team);
        progress.finish();
        if (team.rank() != 0) return 0;
        if (rows.size() < plan.stops()) {
            fmt::print(stderr, "rig-lab: stopped after {} of {} stops; nothing is written\n", rows.size(), plan.stops());
            return signals.exit_status();
        }
        const std::vector<robust::Summary> summaries = robust::summarise(plan, rows);
        settings::write_file(out / "stops.csv", robust::to_csv(plan, rows));
        write_json(out / "results.json", json_file, robust::to_json(plan, rows, summaries));
        if (pictures) robust::draw_j_mu(plan, rows, summaries, out / "robust.png");
        print_table(json_file, "{}seed {}, configuration {}, version {}\nWritten to {}: stops.csv results.json{}\n",
                    robust::to_table(plan, rows, summaries), plan.seed, plan.config_hash, ANTISKID_VERSION, out.string(),
                    pictures ? " robust.png" : "");
        bool sound = true;
        for (const robust::Summary& s : summaries)
            sound = sound && (plan.laws[s.law].law != antiskid::control::Law::wheel_slip || s.brakes_released == 0);
        return sound ? 0 : 1;
    }
};

}  // namespace

LabVerb robust_verb(CLI::App& lab) {
    const auto command = std::make_shared<RobustCommand>();
    CLI::App* verb = lab.add_subcommand("robust", "Stops on plants and runways drawn from config/uncertainty.toml, every law on the same draws.");
    verb->add_option("--families", command->options.families, "which ranges are drawn from; changes and brake_on, grids of stops: see below")
        ->delimiter(',')
        ->capture_default_str();
    settings::one_of(
        verb->add_option(
            "--laws", command->options.laws,
            "told_peak: the slip law told the peak of the surface under the wheel, with whose distances the others' are compared; "
            "soonest: no law, but full current or none until the wheel has that slip, held exactly from then on (changes, brake_on); wary: the "
            "same without knowing the runway ahead, by what was under the wheel 20 ms before (brake_on)"),
        {"slip", "peak_slip", "threshold", "pressure_bias", "told_peak", "soonest", "wary"})
        ->delimiter(',')
        ->capture_default_str();
    verb->add_option("--draws", command->options.draws, "of each family that is drawn; a multiple of 14 has all landings equally often")
        ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000}))
        ->capture_default_str();
    settings::add_seed(*verb, command->options.seed, "of the draws: 1 to tune with, others to report");
    settings::existing_file(
        verb->add_option("--controller", command->options.controller, "controller configuration (default: CONFIG/controller.toml)"));
    settings::existing_file(verb->add_option("--ranges", command->options.ranges, "what is drawn (default: CONFIG/uncertainty.toml)"));
    settings::add_config_directory(*verb, command->options.config);
    settings::add_threads(*verb, command->threads, "all cores; 1 for each process of mpirun");
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory of stops.csv, results.json and robust.png");
    settings::add_no_pictures(*verb, command->pictures);
    verb->footer(
        "Examples:\n"
        "  rig-lab robust\n"
        "  rig-lab robust --families ring,relaxation --draws 168 --seed 2\n"
        "  mpirun -n 4 rig-lab robust        the same bytes\n"
        "  rig-lab robust --families patches --laws told_peak,peak_slip,slip --draws 1000 --seed 4\n"
        "  rig-lab robust --families changes --laws slip,peak_slip   friction after a change of surface\n"
        "  rig-lab robust --families brake_on --laws peak_slip,soonest  brake-on from 12 to 61 m/s, and what the valve leaves of it\n"
        "Exit status: 0 the slip law wrongly released the brakes in no stop; 1 in some; 2 mistake on the command line or in a file; 130 stopped by "
        "Ctrl-C.");
    return {verb, [command] { return in_team([command](study::team::Team& team) { return command->run(team); }); }};
}

}  // namespace plant_sim::lab
