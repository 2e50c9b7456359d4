/// Signals of a maneuver over time for the page's plots.
#pragma once

#include <array>
#include <string>

#include "rig_bridge/panel/live_feed.hpp"

namespace rig::panel {

class Curves {
  public:
    /// `sample`: time since brake-on.
    void add(const LiveSample& sample);
    [[nodiscard]] bool empty() const { return time_.empty(); }
    /// {"t":[...],"rim":[...],...} in the channels' units, without channels that have no known value.
    [[nodiscard]] std::string json() const;

  private:
    std::string time_;
    std::array<std::string, kSignals> text_;
    std::array<bool, kSignals> known_{};
};

}  // namespace rig::panel
