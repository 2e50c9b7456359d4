/// The panel of a served rig: the truth behind its gauges, and what its machines and its PLC say. Constructed ahead of real time.
#pragma once

#include <string>

#include "plant_sim/plc/served_rig.hpp"
#include "plant_sim/serve_node.hpp"
#include "rig_bridge/panel/live_feed.hpp"
#include "rig_bridge/panel/server.hpp"

namespace plant_sim {

class ServePanel {
  public:
    /// Throws std::runtime_error where `address` is not to be had.
    ServePanel(const std::string& address, const std::string& scenario);

    /// From the rig's loop, each period; does not wait.
    void show(const plc::ServedRig& rig, const ServeState& state);
    [[nodiscard]] std::string greeting() const { return server_.greeting(); }

  private:
    rig::panel::LiveFeed feed_;
    rig::panel::Server server_;
};

}  // namespace plant_sim
