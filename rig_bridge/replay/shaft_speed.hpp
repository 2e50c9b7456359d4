/// Speed of a shaft from its sensor's frames, for both kinds of sensor.
#pragma once

#include <numbers>

#include "firmware/control/types.hpp"
#include "rig_bridge/record/edge_track.hpp"

namespace rig::replay {

class ShaftSpeed {
  public:
    explicit ShaftSpeed(double teeth) : track_(2.0 * std::numbers::pi / teeth) {}

    /// rad/s. Call once per sample, which ended at `now_s`. From edges it is the mean over the newest 5 ms and lags by half of that.
    [[nodiscard]] double at(const antiskid::control::SpeedInput& input, double now_s) {
        if (input.source == antiskid::control::SpeedSource::speed) return static_cast<double>(input.speed_radps);
        // A report passed twice would look like a shaft without a new edge.
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
