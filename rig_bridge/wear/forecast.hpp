/// Landings left until the brake's mean friction is below a limit, as a distribution.
///
/// What crosses is the brake's mean friction, without the scatter of single maneuvers: the first landing after which it is below the limit.
/// The forecast draws a hypothesis of brake_filter.hpp by its weight, its offset, and landings with their energies from the mix, until that
/// happens or the horizon is reached. Pure: the seed is handed in.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/wear/brake_filter.hpp"

namespace wear {

/// Landings to come: each is one of these kinds, drawn by its share.
struct LandingKind {
    std::string name;
    double share = 1.0;     ///< of all landings, in (0, 1]
    double energy_J = 0.0;  ///< brake energy of one, mean, > 0
    double deviation_J = 0.0;
};
using LandingMix = std::vector<LandingKind>;

/// One kind: the mean and deviation of the energies that the campaign's own maneuvers took, of the newest `count`.
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
    double crossed_ever = 0.0;  ///< within the horizon, now included
    /// Landings from now on; 0: already below; none: beyond the horizon.
    std::array<std::optional<int>, 3> landings_left{};
    /// The c_e at which that happens, likewise.
    std::array<std::optional<double>, 3> crossing_J{};
    std::vector<double> landings;    ///< of every draw, rising; infinite: beyond the horizon
    std::vector<double> energies_J;  ///< the c_e at which that happens, likewise
    double alike = 1.0;              ///< probability that the brake is of the population's kind, where that was asked
    double extrapolated = 0.0;       ///< share of the draws that had to go beyond the member's data before they crossed or ended
    std::vector<FanPoint> fan;       ///< from now to a little beyond the 90 % crossing (or the horizon)

    [[nodiscard]] bool already_crossed() const { return crossed_now >= 0.5; }
    [[nodiscard]] bool never_crosses() const { return crossed_ever < 0.5; }  ///< within the horizon, more likely than not
};

/// Sets the quantiles of `f` to those of its draws.
void take_quantiles(Forecast& f);

/// Continuous ranked probability score of equally probable values, rising, for the truth `x`: E|X - x| - E|X - X'| / 2.
[[nodiscard]] double crps(const std::vector<double>& rising, double x);

/// `filter` has learnt the brake's points up to `c_e_J`. Throws std::invalid_argument for settings or a mix out of range.
[[nodiscard]] Forecast forecast(const BrakeFilter& filter, double c_e_J, const LandingMix& mix, const ForecastSettings& settings);

}  // namespace wear
