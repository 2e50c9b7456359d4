/// Progress of a ledger's campaigns, for people and as JSON.
#pragma once

#include <filesystem>
#include <string>

namespace rig::bridge {

/// Both read the ledger without disturbing a bridge that writes it; they throw settings::Error. A maneuver `running` in a ledger that no process
/// holds is shown as `left`.
[[nodiscard]] std::string status_text(const std::filesystem::path& ledger);
[[nodiscard]] std::string status_json(const std::filesystem::path& ledger);

}  // namespace rig::bridge
