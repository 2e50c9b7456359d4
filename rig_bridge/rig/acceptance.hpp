/// Whether a finished maneuver was the one that was asked for, by its measured figures: a stop of another load or length is a stop, but no
/// point of the campaign.
///
///     const auto bands = rig::acceptance(scenario, plan);
///     if (!bands.empty()) summary.out_of_tolerance = rig::out_of_tolerance(bands, summary.figures);
///
/// A scenario that scatters is held to its own scatter: what the rig adds to the maneuver that was drawn may be three standard deviations, or
/// the campaign's scatter would be the rig's. Speed at brake-on and, under a constant load, the mean load directly; under the deceleration law
/// duration v / a and length v^2 / 2a by what follows for them. [acceptance] of the scenario file sets the bands of any figure by its key in
/// summary.json, instead of these or beside them; it must where nothing scatters. No band: nothing is judged.
#pragma once

#include <string>
#include <vector>

#include "rig_bridge/rig/scenario.hpp"

namespace rig {

[[nodiscard]] std::vector<Band> acceptance(const Scenario& scenario, const rig::Plan& plan);

/// The keys of the figures that lie outside, or are no number; empty: within tolerance.
[[nodiscard]] std::vector<std::string> out_of_tolerance(const std::vector<Band>& bands, const record::Figures& figures);
/// The same for people: "length 652 m (449 to 479)"; empty where none lies outside.
[[nodiscard]] std::string what_is_outside(const std::vector<Band>& bands, const record::Figures& figures);

}  // namespace rig
