/// Stops requested from the panel: one maneuver in process for each position of its sliders.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "rig_bridge/panel/about.hpp"
#include "rig_bridge/panel/server.hpp"

namespace plant_sim::lab {

class PanelStops {
  public:
    explicit PanelStops(std::filesystem::path config);

    /// The inputs that can be chosen.
    [[nodiscard]] const std::vector<rig::panel::Field>& fields() const { return fields_; }
    /// Runs a stop and returns {"figures":{...},"columns":{...}}. One at a time: throws panel::Busy while another runs, std::invalid_argument for a
    /// value that the fields do not allow.
    [[nodiscard]] std::string stop(const rig::panel::Query& query);

  private:
    std::filesystem::path config_;
    std::vector<rig::panel::Field> fields_;
    std::mutex running_;
};

}  // namespace plant_sim::lab
