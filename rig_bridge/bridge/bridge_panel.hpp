/// The panel of a bridge at work: what the main loop hands over, and what a person with the token may ask for. Constructed ahead of real time.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>

#include "firmware/host/stop_signals.hpp"
#include "rig_bridge/bridge/bridge_setup.hpp"
#include "rig_bridge/bridge/node.hpp"
#include "rig_bridge/bridge/panel_recordings.hpp"
#include "rig_bridge/bridge/terminal.hpp"
#include "rig_bridge/bridge/view.hpp"
#include "rig_bridge/panel/live_feed.hpp"
#include "rig_bridge/panel/server.hpp"

namespace rig::bridge {

class BridgePanel {
  public:
    /// `campaign`: the folder with its ledger, that a pause is written to and recorded maneuvers are read from; empty: a single maneuver. An
    /// abort is what the first Ctrl-C is. All must outlive the panel. Throws std::runtime_error where its address is not to be had.
    BridgePanel(const BridgeSetup& setup, const std::filesystem::path& campaign, antiskid::host::StopSignals& stops, Terminal& terminal);

    [[nodiscard]] panel::LiveFeed& feed() { return feed_; }
    /// A maneuver of the campaign was begun, now or in an earlier session: what lets it go on is no start any more.
    void begun() { begun_ = true; }
    /// To the feed. Whether the campaign is held is read from the disk when the server asks, in its thread.
    void state(const ViewModel& view, const Moment& moment, double now_s);

  private:
    panel::LiveFeed feed_;
    std::filesystem::path campaign_;
    std::unique_ptr<const PanelRecordings> recordings_;  // none: a single maneuver
    std::atomic<bool> begun_{false};                     // before server_, which asks for it
    panel::Server server_;
};

}  // namespace rig::bridge
