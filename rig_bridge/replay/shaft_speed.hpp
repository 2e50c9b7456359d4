/// The speed of a shaft from what its sensor said on the bus, of either kind.
#pragma once

#include <numbers>

#include "firmware/control/types.hpp"
#include "rig_bridge/record/edge_track.hpp"

namespace rig::replay {

class ShaftSpeed {
  public:
    explicit ShaftSpeed(double teeth) : track_(2.0 * std::numbers::pi / teeth) {}

    /// rad/s. Once a sample, which ended at `now_s`. Of edges over the newest 5 ms: it lags behind the shaft by half of that.
    [[nodiscard]] double at(const antiskid::control::SpeedInput& input, double now_s) {
        if (input.source == antiskid::control::SpeedSource::speed) return static_cast<double>(input.speed_radps);
        // One report seen twice would be a shaft that had no edge meanwhile.
        if (input.received != taken_) track_.update(input.edge_count, input.edge_time, now_s);
        taken_ = input.received;
        constexpr double kWindow_s = 5e-3;
        return track_.speed(kWindow_s);
    }

  private:
    record::EdgeTrack track_;
    antiskid::control::Time taken_ = antiskid::control::kNever;
};

}  // namespace rig::replay
