/// Forecast of the landings left, from a campaign's maneuvers and a wear model, as text for the panel.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/record/ledger.hpp"

namespace rig::bridge {

/// "132 (90 to 181, 10 to 90 %) to mean friction 0.25, by brakes measured on rig 7, 40 lives", as `rig-lab wear forecast` has it.
/// `rows`: of a campaign, oldest first; used is what replay::wear_of() makes of them. Returns an empty text without a limit or with fewer than two
/// maneuvers. Throws settings::Error for an unreadable model.
[[nodiscard]] std::string landings_left(const std::filesystem::path& model, const std::vector<record::LedgerRow>& rows, double min_friction);

}  // namespace rig::bridge
