/// Cost of a fixed slip reference in wear of brake and tyre, and the cheapest reference whose braking is good enough.
///
/// Between the references of the sweep means are interpolated linearly, in steps of kStep. The uncertainty of the answer comes from the scatter of
/// the landings: they are resampled with replacement, the same landings for every reference and for the threshold law (a paired bootstrap), and the
/// answer is computed for each resample.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "plant_sim/study/sweep/stops_table.hpp"

namespace sweep {

/// Prices in any currency, >= 0. The cost of a landing is the sum.
struct Prices {
    double brake_per_MJ = 0.0;
    double tyre_per_MJ = 0.0;
};

/// Energy that a set of each can take, > 0. The cost of a landing is the share of its life that it takes from the part that wears out first; the
/// inverse is the number of landings until then.
struct Lives {
    double brake_MJ = 0.0;
    double tyre_MJ = 0.0;
};

using Tariff = std::variant<Prices, Lives>;

struct Bounds {
    std::optional<double> min_j_mu{};        ///< smallest allowed mean over the landings
    std::optional<double> max_distance_m{};  ///< largest allowed mean stop distance

    [[nodiscard]] bool allow(double j_mu, double stop_distance_m) const {
        return !(min_j_mu && j_mu < *min_j_mu) && !(max_distance_m && stop_distance_m > *max_distance_m);
    }
};

struct TradeOptions {
    Tariff tariff;
    Bounds bounds{};
    int resamples = 2000;
    std::uint64_t seed = 1;
};

/// Means over the landings at one reference.
struct ReferenceMeans {
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

/// Share of the other's cost that the best reference saves; negative if it costs more.
struct Saving {
    double share = 0.0;
    Interval interval;
};

/// The limit that keeps the best reference from a cheaper one.
enum class BindingLimit { nothing, min_j_mu, max_distance, end_of_references, no_cost };

struct Trade {
    static constexpr double kStep = 0.001;

    std::vector<ReferenceMeans> offers;    ///< one for every kStep of the reference
    std::optional<ReferenceMeans> best{};  ///< none: no reference is within the bounds
    Interval best_interval{};              ///< of its reference, over the resamples in which a reference is within the bounds
    double feasible_share = 0.0;           ///< share of these resamples
    BindingLimit decides = BindingLimit::nothing;
    std::optional<ReferenceMeans> paper{};      ///< at 0.24; none: outside of the sweep
    std::optional<ReferenceMeans> threshold{};  ///< the threshold law, with reference 0
    std::optional<Saving> against_paper{};
    std::optional<Saving> against_threshold{};
    ReferenceMeans greatest_j_mu;  ///< the reference with the greatest J_mu
    ReferenceMeans min_distance;
};

/// Throws std::invalid_argument for an invalid tariff, bounds or number of resamples (1 to 1e6), and for a sweep with fewer than two references or
/// with missing stops.
[[nodiscard]] Trade traded(const StopsTable& sweep, const TradeOptions& options);

[[nodiscard]] std::string to_json(const Trade& trade, const StopsTable& sweep, const TradeOptions& options);
/// The answer as text with figures.
[[nodiscard]] std::string to_text(const Trade& trade, const TradeOptions& options);
/// Picture of J_mu and distance over cost: all references, those within the bounds, the best, 0.24 and the threshold law.
void draw_trade(const Trade& trade, const TradeOptions& options, const std::filesystem::path& png);

}  // namespace sweep
