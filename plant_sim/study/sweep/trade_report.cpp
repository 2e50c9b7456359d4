#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/study/sweep/trade.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace sweep {

namespace {

/// Name in JSON and words for people, by BindingLimit.
constexpr std::array<std::array<const char*, 2>, 5> kLimits{{
    {"nothing", "neither a bound nor the end of the references holds it: cost is least there"},
    {"min_j_mu", "the floor on J_mu decides: beyond it would be cheaper"},
    {"max_distance", "the ceiling on distance decides: beyond it would be cheaper"},
    {"end_of_references", "the end of the sweep's references decides: beyond may be cheaper"},
    {"no_cost", "nothing costs anything: the greatest J_mu within the bounds"},
}};

settings::Json json_of(const ReferenceMeans& o) {
    settings::Json json;
    if (o.slip_reference > 0.0) json["slip_reference"] = o.slip_reference;
    json.update({{"j_mu", o.j_mu},
                 {"stop_distance_m", o.stop_distance_m},
                 {"energy_brake_J", o.energy_brake_J},
                 {"energy_tyre_J", o.energy_tyre_J},
                 {"cost", o.cost}});
    return json;
}

settings::Json json_of(const Saving& s) {
    return {{"share", s.share}, {"interval_95", {s.interval.low, s.interval.high}}};
}

bool by_life(const TradeOptions& options) {
    return std::holds_alternative<Lives>(options.tariff);
}

/// Small numbers stay readable in any currency.
std::string cost_text(const ReferenceMeans& o, const TradeOptions& options) {
    return by_life(options) ? fmt::format("{:.1f}", 1.0 / o.cost) : fmt::format("{:.5g}", o.cost);
}

std::string saving_text(const Saving& s, const char* than, const TradeOptions& options) {
    if (!by_life(options))
        return fmt::format("  saves against {}: {:.2f} % (95 %: {:.2f} to {:.2f})\n", than, s.share * 100.0, s.interval.low * 100.0,
                           s.interval.high * 100.0);
    // A cost reduced by s gives 1 / (1 - s) times as many landings.
    const auto more = [](double share) { return (1.0 / (1.0 - share) - 1.0) * 100.0; };
    return fmt::format("  landings more than with {}: {:.2f} % (95 %: {:.2f} to {:.2f})\n", than, more(s.share), more(s.interval.low),
                       more(s.interval.high));
}

std::string bounds_text(const Bounds& bounds) {
    std::string text;
    if (bounds.min_j_mu) text += fmt::format("mean J_mu at least {}", *bounds.min_j_mu);
    if (bounds.max_distance_m) text += fmt::format("{}mean distance at most {} m", text.empty() ? "" : ", ", *bounds.max_distance_m);
    return text.empty() ? "no bound" : text;
}

/// `y` over the cost of all references, as points: along the references the cost falls and rises again.
template <typename Y>
pictures::Chart chart(const Trade& t, const TradeOptions& options, const char* y_label, const std::optional<double>& bound, const Y& y) {
    using pictures::Series;
    using pictures::Style;
    Series outside{.name = "slip references", .style = Style::points, .colour = pictures::sky};
    Series inside{.name = "within the bounds", .style = Style::points, .colour = pictures::blue};
    double next_label = 0.0;
    for (const ReferenceMeans& o : t.offers) {
        Series& one = options.bounds.allow(o.j_mu, o.stop_distance_m) ? inside : outside;
        one.add(o.cost, y(o));
        const bool named = o.slip_reference >= next_label - 1e-9;
        one.notes.push_back(named ? fmt::format("{:.2f}", o.slip_reference) : "");
        if (named) next_label = o.slip_reference + 0.1;
    }
    pictures::Chart chart{.y_label = y_label,
                          .x_label = by_life(options) ? "share of the first worn part's life that a landing takes" : "cost of a landing",
                          .series = {std::move(outside), std::move(inside)}};
    const auto mark = [&](const char* name, const std::optional<ReferenceMeans>& o, pictures::Colour colour) {
        if (o) chart.series.push_back({.name = name, .style = Style::points, .colour = colour, .x = {o->cost}, .y = {y(*o)}});
    };
    mark("threshold law", t.threshold, pictures::vermillion);
    mark("reference 0.24", t.paper, pictures::black);
    mark("best", t.best, pictures::green);
    const auto [least, greatest] =
        std::minmax_element(t.offers.begin(), t.offers.end(), [](const ReferenceMeans& p, const ReferenceMeans& q) { return p.cost < q.cost; });
    if (bound && least != t.offers.end()) chart.series.push_back(pictures::level("bound", least->cost, greatest->cost, *bound, pictures::grey));
    return chart;
}

}  // namespace

std::string to_json(const Trade& t, const StopsTable& sweep, const TradeOptions& options) {
    settings::Json json{{"study", "trade"},     {"version", sweep.identity.version}, {"config_hash", sweep.identity.config_hash},
                        {"sweep", sweep.name},  {"sweep_seed", sweep.identity.seed}, {"landings", sweep.identity.landings},
                        {"seed", options.seed}, {"resamples", options.resamples}};
    if (const auto* price = std::get_if<Prices>(&options.tariff))
        json.update({{"brake_price_per_MJ", price->brake_per_MJ}, {"tyre_price_per_MJ", price->tyre_per_MJ}});
    else
        json.update({{"brake_life_MJ", std::get<Lives>(options.tariff).brake_MJ}, {"tyre_life_MJ", std::get<Lives>(options.tariff).tyre_MJ}});
    if (options.bounds.min_j_mu) json["min_j_mu"] = *options.bounds.min_j_mu;
    if (options.bounds.max_distance_m) json["max_distance_m"] = *options.bounds.max_distance_m;
    json["feasible"] = t.best.has_value();
    json["feasible_share_of_resamples"] = t.feasible_share;
    if (t.best) {
        json["best"] = json_of(*t.best);
        json["best"]["slip_reference_interval_95"] = {t.best_interval.low, t.best_interval.high};
        json["decided_by"] = kLimits.at(static_cast<std::size_t>(t.decides))[0];
    }
    if (t.paper) json["reference_0_24"] = json_of(*t.paper);
    if (t.threshold) json["threshold"] = json_of(*t.threshold);
    if (t.against_paper) json["saves_against_0_24"] = json_of(*t.against_paper);
    if (t.against_threshold) json["saves_against_threshold"] = json_of(*t.against_threshold);
    json["greatest_j_mu"] = json_of(t.greatest_j_mu);
    json["min_distance"] = json_of(t.min_distance);
    return settings::json_page(json);
}

std::string to_text(const Trade& t, const TradeOptions& options) {
    std::string text = fmt::format("Bounds: {}.\n", bounds_text(options.bounds));
    if (!t.best)
        text += fmt::format(
            "No fixed slip reference is within them: mean J_mu is at most {:.4f} (at {:.3f}), mean distance at least {:.1f} m (at {:.3f}).\n",
            t.greatest_j_mu.j_mu, t.greatest_j_mu.slip_reference, t.min_distance.stop_distance_m, t.min_distance.slip_reference);
    else
        text += fmt::format("Best fixed slip reference {:.3f} (95 %: {:.3f} to {:.3f}); {}.\n", t.best->slip_reference, t.best_interval.low,
                            t.best_interval.high, kLimits.at(static_cast<std::size_t>(t.decides))[1]);
    auto table = settings::TextTable::screen(
        fmt::format(":<16|J_mu:>10.4f|distance_m:>12.1f|brake_MJ:>11.3f|tyre_MJ:>10.3f|{}:>14", by_life(options) ? "landings" : "cost"));
    const auto row = [&](const std::string& name, const std::optional<ReferenceMeans>& o) {
        if (o) table.add(name, o->j_mu, o->stop_distance_m, o->energy_brake_J * 1e-6, o->energy_tyre_J * 1e-6, cost_text(*o, options));
    };
    row("best", t.best);
    row("reference 0.24", t.paper);
    row("threshold law", t.threshold);
    text += table.text();
    if (t.against_paper) text += saving_text(*t.against_paper, "0.24", options);
    if (t.against_threshold) text += saving_text(*t.against_threshold, "the threshold law", options);
    if (t.best && t.feasible_share < 1.0)
        text += fmt::format("  in {:.1f} % of the resamples no reference is within the bounds\n", (1.0 - t.feasible_share) * 100.0);
    return text;
}

void draw_trade(const Trade& t, const TradeOptions& options, const std::filesystem::path& png) {
    pictures::draw({.charts = {chart(t, options, "mean J_mu", options.bounds.min_j_mu, [](const ReferenceMeans& o) { return o.j_mu; }),
                               chart(t, options, "mean braking distance (m)", options.bounds.max_distance_m,
                                     [](const ReferenceMeans& o) { return o.stop_distance_m; })},
                    .columns = 2},
                   png);
}

}  // namespace sweep
