/// The optional tables [tyre] and [leg] of the rig's file: what gives way between the wheel's rim, the road and the airframe. Their keys
/// and ranges stand in config/landing_gear.toml.
#pragma once

#include "firmware/host/settings/settings.hpp"
#include "rig_bridge/rig/compliance.hpp"

namespace rig {

/// How the tyre's force follows its slip; without [tyre] at once, as the paper has it. Throws settings::Error, as load_leg().
[[nodiscard]] Compliance load_tyre(const settings::Table& root);

/// Without [leg] none. `mass_kg` is that on the wheel, of which the leg's is a part.
[[nodiscard]] LegParameters load_leg(const settings::Table& root, double mass_kg);

}  // namespace rig
