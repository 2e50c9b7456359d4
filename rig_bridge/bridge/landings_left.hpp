/// What a campaign's own maneuvers and a wear model say about the landings that are left, for the panel.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/record/ledger.hpp"

namespace rig::bridge {

/// "132 (90 to 181, 10 to 90 %) to mean friction 0.25, by brakes measured on rig 7, 40 lives", as `rig-lab wear forecast` has it.
/// `rows`: of one brake, oldest first; maneuvers that did not finish or were off their conditions count by their energy alone.
/// Empty: no limit, or fewer than two maneuvers. Throws settings::Error for a model that cannot be read.
[[nodiscard]] std::string landings_left(const std::filesystem::path& model, const std::vector<record::LedgerRow>& rows, double min_friction);

}  // namespace rig::bridge
