/// The panel of a served rig: the truth behind its gauges, and what its machines and its PLC say. Constructed ahead of real time.
#pragma once

#include <mutex>
#include <optional>
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

    /// From the rig's loop, each period: copies numbers; does not wait, and leaves the text to the server's thread.
    void show(const plc::ServedRig& rig, const ServeState& state);
    [[nodiscard]] std::string greeting() const { return server_.greeting(); }
    [[nodiscard]] int port() const { return server_.port(); }

    /// What is told in words.
    struct Facts {
        double time_s = 0.0;
        plc::Trip trip = plc::Trip::none;
        bool controller_heard = false, wheel_on_rim = false;
        std::uint32_t touchdowns = 0;
        double energy_J = 0.0, mean_friction = 0.0;
        std::uint64_t late = 0;   ///< periods
        unsigned interlocks = 0;  ///< bit i is rig::Interlock i, 1 good
    };

  private:
    [[nodiscard]] std::optional<std::string> states();

    rig::panel::LiveFeed feed_;
    double next_s_ = 0.0;  // when facts are due
    std::mutex mutex_;     // over the next
    std::optional<Facts> facts_;
    rig::panel::Server server_;
};

}  // namespace plant_sim
