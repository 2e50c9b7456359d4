#include <fmt/core.h>

#include <memory>
#include <optional>

#include "firmware/host/settings/atomic_file.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/sweep/trade.hpp"

namespace plant_sim::lab {

namespace {

struct TradeCommand {
    std::filesystem::path source = "out/sweep";
    std::optional<double> brake_price;
    std::optional<double> tyre_price;
    std::optional<double> brake_life;
    std::optional<double> tyre_life;
    sweep::TradeOptions options;
    std::filesystem::path out = "out/trade";
    std::string json_file;  ///< "-": standard output
    bool pictures = true;

    int run() {
        if (brake_price && tyre_price && !brake_life && !tyre_life)
            options.tariff = sweep::Prices{*brake_price, *tyre_price};
        else if (brake_life && tyre_life && !brake_price && !tyre_price)
            options.tariff = sweep::Lives{*brake_life, *tyre_life};
        else
            throw std::invalid_argument("give both --brake-price and --tyre-price (of a MJ), or both --brake-life and --tyre-life (in MJ)");
        const auto file = std::filesystem::is_directory(source) ? source / "stops.csv" : source;
        if (!std::filesystem::exists(file)) throw std::invalid_argument(file.string() + " is not there; `rig-lab sweep` makes it");
        const sweep::StopsTable table = sweep::read_stops(file);
        const sweep::Trade trade = sweep::traded(table, options);
        write_json(out / "results.json", json_file, sweep::to_json(trade, table, options));
        if (pictures) sweep::draw_trade(trade, options, out / "trade.png");
        print_table(json_file, "{}Written to {}: results.json{}\n", sweep::to_text(trade, options), out.string(), pictures ? " trade.png" : "");
        return trade.best ? 0 : 1;
    }
};

}  // namespace

LabVerb trade_verb(CLI::App& lab) {
    const auto trade = std::make_shared<TradeCommand>();
    CLI::App* verb = lab.add_subcommand("trade", "The fixed slip reference that costs least at brake and tyre, from a sweep, and what it saves.");
    verb->add_option("SWEEP", trade->source, "directory of a sweep, or its stops.csv")->capture_default_str();
    verb->add_option("--brake-price", trade->brake_price, "of a MJ at the brake, in any currency");
    verb->add_option("--tyre-price", trade->tyre_price, "of a MJ at the tyre, in the same");
    verb->add_option("--brake-life", trade->brake_life, "MJ that a set of brakes takes; the most landings before either is worn out");
    verb->add_option("--tyre-life", trade->tyre_life, "MJ that a tyre takes");
    verb->add_option("--min-j-mu", trade->options.bounds.min_j_mu, "floor on the mean J_mu")->check(CLI::Range(0.0, 1.0));
    verb->add_option("--max-distance", trade->options.bounds.max_distance_m, "ceiling on the mean stop distance, m")->check(CLI::PositiveNumber);
    verb->add_option("--resamples", trade->options.resamples, "of the landings, for the 95 % intervals")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    settings::add_seed(*verb, trade->options.seed, "of the resamples");
    settings::add_json(*verb, trade->json_file, "results");
    settings::add_out(*verb, trade->out, "directory of results.json and trade.png");
    settings::add_no_pictures(*verb, trade->pictures);
    verb->footer(
        "Examples:\n"
        "  rig-lab trade --brake-price 1 --tyre-price 3 --min-j-mu 0.95\n"
        "  rig-lab trade --brake-life 3900 --tyre-life 900 --max-distance 505\n"
        "Exit status: 0 there is a best reference; 1 none is within the bounds; 2 mistake on the command line or in a file.");
    return {verb, [trade] { return trade->run(); }};
}

}  // namespace plant_sim::lab
