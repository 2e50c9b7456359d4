/// How far a ledger's campaigns are, for people and as JSON.
#pragma once

#include <filesystem>
#include <string>

namespace rig::bridge {

/// Both read the ledger without disturbing a bridge that writes it; throw settings::Error. A maneuver that is `running` in the ledger, while
/// nobody holds it, is `left`.
[[nodiscard]] std::string status_text(const std::filesystem::path& ledger);
[[nodiscard]] std::string status_json(const std::filesystem::path& ledger);

}  // namespace rig::bridge
