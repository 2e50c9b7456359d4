/// Where a regulated pair of brake and tyre is heading: whether both limits can be met at the planned landing, and what happens if not. Pure.
///
/// The energy of the landings to come has mean E = n W and standard deviation sigma sqrt(n). Shares within the reach of the allowed
/// references decide how it is divided, nothing decides how much it is.
#pragma once

#include <string>

#include "rig_bridge/wear/regulator.hpp"

namespace wear {

enum class Feasibility : std::uint8_t {
    together,     ///< both at the planned landing, within the tolerance
    early,        ///< together, but the landings bring more than is left: before the planned one
    late,         ///< together, but they bring less: after it
    brake_first,  ///< even the highest reference leaves the brake too much
    tyre_first,   ///< even the lowest reference leaves the tyre too much
    reached,      ///< nothing is left to one of them
};
[[nodiscard]] const char* name(Feasibility verdict);

/// A landing as it is expected, counted from the plan's begin, with standard deviation.
struct When {
    double landing = 0.0;
    double deviation = 0.0;
};

struct LimitForecast {
    Feasibility verdict = Feasibility::together;
    double required_share = 0.0;              ///< of the tyre, of what is to come
    double min_share = 0.0, max_share = 0.0;  ///< that the allowed references give
    double brought = 0.0;                     ///< E over T + B: 1 where the planned landings bring just what is left; above 1 too much
    When brake, tyre;                         ///< when each limit is reached
    /// That the landings to come bring what is left within the plan's tolerance, from their scatter alone (normal); 0 where the share is out of
    /// reach.
    double probability = 0.0;
};

[[nodiscard]] LimitForecast limit_forecast(const Regulator& regulator);

/// One plain sentence for people.
[[nodiscard]] std::string sentence(const LimitForecast& limits, const WearPlan& plan);

}  // namespace wear
