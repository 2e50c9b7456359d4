/// What a fixed slip reference costs at brake and tyre, and the cheapest one that still brakes well enough.
///
/// Between the references of the sweep means are linear, in steps of kStep. How sure the answer is comes from the scatter of the landings:
/// they are drawn again with replacement, the same landings for every reference and for the threshold law (a paired bootstrap), and
/// each draw is answered anew.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "plant_sim/study/sweep/stops_table.hpp"

namespace sweep {

/// In whatever currency, at least 0. A landing costs the sum.
struct Prices {
    double brake_per_MJ = 0.0;
    double tyre_per_MJ = 0.0;
};

/// The energy that a set of each may take, above 0. A landing costs the share of its life that the one which wears out first loses:
/// one over this cost is the number of landings until then.
struct Lives {
    double brake_MJ = 0.0;
    double tyre_MJ = 0.0;
};

using Tariff = std::variant<Prices, Lives>;

struct Bounds {
    std::optional<double> min_j_mu{};        ///< of the mean over the landings
    std::optional<double> max_distance_m{};  ///< of the mean stop distance
};

struct TradeOptions {
    Tariff tariff;
    Bounds bounds{};
    int resamples = 2000;
    std::uint64_t seed = 1;
};

/// Means over the landings at one reference.
struct Offer {
    double slip_reference = 0.0;
    double j_mu = 0.0;
    double stop_distance_m = 0.0;
    double energy_brake_J = 0.0;
    double energy_tyre_J = 0.0;
    double cost = 0.0;
};

/// The middle 95 % of the resamples.
struct Interval {
    double low = 0.0;
    double high = 0.0;
};

/// Share of the other's cost that the best reference saves; negative where it costs more.
struct Saving {
    double share = 0.0;
    Interval interval;
};

/// What keeps the best reference from moving on to where it would be cheaper.
enum class Decides { nothing, min_j_mu, max_distance, end_of_references, no_cost };

struct Trade {
    static constexpr double kStep = 0.001;

    std::vector<Offer> offers;    ///< every kStep of the reference
    std::optional<Offer> best{};  ///< none: no reference is within the bounds
    Interval best_interval{};     ///< of its reference, over the resamples in which one is within the bounds
    double feasible_share = 0.0;  ///< of the resamples
    Decides decides = Decides::nothing;
    std::optional<Offer> paper{};      ///< at 0.24, where the sweep reaches it
    std::optional<Offer> threshold{};  ///< the threshold law; its reference is 0
    std::optional<Saving> against_paper{};
    std::optional<Saving> against_threshold{};
    Offer greatest_j_mu;  ///< what can be had at all
    Offer min_distance;
};

/// Throws std::invalid_argument for a tariff, bounds or a number of resamples (1 to 1e6) that cannot be, and for a sweep of fewer than
/// two references or with stops missing.
[[nodiscard]] Trade traded(const StopsTable& sweep, const TradeOptions& options);

[[nodiscard]] std::string to_json(const Trade& trade, const StopsTable& sweep, const TradeOptions& options);
/// The answer in words and figures.
[[nodiscard]] std::string to_text(const Trade& trade, const TradeOptions& options);
/// J_mu and distance over cost: the references, what is within the bounds, the best, 0.24 and the threshold law.
void draw_trade(const Trade& trade, const TradeOptions& options, const std::filesystem::path& png);

}  // namespace sweep
