/// Variation of mu_b within a stop (the paper's Fig. 6, Section IV.A), learnt from recorded stops of one class of maneuver, as a polynomial in x = v
/// / v_brake_on relative to the stop's mean.
///
///     mu_b(x) = mean_s f(x),   f(x) = 1 + sum over k = 1..order of b_k (x^k - 1 / (k + 1))
///
/// f has the mean 1 over x in [0, 1] for any b_k, and also over the stop's time, since at constant deceleration time is proportional to speed. The
/// b_k are common to all stops; each stop has its own mean. Both are found by robust regression, with Huber's weights first, then Tukey's bisquare,
/// and the scale of the residuals from their median, so that spikes or a shifted torque cell do not move the curve.
///
/// Samples of one stop are correlated, so that order and intervals must not treat them as independent. With at least DynamicsSettings::min_stops
/// stops, whole stops are left out in turn, in at most kMaxGroups groups. With fewer, bands of x of each stop are left out, which assumes that
/// samples some tenths of a second apart are independent. The order is the smallest whose loss on the left-out samples is within one standard error
/// of the best order's. Intervals are jackknife intervals with Student's t.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "firmware/host/settings/error.hpp"

namespace wear {

struct BrakeSample {
    double time_s = 0.0;
    double speed_mps = 0.0;    ///< v
    double pressure_Pa = 0.0;  ///< above the brake's contact pressure
    double brake_torque_Nm = 0.0;
};

struct RecordedStop {
    std::string source;          ///< source file, for people
    double brake_on_mps = 0.0;   ///< v_brake_on > 0
    double brake_gain_m3 = 0.0;  ///< A_p N_p N_s R_eff of eq. (5) > 0
    std::vector<BrakeSample> samples;
};

struct DynamicsSettings {
    std::size_t highest_order = 3;  ///< highest tried, 0 to 3
    /// Samples with less pressure than this share of the stop's median are not used: they do not determine friction.
    double min_pressure_share = 0.25;
    double min_speed_mps = 5.0;      ///< drop-out speed: below it the wheel may stand, and a held disc shows no friction
    std::size_t min_stops = 4;       ///< least number for leaving out whole stops
    std::size_t max_samples = 1000;  ///< per stop; of more, every n-th is used
};

/// c0 + c1 x + c2 x^2 + c3 x^3.
using Curve = std::array<double, 4>;

struct OrderLoss {
    std::size_t order = 0;
    double loss = 0.0;          ///< mean bisquare loss, 0 to 1, of the left-out samples
    double excess_error = 0.0;  ///< standard error of the difference to the best order's loss
};

struct StopShape {
    std::string source;
    double brake_on_mps = 0.0;
    double mean_friction = 0.0;  ///< mean_s
    std::size_t samples = 0;     ///< number used
    double rejected = 0.0;       ///< share of them with weight 0
    bool used = true;            ///< false: more than half have weight 0, and the stop does not affect the curve
};

struct FrictionDynamics {
    std::size_t order = 0;
    Curve curve{};                      ///< f
    Curve half_width{};                 ///< half width of the 95 % intervals of `curve`
    std::array<Curve, 4> covariance{};  ///< of `curve`
    double quantile = 0.0;              ///< Student's t for 95 %: half_width = quantile * sqrt(covariance[k][k])
    double scale = 0.0;                 ///< robust relative standard deviation of the samples about the curve
    bool by_stops = true;               ///< whether whole stops were left out; otherwise bands of x
    std::size_t groups = 0;
    std::vector<OrderLoss> orders;
    std::vector<StopShape> stops;

    [[nodiscard]] double at(double x) const;
    /// Half width of the 95 % interval of f(x).
    [[nodiscard]] double half_width_at(double x) const;
};

inline constexpr std::size_t kMaxGroups = 20;

/// A sample for the regression: x, and mu_b = T_b / (gain P_b), eq. (7) for one sample.
struct FrictionSample {
    double x = 0.0;
    double mu_b = 0.0;
};

/// Usable samples of the stop. Throws settings::Error naming the stop, and the sample counted from 1, for invalid data: values that are not numbers,
/// negative pressure, decreasing times, no pressure, too few samples, speeds that cover less than half of the stop, friction outside 0.001 to 1.5
/// (wrong units).
[[nodiscard]] std::vector<FrictionSample> friction_samples(const RecordedStop& stop, const DynamicsSettings& settings);

/// Throws settings::Error as friction_samples() does, without any stop, and if the curve would not be positive.
[[nodiscard]] FrictionDynamics learn_dynamics(const std::vector<RecordedStop>& stops, const DynamicsSettings& settings);

}  // namespace wear
