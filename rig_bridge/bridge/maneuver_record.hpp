/// Makes the summary of a maneuver, completed or left by a bridge that died, and enters it into summary.json and ledger.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "firmware/host/settings/storage.hpp"
#include "rig_bridge/bridge/bridge_setup.hpp"
#include "rig_bridge/bridge/recording.hpp"
#include "rig_bridge/bridge/view.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig::bridge {

/// One maneuver to run.
struct ManeuverRequest {
    rig::Plan plan;
    std::string campaign;  ///< empty: a single maneuver
    std::int64_t number = 1;
    std::filesystem::path folder;
    record::Specimen specimen;
    double taken_J = 0.0;  ///< brake energy of the campaign before this maneuver
    std::optional<CampaignView> view;
};

/// Summary of a completed sequence. `whole`: its record is complete; otherwise the outcome is record::kRecordLost.
[[nodiscard]] record::Summary summary_of(const BridgeSetup& setup, const ManeuverRequest& request, const rig::Sequencer& sequencer,
                                         const std::string& started, const Recording& recording, bool whole);

/// Summary of an attempt left by a bridge that died, from its bus log; none if the log has no braking. Throws as replay::meter_log().
[[nodiscard]] std::optional<record::Summary> summary_of_left(const BridgeSetup& setup, const record::Attempt& left, const std::filesystem::path& log);

/// Writes summary.json, then the ledger: if the bridge dies in between, the next one enters the file. An incomplete record is entered as unfinished,
/// without summary.json. Throws settings::Error or record::LedgerError.
void enter(record::Ledger& ledger, const std::filesystem::path& folder, const record::Summary& summary,
           const settings::Storage& storage = settings::PosixStorage{});

}  // namespace rig::bridge
