/// Friction over the share of a brake's life as a Gaussian process, learnt from brakes that were worn out.
///
/// Maneuver i begins when the share u of the brake's life L (an energy) is taken. Its friction is
///
///     mu_i = curve(u) + sum over k of energy_k (e_(i-k) / e_mean - 1) + remembered + fresh
///
/// `curve` is piecewise linear between the knots; its values there are normal, with a mean that depends on log L and a covariance between them. The
/// second term is what the energies of the maneuvers before do (a hot brake, a glaze that a heavy stop breaks). `remembered` is autoregressive of
/// order 1, `fresh` is white. life_filter.hpp takes from it what a brake in use says of its own life.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "rig_bridge/wear/wear_campaign.hpp"

namespace wear {

/// Shares of life. Denser where friction changes fast: run-in and wear-out. Beyond the last one the curve goes on straight, and flat from 1.08 on.
inline constexpr std::array kLifeKnots{0.0, 0.02, 0.05, 0.1, 0.17, 0.3, 0.45, 0.6, 0.72, 0.82, 0.9, 0.96, 1.02};
inline constexpr std::size_t kCurve = kLifeKnots.size();
inline constexpr std::size_t kEnergiesBefore = 6;

/// Wear of the lining as it is read: slope u + error at the share u of life, since wear is linear in energy (Archard). Lives end by friction: `slope`
/// is how far the lining is worn by then. It is normal, and correlated with the curve of the same brake.
struct LiningWear {
    std::size_t lives = 0;                    ///< with at least two readings from a tenth of life on, at least five; 0: nothing is known
    double slope = 0.0;                       ///< mean
    double by_life = 0.0;                     ///< change of the mean for each standard deviation of log L
    std::array<double, kCurve> with_curve{};  ///< covariance with the curve at the knots
    double variance = 0.0;
    double error = 0.0;     ///< standard deviation of a reading
    double evidence = 1.0;  ///< exponent of the readings' likelihood, in (0, 1], as that of friction below: wear is not quite a line
    bool operator==(const LiningWear&) const = default;
};

struct LifeCurves {
    using Values = std::array<double, kCurve>;  ///< at the knots

    std::size_t lives = 0;   ///< learnt from; 0: nothing is known
    double limit = 0.0;      ///< friction at which a life ends; 0: where the campaign does
    double landing_J = 0.0;  ///< mean energy of a maneuver
    double log_life = 0.0;   ///< mean of log L, L in J
    double log_life_deviation = 0.0;
    Values mean{};
    Values by_life{};                              ///< change of the mean for each standard deviation of log L
    std::array<Values, kCurve> covariance{};       ///< between the knots
    std::array<double, kEnergiesBefore> energy{};  ///< friction for e_mean more, of the maneuver before, the one before that, ...
    double memory = 0.0;                           ///< correlation of the remembered part from one maneuver to the next, in [0, 1)
    double remembered = 0.0;                       ///< standard deviation
    double fresh = 0.0;                            ///< likewise, > 0
    /// Exponent of the likelihood, in (0, 1]: a curve learnt from few lives is not quite that of the next brake, and its errors add up over
    /// maneuvers.
    double evidence = 1.0;
    /// Of friction taken as a level that walks, seen through white noise, whatever the life: standard deviations of a step and of the noise.
    double walk = 0.0, noise = 0.0;
    LiningWear lining{};
    bool operator==(const LifeCurves&) const = default;
};

/// Energy after the maneuver with which the brake is worn out: the last one before friction stays below `limit`, by the greatest sum of what
/// friction is above it; the campaign's last where nothing but scatter is below, or without a limit.
[[nodiscard]] double end_of_life_J(const Campaign& campaign, double limit);

/// By expectation maximisation. `evidence`, of friction and of readings, is that with which lives left out of the learning are foretold best, by the
/// logarithmic score of log L at each tenth of life. `limit` 0: none. At least 3 campaigns that begin with a new brake, else std::invalid_argument.
[[nodiscard]] LifeCurves learn_life_curves(const std::vector<Campaign>& campaigns, double limit, unsigned threads = 1);

/// The knot before a share of life, and the weight of the next one.
struct KnotPlace {
    std::size_t knot = 0;
    double next = 0.0;
};
[[nodiscard]] KnotPlace knot_place(double share);

}  // namespace wear
