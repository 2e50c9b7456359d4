/// The recorded maneuvers of a folder for the panel. All returned texts are JSON.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "rig_bridge/panel/server.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace rig::bridge {

class PanelRecordings {
  public:
    /// `folder` holds a campaign's campaign.sqlite. Without one, its maneuvers are the folders with a summary.json, in `folder` itself and two levels
    /// below, as `rig-bridge maneuver`, `rig-lab maneuver` and `rig-replay import` write them. Throws settings::Error if it has neither. Scenarios
    /// are read from `config`, except `known`.
    PanelRecordings(const std::filesystem::path& folder, std::filesystem::path config, const antiskid::can::Layout& layout,
                    std::optional<Scenario> known = {});

    /// Whether there is a ledger, so that notes can be kept.
    [[nodiscard]] bool with_ledger() const;
    /// Every attempt of every campaign: {"runs":[{campaign, number, attempt, state, configuration, figures, notes, ...}]}. Without a ledger
    /// `campaign` is the maneuver's folder and `number` its place in the list; the notes of one whose summary.json cannot be read say why.
    [[nodiscard]] std::string runs() const;
    /// {"columns":{...},"asked":{...}} out of its bus log: signals, and what the controller was told to do. One call at a time, to leave processor
    /// time to a recording bridge. Throws if there is no such attempt or no log of it.
    [[nodiscard]] std::string run(const std::string& campaign, std::int64_t number, std::int64_t attempt) const;
    /// Adds a note to the ledger. Throws record::LedgerError if there is none or a bridge holds it, std::invalid_argument for an invalid text.
    [[nodiscard]] std::string note(const std::string& campaign, std::int64_t number, std::int64_t attempt, const std::string& who,
                                   const std::string& text) const;

  private:
    struct Recorded {
        std::string campaign;
        record::LedgerRow row;
        std::string unreadable;  // why its summary.json cannot be read; then the row has but attempt and folder
    };
    [[nodiscard]] std::filesystem::path ledger() const { return folder_ / "campaign.sqlite"; }
    [[nodiscard]] std::vector<Recorded> all() const;
    [[nodiscard]] std::vector<Recorded> in_folders() const;

    std::filesystem::path folder_, config_;
    antiskid::can::Layout layout_;
    std::optional<Scenario> known_;
    mutable std::mutex reading_;
};

/// Adds the view "recorded" and its data. `recordings` must outlive the server.
void add_recorded(panel::ServerOptions& options, const PanelRecordings& recordings);

}  // namespace rig::bridge
