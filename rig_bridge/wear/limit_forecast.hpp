/// Forecast for a regulated pair of brake and tyre: whether both limits are reached at the planned landing, and otherwise which first. Pure.
///
/// The energy of the landings to come has mean E = n W and standard deviation sigma sqrt(n). The allowed references determine how it can be divided;
/// its amount cannot be influenced.
#pragma once

#include <string>

#include "rig_bridge/wear/regulator.hpp"

namespace wear {

enum class Feasibility : std::uint8_t {
    together,     ///< both at the planned landing, within the tolerance
    early,        ///< together, but before the planned landing: the landings bring more energy than is left
    late,         ///< together, but after it: they bring less
    brake_first,  ///< even with the highest reference the brake wears out first
    tyre_first,   ///< even with the lowest reference the tyre wears out first
    reached,      ///< one of them is worn out
};
[[nodiscard]] const char* name(Feasibility verdict);

/// Expected landing number, counted from the plan's beginning, with standard deviation.
struct When {
    double landing = 0.0;
    double deviation = 0.0;
};

struct LimitForecast {
    Feasibility verdict = Feasibility::together;
    double required_share = 0.0;              ///< share of the tyre in the energy to come
    double min_share = 0.0, max_share = 0.0;  ///< that the allowed references give
    double brought = 0.0;                     ///< E / (T + B): 1 if the planned landings bring just what is left, larger: more
    When brake, tyre;                         ///< when each limit is reached
    /// Probability that the landings to come bring what is left within the plan's tolerance, from their scatter alone (normal); 0 if the share cannot
    /// be reached.
    double probability = 0.0;
};

[[nodiscard]] LimitForecast limit_forecast(const Regulator& regulator);

/// One plain sentence for people.
[[nodiscard]] std::string sentence(const LimitForecast& limits, const WearPlan& plan);

}  // namespace wear
