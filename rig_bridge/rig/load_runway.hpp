/// A runway from a TOML file:
///
///     [[patch]]
///     from_m = 0.0                # from touchdown; the first begins at 0, the others further on, up to 20000
///     surface = "dry_asphalt"     # a table of surfaces.toml
///
///     [[patch]]
///     from_m = 300.0
///     wet = { tyre_pressure_psi = 120.0, texture = "smooth", flooded = true }
///
/// A patch has `surface` or `wet`, never both. Keys of `wet`: tyre_pressure_psi (50 to 300), texture (smooth, grooved); optional
/// `curve` (the table of surfaces.toml whose curve over slip is scaled, default wet_asphalt), `peak_slip` (0.02 to 0.5, default the
/// curve's own: its slip is stretched), `flooded` and with it `flooded_mu` (friction left above the hydroplaning speed, 0 to 0.1,
/// default 0.05). See wet_grip.hpp for the laws.
#pragma once

#include <filesystem>
#include <vector>

#include "rig_bridge/rig/runway.hpp"

namespace rig {

/// `surfaces`: those that the file may name. Throws settings::Error naming file, line and key.
[[nodiscard]] Runway load_runway(const std::filesystem::path& file, const std::vector<Surface>& surfaces);

}  // namespace rig
