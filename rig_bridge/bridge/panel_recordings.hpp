/// Recorded maneuvers of a folder, as the panel asks for them: all texts are JSON.
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
    /// `folder` has campaign.sqlite, a campaign's. Without one its maneuvers are the folders with a summary.json, `folder` itself and two levels
    /// below it, as `rig-bridge maneuver`, `rig-lab maneuver` and `rig-replay import` leave them. Throws settings::Error when it has neither.
    /// Scenarios are those of `config`, and the one that is `known` by its name.
    PanelRecordings(const std::filesystem::path& folder, std::filesystem::path config, const antiskid::can::Layout& layout,
                    std::optional<Scenario> known = {});

    /// Whether notes can be kept.
    [[nodiscard]] bool with_ledger() const;
    /// Every attempt of every campaign: {"runs":[{campaign, number, attempt, state, configuration, figures, notes, ...}]}. Without a ledger
    /// `campaign` is the maneuver's folder and `number` its place in the list.
    [[nodiscard]] std::string runs() const;
    /// {"columns":{...},"asked":{...}} out of its bus log: signals, and what the controller was told to do. One at a time: who records needs the
    /// processor, too. Throws where there is no such attempt or no log of it.
    [[nodiscard]] std::string run(const std::string& campaign, std::int64_t number, std::int64_t attempt) const;
    /// Into the ledger. Throws record::LedgerError where there is none or a bridge has it, std::invalid_argument for a text that is none.
    [[nodiscard]] std::string note(const std::string& campaign, std::int64_t number, std::int64_t attempt, const std::string& who,
                                   const std::string& text) const;

  private:
    struct Recorded {
        std::string campaign;
        record::LedgerRow row;
    };
    [[nodiscard]] std::filesystem::path ledger() const { return folder_ / "campaign.sqlite"; }
    [[nodiscard]] std::vector<Recorded> all() const;
    [[nodiscard]] std::vector<Recorded> in_folders() const;

    std::filesystem::path folder_, config_;
    antiskid::can::Layout layout_;
    std::optional<Scenario> known_;
    mutable std::mutex reading_;
};

/// Adds the view "recorded" with what it reads. `recordings` must outlive the server.
void add_recorded(panel::ServerOptions& options, const PanelRecordings& recordings);

}  // namespace rig::bridge
