#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/lab/campaign_options.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/lab/wear_pictures.hpp"
#include "plant_sim/wear/fault_trial.hpp"
#include "rig_bridge/wear/model_io.hpp"

namespace plant_sim::lab {

namespace {

using settings::Json;

struct WatchCommand {
    CampaignOptions from;
    PopulationOptions model;
    bool trial = false;
    std::uint64_t seed = 1;
    std::filesystem::path out = "out/wear";
    std::string json_file;  ///< "-": standard output
    bool pictures = true;

    int run() const {
        const wear::PopulationFile file = model.read();
        print_table(json_file, "By brakes {}.\n", file.population.provenance.sentence());
        return trial ? run_trial(file) : watch(file);
    }

  private:
    int watch(const wear::PopulationFile& file) const {
        const wear::Campaign recorded = from.load();
        wear::HealthMonitor monitor(file.population);
        std::vector<wear::Verdict> verdicts;
        verdicts.reserve(recorded.points.size());
        Json list = Json::array();
        wear::Condition before = wear::Condition::unknown;
        for (std::size_t i = 0; i < recorded.points.size(); ++i) {
            const wear::Point& p = recorded.points[i];
            const wear::Verdict& v = verdicts.emplace_back(monitor.after(p));
            if (v.condition != before)
                print_table(json_file, "maneuver {:>5}, {:9.3f} MJ: {}{}{}\n", i + 1, p.c_e_J * 1e-6, wear::name(v.condition),
                            v.reason.empty() ? "" : ": ", v.reason);
            before = v.condition;
            list.push_back({{"maneuver", i + 1},
                            {"health", wear::name(v.condition)},
                            {"statistic", v.statistic},
                            {"score", v.score},
                            {"mean_friction", p.mean_friction},
                            {"expected", v.expected},
                            {"deviation", v.deviation},
                            {"reason", v.reason}});
        }
        print_table(json_file, "{} after {} maneuvers, statistic {:.2f} of its limit\n", wear::name(before), verdicts.size(),
                    verdicts.back().statistic);
        const Json json{{"version", ANTISKID_VERSION},
                        {"model_hash", file.hash},
                        {"learnt_from", wear::json_of(file.population.provenance)},
                        {"data_hash", wear::data_hash(recorded)},
                        {"health", wear::name(before)},
                        {"maneuvers", std::move(list)}};
        write_json(out / "health.json", json_file, settings::json_page(json));
        if (pictures) draw_health(recorded, verdicts, out / "health.png");
        print_table(json_file, "Written to {}: health.json{}\n", out.string(), pictures ? " health.png" : "");
        return before == wear::Condition::abnormal ? 1 : 0;
    }
    int run_trial(const wear::PopulationFile& file) const {
        using wear::BrakeFault;
        struct Case {
            BrakeFault fault;
            double size;
        };
        constexpr std::array kCases{Case{BrakeFault::glazing, 0.05}, Case{BrakeFault::glazing, 0.10}, Case{BrakeFault::glazing, 0.20},
                                    Case{BrakeFault::drop, 0.05},    Case{BrakeFault::drop, 0.10},    Case{BrakeFault::drop, 0.20},
                                    Case{BrakeFault::drag, 0.05},    Case{BrakeFault::drag, 0.10},    Case{BrakeFault::drag, 0.20}};
        const std::vector<wear::Campaign> healthy = rig::replay::load_campaigns({from.source}, from.off);
        const wear::HealthyTrial h = wear::try_healthy(file.population, healthy);
        const auto tried = settings::step_progress("trials");
        tried(1, kCases.size() + 1);
        print_table(json_file, "{} healthy brakes, {} maneuvers: {} called abnormal ({:.2f} % of the brakes), {:.2f} % of maneuvers suspect\n",
                    h.campaigns, h.maneuvers, h.flagged, 100.0 * static_cast<double>(h.flagged) / static_cast<double>(h.campaigns),
                    100.0 * static_cast<double>(h.suspected_maneuvers) / static_cast<double>(h.maneuvers));
        auto table = settings::TextTable::screen("fault:<14|size:>8|brakes:>10|flagged:>10|50 % after:>12|90 % after:>12");
        Json rows = Json::array();
        for (std::size_t i = 0; i < kCases.size(); ++i) {
            const wear::FaultTrial t = wear::try_fault(file.population, healthy, kCases.at(i).fault, kCases.at(i).size, seed);
            const double flagged = static_cast<double>(t.flagged) / static_cast<double>(std::max<std::size_t>(1, t.campaigns));
            table.add(wear::name(t.fault), fmt::format("{:.0f} %", 100.0 * t.size), t.campaigns, fmt::format("{:.1f} %", 100.0 * flagged), t.median,
                      t.ninety == 0 ? "-" : fmt::format("{}", t.ninety));
            rows.push_back({{"fault", wear::name(t.fault)},
                            {"size", t.size},
                            {"brakes", t.campaigns},
                            {"flagged", t.flagged},
                            {"median_maneuvers", t.median},
                            {"ninety_maneuvers", t.ninety}});
            tried(i + 2, kCases.size() + 1);
        }
        print_table(json_file, "{}", table.text());
        const Json json{
            {"version", ANTISKID_VERSION},
            {"seed", seed},
            {"model_hash", file.hash},
            {"learnt_from", wear::json_of(file.population.provenance)},
            {"healthy",
             {{"brakes", h.campaigns}, {"maneuvers", h.maneuvers}, {"flagged", h.flagged}, {"suspected_maneuvers", h.suspected_maneuvers}}},
            {"faults", std::move(rows)}};
        write_json(out / "watch_trial.json", json_file, settings::json_page(json));
        print_table(json_file, "Written to {}: watch_trial.json\n", out.string());
        return 0;
    }
};

}  // namespace

LabVerb wear_watch_verb(CLI::App& wear) {
    const auto watch = std::make_shared<WatchCommand>();
    CLI::App* verb =
        wear.add_subcommand("watch", "Health of a brake after each maneuver: does its friction go on as that of brakes like those the model knows?");
    watch->from.add_to(*verb, "as for `wear table`; with --trial a directory of healthy brakes' campaigns as CSV")->required();
    watch->model.add_to(*verb);
    verb->add_flag("--trial", watch->trial,
                   "false alarms on healthy brakes, and how soon glazing, a sudden drop and a dragging piston are flagged when they are put into the "
                   "same campaigns");
    settings::add_seed(*verb, watch->seed, "of the trial: where the faults begin");
    settings::add_json(*verb, watch->json_file, "results");
    settings::add_out(*verb, watch->out, "directory of health.json and health.png, or watch_trial.json");
    settings::add_no_pictures(*verb, watch->pictures);
    verb->footer(
        "Examples:\n  rig-lab wear watch runs/brake7 --model mine.json\n  rig-lab wear watch measured.csv --model out/wear/model.json\n"
        "  rig-lab wear watch --trial healthy/ --model mine.json\n"
        "Exit status: 0 not abnormal, 1 abnormal, 2 mistake on the command line or in a file.");
    return {verb, [watch] { return watch->run(); }};
}

}  // namespace plant_sim::lab
