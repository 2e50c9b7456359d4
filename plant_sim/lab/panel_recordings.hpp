/// Recorded maneuvers of a campaign's folder, as the panel asks for them: all texts are JSON.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "firmware/can/layout.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace plant_sim::lab {

class PanelRecordings {
  public:
    /// `folder` has campaign.sqlite. Throws settings::Error when it has none.
    PanelRecordings(std::filesystem::path folder, std::filesystem::path config, const antiskid::can::Layout& layout);

    /// Every attempt of every campaign: {"runs":[{campaign, number, attempt, state, configuration, figures, notes, ...}]}.
    [[nodiscard]] std::string runs() const;
    /// {"columns":{...}} out of its bus log. Throws where there is no such attempt or no log of it.
    [[nodiscard]] std::string run(const std::string& campaign, std::int64_t number, std::int64_t attempt) const;
    /// Into the ledger. Throws record::LedgerError where a bridge has it, std::invalid_argument for a text that is none.
    [[nodiscard]] std::string note(const std::string& campaign, std::int64_t number, std::int64_t attempt, const std::string& who,
                                   const std::string& text) const;

  private:
    [[nodiscard]] std::filesystem::path ledger() const { return folder_ / "campaign.sqlite"; }

    std::filesystem::path folder_, config_;
    antiskid::can::Layout layout_;
};

}  // namespace plant_sim::lab
