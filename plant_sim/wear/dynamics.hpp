/// How mu_b moves within a stop (the paper's Fig. 6, Section IV.A): learnt from recorded stops of one class of maneuver as a polynomial in
/// x = v / v_brake_on, relative to the stop's mean.
///
///     mu_b(x) = mean_s f(x),   f(x) = 1 + sum over k = 1..order of b_k (x^k - 1 / (k + 1))
///
/// so that f has the mean 1 over x in [0, 1] whatever the b_k: over the stop, since at constant deceleration time is proportional to speed.
/// All stops share the b_k, each has its own mean. Both are found by robust regression: Huber's weights first, then Tukey's bisquare, with
/// the scale of the residuals from their median, so that spikes and a slipped torque cell do not move the curve.
///
/// Samples of one stop are correlated, so neither order nor intervals may count them one by one. The unit is the stop: with at least
/// DynamicsSettings::min_stops of them, each is left out in turn (at most kMaxGroups groups of whole stops). With fewer, bands of x of
/// each stop are, which trusts that samples some tenths of a second apart are independent. The order is the least whose loss on what was
/// left out is within one standard error of the best order's; intervals are the jackknife's, by Student's t.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "firmware/host/settings/error.hpp"

namespace wear {

struct BrakeSample {
    double time_s = 0.0;
    double speed_mps = 0.0;  ///< v
    double pressure_Pa = 0.0;
    double brake_torque_Nm = 0.0;
};

struct RecordedStop {
    std::string source;          ///< where it was read, for people
    double brake_on_mps = 0.0;   ///< v_brake_on > 0
    double brake_gain_m3 = 0.0;  ///< A_p N_p N_s R_eff of eq. (5) > 0
    std::vector<BrakeSample> samples;
};

struct DynamicsSettings {
    std::size_t highest_order = 3;  ///< of those tried, 0 to 3
    /// Samples with less pressure than this share of the stop's median pressure say nothing about friction.
    double min_pressure_share = 0.25;
    double min_speed_mps = 5.0;      ///< drop-out: below it the wheel may stand, and a held disc shows no friction
    std::size_t min_stops = 4;       ///< for leaving out whole stops
    std::size_t max_samples = 1000;  ///< of one stop; of more, every n-th is used
};

/// c0 + c1 x + c2 x^2 + c3 x^3.
using Curve = std::array<double, 4>;

struct OrderLoss {
    std::size_t order = 0;
    double loss = 0.0;          ///< mean bisquare loss, 0 to 1, of what was left out
    double excess_error = 0.0;  ///< standard error of its difference from the best order's
};

struct StopShape {
    std::string source;
    double brake_on_mps = 0.0;
    double mean_friction = 0.0;  ///< mean_s
    std::size_t samples = 0;     ///< used
    double rejected = 0.0;       ///< share of them with no weight
    bool used = true;            ///< false: more than half have none; the stop has no say in the curve
};

struct FrictionDynamics {
    std::size_t order = 0;
    Curve curve{};                      ///< f
    Curve half_width{};                 ///< of the 95 % intervals of `curve`
    std::array<Curve, 4> covariance{};  ///< of `curve`
    double quantile = 0.0;              ///< Student's t for 95 %, half_width = quantile * sqrt(covariance[k][k])
    double scale = 0.0;                 ///< robust standard deviation of the samples about the curve, relative
    bool by_stops = true;               ///< what was left out: groups of whole stops, or bands of x
    std::size_t groups = 0;
    std::vector<OrderLoss> orders;
    std::vector<StopShape> stops;

    [[nodiscard]] double at(double x) const;
    /// Half width of the 95 % interval of f(x).
    [[nodiscard]] double half_width_at(double x) const;
};

inline constexpr std::size_t kMaxGroups = 20;

/// A sample as the regression takes it: x and mu_b = T_b / (gain P_b), eq. (7) sample by sample.
struct FrictionSample {
    double x = 0.0;
    double mu_b = 0.0;
};

/// Those of the stop that are meaningful. Throws settings::Error naming the stop, and the sample counted from 1, for what cannot be: values
/// that are no numbers, negative pressure, times that fall, no pressure, too few samples, speeds that cover less than half of the stop,
/// friction beyond 0.001 to 1.5 (units mixed up).
[[nodiscard]] std::vector<FrictionSample> friction_samples(const RecordedStop& stop, const DynamicsSettings& settings);

/// Throws settings::Error as friction_samples() does; without a stop; and where the curve would not stay positive.
[[nodiscard]] FrictionDynamics learn_dynamics(const std::vector<RecordedStop>& stops, const DynamicsSettings& settings);

}  // namespace wear
