#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <string>

#include "plant_sim/campaign_source.hpp"
#include "plant_sim/lab_wear.hpp"
#include "plant_sim/wear/model_io.hpp"
#include "plant_sim/wear/resimulation.hpp"
#include "plant_sim/wear_pictures.hpp"

namespace plant_sim {

namespace {

struct SimulateCommand {
    std::filesystem::path source;
    std::string campaign;
    std::filesystem::path model;
    wear::ConditionalRule rule;
    std::uint64_t seed = 1;
    std::filesystem::path out = "out/wear";

    int run() const {
        const wear::Campaign recorded = load_campaign(source, campaign);
        const wear::Model learnt = wear::read_model(model);
        const wear::Campaign simulated = wear::resimulated(recorded, learnt, rule, seed);
        const wear::Comparison c = wear::compare(recorded, simulated, learnt, rule);
        std::string table =
            fmt::format("{:>10}{:>10}{:>11}{:>14}{:>16}{:>16}{:>14}\n", "from_MJ", "to_MJ", "maneuvers",
                        "mean_error", "dev._recorded", "dev._simulated", "within_90%");
        for (const wear::EnergyBand& b : c.bands)
            fmt::format_to(std::back_inserter(table),
                           "{:>10.2f}{:>10.2f}{:>11}{:>14.5f}{:>16.5f}{:>16.5f}{:>14.3f}\n", b.from_J * 1e-6,
                           b.to_J * 1e-6, b.maneuvers, b.mean_error, b.deviation_recorded,
                           b.deviation_simulated, b.coverage_90);
        fmt::print(
            "{}recorded points within the model's central 90 %: {:.3f}\ntwo-sample Kolmogorov-Smirnov "
            "distance "
            "{:.4f}, probability {:.3f}\n",
            table, c.coverage_90, c.ks_distance, c.ks_probability);
        const auto beyond = std::count_if(recorded.points.begin(), recorded.points.end(),
                                          [&](const wear::Point& p) { return learnt.extrapolates(p.c_e_J); });
        if (beyond > 0)
            fmt::print("{} maneuvers are beyond the model's data ({:.3f} to {:.3f} MJ): {}.\n", beyond,
                       learnt.data.first_c_e_J * 1e-6, learnt.data.last_c_e_J * 1e-6,
                       wear::kHowItExtrapolates);
        deliver((out / "simulated.csv").string(), wear::to_csv(simulated));
        draw_resimulation(recorded, simulated, out / "simulated.png");
        fmt::print("Written to {}: simulated.csv simulated.png\n", out.string());
        return 0;
    }
};

}  // namespace

LabVerb wear_simulate_verb(CLI::App& wear) {
    const auto simulate = std::make_shared<SimulateCommand>();
    CLI::App* verb = wear.add_subcommand("simulate",
                                         "Fig. 9: the maneuvers of a campaign again, with their recorded "
                                         "brake energy and friction drawn from eq. (14).");
    verb->add_option("SOURCE", simulate->source, "as for `wear table`")->required()->check(CLI::ExistingPath);
    verb->add_option("--campaign", simulate->campaign,
                     "which of a ledger's campaigns; may be left out for one");
    verb->add_option("--model", simulate->model, "model.json of `wear fit`")
        ->required()
        ->check(CLI::ExistingFile);
    static const std::map<std::string, wear::Variance> kVariances{{"exact", wear::Variance::exact},
                                                                  {"printed", wear::Variance::printed}};
    verb->add_option("--variance", simulate->rule.variance,
                     "exact: (1 - rho^2) sigma_b^2; printed: (1 - rho) sigma_b^2 as in the paper's eq. (14)")
        ->transform(CLI::CheckedTransformer(kVariances))
        ->default_str("exact");
    static const std::map<std::string, wear::Choice> kChoices{{"nearest", wear::Choice::nearest},
                                                              {"mixture", wear::Choice::mixture}};
    verb->add_option(
            "--component", simulate->rule.choice,
            "nearest: of the component nearest in energy (the paper); mixture: the exact conditional")
        ->transform(CLI::CheckedTransformer(kChoices))
        ->default_str("nearest");
    verb->add_option("--seed", simulate->seed, "seed of every random draw")->capture_default_str();
    verb->add_option("--out", simulate->out, "directory of simulated.csv and simulated.png")
        ->capture_default_str();
    verb->footer(
        "Example:\n  rig-lab wear simulate measured.csv --model out/wear/model.json --component mixture");
    return {verb, [simulate] { return simulate->run(); }};
}

}  // namespace plant_sim
