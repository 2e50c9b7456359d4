/// The first reading of a recording: can its units be right?
#pragma once

#include "rig_bridge/replay/importer.hpp"

namespace rig::replay {

/// The columns of `map`, time first, then the channels that it has.
[[nodiscard]] std::vector<std::string> wanted_columns(const ImportMap& map);
/// Those channels in the same order.
[[nodiscard]] std::vector<Channel> wanted_channels(const ImportMap& map);

/// Throws std::runtime_error naming column, values and likely unit.
void survey_units(const ImportSettings& settings, ImportNotes& notes);

}  // namespace rig::replay
