/// Checks by the measured figures whether a finished maneuver was the requested one: a stop with another load or length is not a point of the
/// campaign.
///
///     const auto bands = rig::acceptance(scenario, plan);
///     if (!bands.empty()) summary.out_of_tolerance = rig::out_of_tolerance(bands, summary.figures);
///
/// In a scenario with scatter, the deviation from the drawn maneuver may be three standard deviations of that scatter: checked are speed at brake-on
/// and, under a constant load, the mean load; under the deceleration law also duration v / a and length v^2 / 2a, with propagated deviations.
/// [acceptance] in the scenario file replaces or adds bands for any figure by its key in summary.json; without scatter it is the only source. Without
/// bands nothing is checked.
#pragma once

#include <string>
#include <vector>

#include "rig_bridge/rig/scenario.hpp"

namespace rig {

[[nodiscard]] std::vector<Band> acceptance(const Scenario& scenario, const rig::Plan& plan);

/// Keys of the figures that are outside their band or NaN; empty: within tolerance.
[[nodiscard]] std::vector<std::string> out_of_tolerance(const std::vector<Band>& bands, const record::Figures& figures);
/// The same for people: "length 652 m (449 to 479)"; empty if none is outside.
[[nodiscard]] std::string what_is_outside(const std::vector<Band>& bands, const record::Figures& figures);

}  // namespace rig
