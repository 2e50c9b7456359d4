/// Landings left until the brake's mean friction is below a limit, as a distribution.
///
/// The event is the first landing after which the mean friction, without the scatter of single maneuvers, is below the limit. Each draw takes a
/// hypothesis of brake_filter.hpp by its weight, an offset, and landings with energies from the mix, until the event or the horizon. Pure: the seed
/// is passed in.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/wear/brake_filter.hpp"

namespace wear {

/// A kind of future landing, drawn with probability `share`.
struct LandingKind {
    std::string name;
    double share = 1.0;     ///< of all landings, in (0, 1]
    double energy_J = 0.0;  ///< brake energy of one, mean, > 0
    double deviation_J = 0.0;
};
using LandingMix = std::vector<LandingKind>;

/// A mix of one kind, with mean and deviation of the energies of the newest `count` of the campaign's landings after its first point, those that are
/// no points included.
[[nodiscard]] LandingMix mix_of(const Campaign& campaign, std::size_t count);

struct ForecastSettings {
    double limit = 0.0;  ///< friction
    int horizon = 5000;  ///< landings
    int draws = 2000;    ///< at least 100
    std::uint64_t seed = 1;
    int fan_points = 60;  ///< of Forecast::fan
};

/// 10, 50 and 90 %.
using Quantiles = std::array<double, 3>;

struct FanPoint {
    double landings = 0.0;
    double c_e_J = 0.0;    ///< mean over the draws
    Quantiles friction{};  ///< mean friction of the brake
};

struct Forecast {
    double c_e_J = 0.0;         ///< now
    Quantiles friction_now{};   ///< mean friction of the brake, without the newest maneuver's scatter
    double crossed_now = 0.0;   ///< probability that it is below the limit already
    double crossed_ever = 0.0;  ///< probability within the horizon, including now
    /// Landings left; 0: already below; none: beyond the horizon.
    std::array<std::optional<int>, 3> landings_left{};
    /// c_e at the crossing; none: beyond the horizon.
    std::array<std::optional<double>, 3> crossing_J{};
    std::vector<double> landings;         ///< of every draw, ascending; infinite: beyond the horizon
    std::vector<double> energies_J;       ///< c_e at the crossing, of every draw, ascending
    double population_probability = 1.0;  ///< probability that the brake is like the population; 1 if not evaluated
    double extrapolated = 0.0;            ///< share of the draws that left the member's data before they crossed or ended
    std::vector<FanPoint> fan;            ///< from now to a little beyond the 90 % crossing (or the horizon)

    [[nodiscard]] bool already_crossed() const { return crossed_now >= 0.5; }
    [[nodiscard]] bool never_crosses() const { return crossed_ever < 0.5; }  ///< whether a crossing within the horizon is less likely than not
};

/// Landings of the mix until `end_J` is taken, from `c_e_J`; infinite: more than `horizon`.
[[nodiscard]] double landings_until(double end_J, double c_e_J, const LandingMix& mix, int horizon, Generator& generator);

/// Sets the quantiles of `f` to those of its draws.
void take_quantiles(Forecast& f);

/// Continuous ranked probability score of equally probable values, ascending, for the true value `x`: E|X - x| - E|X - X'| / 2.
[[nodiscard]] double crps(const std::vector<double>& rising, double x);

/// `filter` has learnt the brake's points up to `c_e_J`. Throws std::invalid_argument for settings or a mix out of range.
[[nodiscard]] Forecast forecast(const BrakeFilter& filter, double c_e_J, const LandingMix& mix, const ForecastSettings& settings);

}  // namespace wear
