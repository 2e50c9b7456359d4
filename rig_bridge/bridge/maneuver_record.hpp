/// What a maneuver leaves: its summary, whether it came to its end or a dead bridge left it, and the way of that into summary.json and ledger.
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
    std::string campaign;  ///< empty: a single one
    std::int64_t number = 1;
    std::filesystem::path folder;
    record::Specimen specimen;
    double taken_J = 0.0;  ///< brake energy of the campaign before it
    std::optional<CampaignView> view;
};

/// Of a sequence that is over. `whole`: nothing of its record is missing; else the outcome is record::kRecordLost.
[[nodiscard]] record::Summary summary_of(const BridgeSetup& setup, const ManeuverRequest& request, const rig::Sequencer& sequencer,
                                         const std::string& started, const Recording& recording, bool whole);

/// Of an attempt that a dead bridge left, from its bus log; none where there is no braking in it. Throws as replay::meter_log does.
[[nodiscard]] std::optional<record::Summary> summary_of_left(const BridgeSetup& setup, const record::Attempt& left, const std::filesystem::path& log);

/// Into summary.json, then into the ledger: a bridge that dies in between is taken up by the file. A record that is not whole is entered as
/// unfinished, without the file. Throws settings::Error or record::LedgerError.
void enter(record::Ledger& ledger, const std::filesystem::path& folder, const record::Summary& summary,
           const settings::Storage& storage = settings::PosixStorage{});

}  // namespace rig::bridge
