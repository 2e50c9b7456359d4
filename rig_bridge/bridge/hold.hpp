/// A campaign that its operator holds between two maneuvers: a file beside the ledger, which outlives the bridge, needs no bridge to be there,
/// and tells who, since when and why.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace rig::bridge {

struct Hold {
    std::string who;
    std::string since;  ///< wall clock, ISO 8601 UTC
    std::string why;    ///< may be empty
};

[[nodiscard]] inline std::filesystem::path hold_file(const std::filesystem::path& campaign) {
    return campaign / "campaign.hold";
}

/// None: it may go on. A file that cannot be read or understood holds it, too: somebody made it.
[[nodiscard]] std::optional<Hold> read_hold(const std::filesystem::path& campaign);
/// Whole or not there. Throws settings::Error.
void write_hold(const std::filesystem::path& campaign, const Hold& hold);
/// False: it was not held. Throws std::filesystem::filesystem_error.
bool remove_hold(const std::filesystem::path& campaign);

/// What a person may ask of a campaign now. `waits`: held, and none of its maneuvers was begun yet.
enum class HoldStatus : std::uint8_t { runs, waits, held };
[[nodiscard]] std::string_view name(HoldStatus status);
/// `begun`: a maneuver of the campaign was. A maneuver that runs while the campaign is held comes to its end first.
[[nodiscard]] HoldStatus hold_status(const std::filesystem::path& campaign, bool begun);

/// "held by A. Rossi since 2026-11-25T10:00:00Z: tyre change".
[[nodiscard]] std::string to_text(const Hold& hold);

}  // namespace rig::bridge
