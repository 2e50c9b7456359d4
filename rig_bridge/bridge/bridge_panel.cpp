#include "rig_bridge/bridge/bridge_panel.hpp"

#include <fmt/core.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "firmware/host/settings/json.hpp"
#include "rig_bridge/bridge/hold.hpp"
#include "rig_bridge/bridge/panel_state.hpp"
#include "rig_bridge/bridge/wall_clock.hpp"
#include "rig_bridge/record/specimen.hpp"

namespace rig::bridge {

namespace {

std::string said(const std::string& text) {
    return settings::Json{{"said", text}}.dump(-1, ' ', false, settings::Json::error_handler_t::replace);
}

std::string pause(const std::filesystem::path& campaign, const std::string& why) {
    record::check_text("why", why);
    if (!read_hold(campaign)) write_hold(campaign, {.who = "panel", .since = iso_8601(std::chrono::system_clock::now()), .why = why});
    return said(to_text(*read_hold(campaign)) + "; a maneuver that runs comes to its end first");
}

panel::ServerOptions options_of(const BridgeSetup& setup, const std::filesystem::path& campaign, const PanelRecordings* recordings,
                                antiskid::host::StopSignals& stops) {
    // Nobody builds a rig of steel on a virtual interface, and only a virtual rig waits for the bus's SYNC.
    const bool simulated = setup.options.lockstep || setup.options.interface.starts_with("vcan");
    panel::ServerOptions options{.address = panel::parse_address(setup.options.panel),
                                 .about = {.title = "rig-bridge: " + setup.scenario.title,
                                           .simulated = simulated,
                                           .views = {"live"},
                                           .emergency_stop = "It is at the rig: the red button, and the guard's and hydraulics' own cut-off."}};
    options.changes["abort"] = [&stops](const panel::Query&) {
        if (!stops.ask_first(SIGINT)) throw std::runtime_error("the bridge ends already");
        return said("the maneuver is brought to its safe end, then the bridge ends; the same command goes on with a campaign");
    };
    if (recordings == nullptr) return options;
    add_recorded(options, *recordings);
    options.changes["hold"] = [campaign](const panel::Query& query) { return pause(campaign, query.text("why")); };
    options.changes["resume"] = [campaign](const panel::Query&) { return said(remove_hold(campaign) ? "the campaign goes on" : "it was not held"); };
    return options;
}

}  // namespace

BridgePanel::BridgePanel(const BridgeSetup& setup, const std::filesystem::path& campaign, antiskid::host::StopSignals& stops, Terminal& terminal)
    : campaign_(campaign),
      recordings_(campaign.empty() ? nullptr : std::make_unique<const PanelRecordings>(campaign, setup.options.config, setup.layout, setup.scenario)),
      server_(options_of(setup, campaign, recordings_.get(), stops), &feed_) {
    terminal.say("rig-bridge: " + server_.greeting());
}

void BridgePanel::state(const ViewModel& view, const Moment& moment, double now_s) {
    feed_.state(
        [this, view, moment] { return panel_state(view, moment, campaign_.empty() ? std::nullopt : std::optional(hold_status(campaign_, begun_))); },
        now_s);
}

}  // namespace rig::bridge
