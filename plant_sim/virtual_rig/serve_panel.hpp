/// The panel of a served rig: true values, and the states of machines and PLC. Construct it before real-time operation starts.
#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "plant_sim/plc/served_rig.hpp"
#include "plant_sim/virtual_rig/serve_node.hpp"
#include "rig_bridge/panel/live_feed.hpp"
#include "rig_bridge/panel/server.hpp"

namespace plant_sim {

class ServePanel {
  public:
    /// Throws std::runtime_error if `address` cannot be bound.
    ServePanel(const std::string& address, const std::string& scenario);

    /// Call in each period from the rig's loop. Copies numbers and does not wait; the server's thread makes the text.
    void show(const plc::ServedRig& rig, const ServeState& state);
    [[nodiscard]] std::string greeting() const { return server_.greeting(); }
    [[nodiscard]] int port() const { return server_.port(); }

    /// Values shown as text.
    struct Facts {
        double time_s = 0.0;
        plc::Trip trip = plc::Trip::none;
        bool controller_heard = false, wheel_on_rim = false;
        std::uint32_t touchdowns = 0;
        double energy_J = 0.0, mean_friction = 0.0;
        std::uint64_t late = 0;   ///< number of late periods
        unsigned interlocks = 0;  ///< bit i is rig::Interlock i, 1 good
    };

  private:
    [[nodiscard]] std::optional<std::string> states();

    rig::panel::LiveFeed feed_;
    double next_s_ = 0.0;  // when facts are due
    std::mutex mutex_;     // for facts_
    std::optional<Facts> facts_;
    rig::panel::Server server_;
};

}  // namespace plant_sim
