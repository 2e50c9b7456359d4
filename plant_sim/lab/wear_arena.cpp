#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/wear/arena.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace plant_sim::lab {

namespace {

using settings::Json;
using wear::arena::Scores;

constexpr std::array kForecasters{wear::arena::Method::past_lives,   wear::arena::Method::shipped,  wear::arena::Method::past_lives_read,
                                  wear::arena::Method::shipped_read, wear::arena::Method::law_told, wear::arena::Method::law_told_read,
                                  wear::arena::Method::oracle};
constexpr const char* kMadeUp = "lives made up by the laws of plant_sim/wear/rival_laws.hpp";

std::string table_of(const Scores& scores) {
    auto next = settings::TextTable::screen("next friction:>16|CRPS:>10.5f|log:>10.3f|PIT:>8.3f");
    for (std::size_t e = 0; e < scores.size(); ++e)
        next.add(wear::arena::kMethodNames.at(e), scores.at(e).crps, scores.at(e).log_score, scores.at(e).pit);
    std::string out = next.text();
    const auto block = [&](const char* title, int digits, double wear::arena::LeftScore::*value) {
        std::string columns = fmt::format("{}:>16", title);
        for (std::size_t k = 0; k < wear::arena::kTenths; ++k) columns += fmt::format("|{} %:>8.{}f", 10 * (k + 1), digits);
        auto table = settings::TextTable::screen(columns);
        for (std::size_t e = 0; e < scores.size(); ++e) {
            if (!scores.at(e).forecasts) continue;
            table.add(wear::arena::kMethodNames.at(e));
            for (const wear::arena::LeftScore& left : scores.at(e).left) table.add(left.*value);
        }
        out += table.text();
    };
    block("80 % holds", 2, &wear::arena::LeftScore::held);
    block("its width", 1, &wear::arena::LeftScore::width);
    block("CRPS", 2, &wear::arena::LeftScore::crps);
    block("of skill", 2, &wear::arena::LeftScore::skill);
    return out;
}

/// Of landings left, over all tenths.
std::string by_law(const std::vector<wear::arena::Law>& laws, const std::vector<Scores>& scores) {
    std::string columns = "judged law:>14";
    for (const wear::arena::Method e : kForecasters)
        columns += fmt::format("|{}:>16.2f|skill:>8.2f", wear::arena::kMethodNames.at(static_cast<std::size_t>(e)));
    auto table = settings::TextTable::screen(columns);
    for (std::size_t i = 0; i < laws.size(); ++i) {
        table.add(wear::arena::kLawNames.at(static_cast<std::size_t>(laws[i])));
        const auto crps = [&](wear::arena::Method e) {
            double sum = 0.0;
            for (const wear::arena::LeftScore& left : scores[i].at(static_cast<std::size_t>(e)).left) sum += left.crps;
            return sum;
        };
        const double past = crps(wear::arena::Method::past_lives), oracle = crps(wear::arena::Method::oracle);
        for (const wear::arena::Method e : kForecasters) {
            double held = 0.0;
            for (const wear::arena::LeftScore& left : scores[i].at(static_cast<std::size_t>(e)).left) held += left.held / wear::arena::kTenths;
            table.add(held, (past - crps(e)) / (past - oracle));
        }
    }
    return table.text();
}

std::string watch_table(const std::vector<wear::arena::Law>& laws, const std::vector<wear::arena::WatchScore>& watch) {
    auto table = settings::TextTable::screen("found within 25:>16|10 %:>8.2f|5 %:>8.2f|false:>8.3f|difference 10 %:>18.2f|5 %:>8.2f|false:>8.3f");
    for (std::size_t i = 0; i < laws.size(); ++i)
        table.add(wear::arena::kLawNames.at(static_cast<std::size_t>(laws[i])), watch[i].watch.glazing_10, watch[i].watch.glazing_5,
                  watch[i].watch.healthy, watch[i].difference.glazing_10, watch[i].difference.glazing_5, watch[i].difference.healthy);
    return table.text();
}

Json json_of(const wear::arena::Found& f) {
    return {{"healthy_called_abnormal", f.healthy}, {"glazing_10_found", f.glazing_10}, {"glazing_5_found", f.glazing_5}};
}

Json json_of(const Scores& scores) {
    Json out;
    for (std::size_t e = 0; e < scores.size(); ++e) {
        const wear::arena::Score& s = scores.at(e);
        Json& one = out[wear::arena::kMethodNames.at(e)] = {{"crps", s.crps}, {"log_score", s.log_score}, {"pit_distance", s.pit}};
        if (!s.forecasts) continue;
        for (const wear::arena::LeftScore& k : s.left)
            one["landings_left"].push_back(
                {{"asked", k.asked}, {"coverage", k.held}, {"width_landings", k.width}, {"crps_landings", k.crps}, {"skill", k.skill}});
    }
    return out;
}

struct ArenaCommand {
    std::filesystem::path config = settings::config_directory();
    std::string seeds = "tuning";
    std::vector<std::string> laws{wear::arena::kLawNames.begin(), wear::arena::kLawNames.end()};
    std::size_t lives = 20;
    std::size_t training_lives = 20;
    unsigned threads = wear::all_cores();
    std::filesystem::path out = "out/wear";
    std::string json_file;  ///< "-": standard output

    [[nodiscard]] int run() const {
        const std::filesystem::path file = config / "wear_arena.toml";
        const std::string hash = settings::hash(std::array{file});
        wear::arena::Plan plan{.settings = wear::arena::load_settings(file),
                               .laws = {},
                               .judged_seed = 0,
                               .training_lives = training_lives,
                               .judged_lives = lives,
                               .watch = true,
                               .threads = threads};
        plan.judged_seed = seeds == "held_out" ? plan.settings.held_out : plan.settings.tuning;
        for (std::size_t i = 0; i < wear::arena::kLawNames.size(); ++i)
            if (std::find(laws.begin(), laws.end(), wear::arena::kLawNames.at(i)) != laws.end())
                plan.laws.push_back(static_cast<wear::arena::Law>(i));
        const wear::arena::Result result = wear::arena::run(plan);
        Json json{{"version", ANTISKID_VERSION},
                  {"config_hash", hash},
                  {"source", kMadeUp},
                  {"laws", laws},
                  {"seeds", seeds},
                  {"first_seed", plan.judged_seed},
                  {"lives", lives},
                  {"training_lives", training_lives}};
        const auto laws_json = [&](const std::vector<Scores>& scores) {
            Json by;
            for (std::size_t i = 0; i < plan.laws.size(); ++i)
                by[wear::arena::kLawNames.at(static_cast<std::size_t>(plan.laws[i]))] = json_of(scores[i]);
            return by;
        };
        json["within_laws"] = json_of(result.within);
        json["within_laws_by_law"] = laws_json(result.within_by_law);
        print_table(json_file, "Within laws, {} lives of each, {} to learn from; {}:\n{}", lives, training_lives, kMadeUp,
                    table_of(result.within) + by_law(plan.laws, result.within_by_law));
        if (result.across) {
            json["across_laws"] = json_of(*result.across);
            json["across_laws_by_law"] = laws_json(result.across_by_law);
            print_table(json_file, "Across laws, trained on each other law in turn:\n{}",
                        table_of(*result.across) + by_law(plan.laws, result.across_by_law));
        }
        for (std::size_t i = 0; i < plan.laws.size(); ++i)
            json["watch_by_law"][wear::arena::kLawNames.at(static_cast<std::size_t>(plan.laws[i]))] = {
                {"watch", json_of(result.watch[i].watch)}, {"difference_of_means", json_of(result.watch[i].difference)}};
        print_table(json_file, "Glazing found, limits from {} lives of the law, watch and difference of two means of ten:\n{}",
                    wear::arena::kLimitLives, watch_table(plan.laws, result.watch));
        write_json(out / "arena.json", json_file, settings::json_page(json));
        print_table(json_file, "{} seeds, configuration {}\nWritten to {}: arena.json\n", seeds, hash, out.string());
        return 0;
    }
};

}  // namespace

LabVerb wear_arena_verb(CLI::App& wear) {
    const auto command = std::make_shared<ArenaCommand>();
    CLI::App* verb = wear.add_subcommand("arena", "Forecasts against each other on lives by laws that none of them was made from.");
    settings::one_of(verb->add_option("--seeds", command->seeds, "first seed by its name in wear_arena.toml: held_out to report"),
                     {"tuning", "held_out"})
        ->capture_default_str();
    settings::one_of(verb->add_option("--laws", command->laws, "that wear the brakes: each learnt from, and each judged on"),
                     {wear::arena::kLawNames.begin(), wear::arena::kLawNames.end()})
        ->delimiter(',');
    verb->add_option("--lives", command->lives, "judged, of each law")->check(CLI::Range(1, 100'000))->capture_default_str();
    verb->add_option("--training-lives", command->training_lives, "of each law")->check(CLI::Range(3, 1000))->capture_default_str();
    settings::add_config_directory(*verb, command->config);
    settings::add_threads(*verb, command->threads);
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory of arena.json");
    verb->footer("Examples:\n  rig-lab wear arena --laws archard,oxidation --lives 5\n  rig-lab wear arena --seeds held_out");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
