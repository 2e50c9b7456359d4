/// Reads the optional tables [tyre] and [leg] of the rig's file: compliance between wheel rim, road and airframe. Keys and ranges:
/// config/landing_gear.toml.
#pragma once

#include "firmware/host/settings/settings.hpp"
#include "rig_bridge/rig/compliance.hpp"

namespace rig {

/// Dynamics of the tyre's force; without [tyre] it follows slip at once, as in the paper. Throws settings::Error, as load_leg().
[[nodiscard]] Compliance load_tyre(const settings::Table& root);

/// Without [leg] rigid. `mass_kg`: mass on the wheel, including the leg's.
[[nodiscard]] LegParameters load_leg(const settings::Table& root, double mass_kg);

}  // namespace rig
