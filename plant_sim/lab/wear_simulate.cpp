#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <string>

#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/lab/campaign_options.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/lab/wear_pictures.hpp"
#include "plant_sim/scenario/brake_options.hpp"
#include "plant_sim/study/torque_replay.hpp"
#include "plant_sim/wear/resimulation.hpp"
#include "rig_bridge/wear/model_io.hpp"

namespace plant_sim::lab {

namespace {

std::string table_of(const wear::Comparison& c) {
    auto table = settings::TextTable::screen(
        "from_MJ:>10.2f|to_MJ:>10.2f|maneuvers:>11|mean_error:>14.5f|dev._recorded:>16.5f|dev._simulated:>16.5f|within_90%:>14.3f");
    for (const wear::EnergyBand& b : c.bands)
        table.add(b.from_J * 1e-6, b.to_J * 1e-6, b.maneuvers, b.mean_error, b.deviation_recorded, b.deviation_simulated, b.coverage_90);
    table.line(fmt::format("recorded points within the model's central 90 %: {:.3f}", c.coverage_90));
    table.line(fmt::format("two-sample Kolmogorov-Smirnov distance {:.4f}, probability {:.3f}", c.ks_distance, c.ks_probability));
    return table.text();
}

settings::Json json_of(const wear::Comparison& c) {
    settings::Json bands = settings::Json::array();
    for (const wear::EnergyBand& b : c.bands)
        bands.push_back({{"from_J", b.from_J},
                         {"to_J", b.to_J},
                         {"maneuvers", b.maneuvers},
                         {"mean_error", b.mean_error},
                         {"deviation_recorded", b.deviation_recorded},
                         {"deviation_simulated", b.deviation_simulated},
                         {"coverage_90", b.coverage_90}});
    return {{"bands", bands}, {"coverage_90", c.coverage_90}, {"ks_distance", c.ks_distance}, {"ks_probability", c.ks_probability}};
}

struct SimulateCommand {
    CampaignOptions from;
    std::filesystem::path model;
    std::string replay;  ///< empty: torque where it was recorded
    std::string maneuver = rig::kEndurance;
    std::filesystem::path config = settings::config_directory();
    wear::ConditionalRule rule;
    std::uint64_t seed = 1;
    std::filesystem::path out = "out/wear";
    std::string json_file;  ///< "-": standard output

    int run() const {
        const wear::Campaign recorded = from.load();
        if (replay == "torque" && recorded.brakings.empty())
            throw settings::Error(recorded.source, 0, "mean_torque_Nm",
                                  "--replay torque needs the columns brake_on_mps, mean_torque_Nm and mean_load_N, as a ledger has them");
        const bool by_torque = replay.empty() ? !recorded.brakings.empty() : replay == "torque";
        const wear::Model learnt = wear::read_model(model);
        settings::Json json{{"source", recorded.source},
                            {"data_hash", wear::data_hash(recorded)},
                            {"maneuvers", recorded.points.size()},
                            {"learnt_from", wear::json_of({learnt.data.origin, 1})},
                            {"replay", by_torque ? "torque" : "energy"}};
        std::vector<std::filesystem::path> files{model};
        const wear::Campaign simulated = by_torque ? through_plant(recorded, learnt, files, json) : wear::resimulated(recorded, learnt, rule, seed);
        const wear::Comparison c = wear::compare(recorded, simulated, learnt, rule);
        print_table(json_file, "By a brake {}.\n{}", wear::origin_phrase(learnt.data.origin), table_of(c));
        const auto beyond =
            std::count_if(simulated.points.begin(), simulated.points.end(), [&](const wear::Point& p) { return learnt.extrapolates(p.c_e_J); });
        if (beyond > 0)
            print_table(json_file, "{} maneuvers are beyond the model's data ({:.3f} to {:.3f} MJ): {}.\n", beyond, learnt.data.first_c_e_J * 1e-6,
                        learnt.data.last_c_e_J * 1e-6, wear::kHowItExtrapolates);
        json["extrapolated"] = beyond;
        json.update(json_of(c));
        json["seed"] = seed;
        json["version"] = ANTISKID_VERSION;
        json["config_hash"] = settings::hash(files);
        write_json(out / "simulated.json", json_file, settings::json_page(json));
        settings::deliver((out / "simulated.csv").string(), wear::to_csv(simulated));
        draw_resimulation(recorded, simulated, out / "simulated.png");
        print_table(json_file, "Written to {}: simulated.csv simulated.json simulated.png\n", out.string());
        return 0;
    }

  private:
    /// Adds what it read to `files`, and what it found to `json`.
    [[nodiscard]] wear::Campaign through_plant(const wear::Campaign& recorded, const wear::Model& learnt, std::vector<std::filesystem::path>& files,
                                               settings::Json& json) const {
        rig::ManeuverChoice choice;
        choice.maneuver = maneuver;
        const rig::LoadedRig rig = rig::load_rig(config, choice);
        files.insert(files.end(), rig.files.begin(), rig.files.end());
        // The model is of this very brake; its life is of no interest here.
        const wear::BrakeWear wear{
            .model = std::make_shared<const wear::Model>(learnt), .scale = {}, .life_J = learnt.data.last_c_e_J, .file = model, .law = {}};
        const std::size_t all = recorded.points.size();
        const study::TorqueReplay replayed =
            study::replay_torques(recorded, rig,
                                  // Draws of its own: with the campaign's seed, a campaign of the virtual rig would only be repeated.
                                  {wear, rule, {.seed = ~seed, .maneuvers = 0, .c_e_J = wear::taken_before_J(recorded)}},
                                  [all, show = settings::step_progress("maneuvers")](std::size_t done) { show(done, all); });
        print_table(json_file, "{} maneuvers through the plant by their recorded torque: energy {:+.2f} % of the recorded", all,
                    replayed.energy_error * 100.0);
        if (replayed.short_of_pressure > 0)
            print_table(json_file, "; in {} full pressure did not give the torque everywhere", replayed.short_of_pressure);
        print_table(json_file, "\n");
        json["maneuver"] = maneuver;
        json["energy_error"] = replayed.energy_error;
        json["short_of_pressure"] = replayed.short_of_pressure;
        return replayed.simulated;
    }
};

}  // namespace

LabVerb wear_simulate_verb(CLI::App& wear) {
    const auto simulate = std::make_shared<SimulateCommand>();
    CLI::App* verb = wear.add_subcommand("simulate",
                                         "Fig. 9: the maneuvers of a campaign again with friction drawn from eq. (14), compared with the recorded. "
                                         "Leaves simulated.csv, simulated.json and simulated.png.");
    simulate->from.add_to(*verb, "as for `wear table`")->required();
    settings::existing_file(verb->add_option("--model", simulate->model, "model.json of `wear fit`"))->required();
    settings::one_of(
        verb->add_option("--replay", simulate->replay,
                         "torque: through the plant, the recorded braking torque fed in (default where SOURCE has brake_on_mps, mean_torque_Nm and "
                         "mean_load_N; a ledger has); energy: no plant, each maneuver takes the recorded brake energy"),
        {"torque", "energy"});
    verb->add_option("--maneuver", simulate->maneuver, "whose rig makes the stops: endurance, or one of maneuvers.toml")->capture_default_str();
    settings::add_config_directory(*verb, simulate->config);
    add_rule_options(*verb, simulate->rule);
    settings::add_seed(*verb, simulate->seed);
    settings::add_json(*verb, simulate->json_file, "results");
    settings::add_out(*verb, simulate->out, "directory of the results");
    verb->footer(
        "Examples:\n"
        "  rig-lab wear simulate out/endurance-1 --model out/wear/model.json\n"
        "  rig-lab wear simulate measured.csv --model out/wear/model.json --replay energy --component nearest");
    return {verb, [simulate] { return simulate->run(); }};
}

}  // namespace plant_sim::lab
