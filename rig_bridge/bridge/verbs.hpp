/// The verbs of rig-bridge; each returns the exit status and throws on errors.
#pragma once

#include <stdexcept>

#include "rig_bridge/bridge/options.hpp"

namespace rig::bridge {

[[nodiscard]] int run_maneuver(const ManeuverCommand& command);
[[nodiscard]] int run_campaign(const CampaignCommand& command);
[[nodiscard]] int show_status(const StatusCommand& command);
[[nodiscard]] int amend_ledger(const AmendCommand& command);
[[nodiscard]] int note_in_ledger(const NoteCommand& command);
[[nodiscard]] int change_hold(const HoldCommand& command);
[[nodiscard]] int watch_rig(const WatchCommand& command);
[[nodiscard]] int run_preflight(const PreflightCommand& command);

/// Error in a file or on the command line: exit status 2.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace rig::bridge
