/// The edges that a toothed encoder would have given for a recorded speed.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/can/rig_sample.hpp"

namespace rig::replay {

class VirtualEncoder {
  public:
    explicit VirtualEncoder(double teeth) : edges_per_rad_(teeth / (2.0 * std::numbers::pi)) {}

    /// The speed goes linearly to `speed_radps` within `step_s`, which ends at `now_s`; negative speeds count as rest.
    void advance(double speed_radps, double now_s, double step_s) {
        const double before = speed_radps_;
        speed_radps_ = std::max(speed_radps, 0.0);
        const double from = edges_;
        edges_ += 0.5 * (before + speed_radps_) * step_s * edges_per_rad_;
        const double last = std::floor(edges_);
        if (last <= std::floor(from)) return;
        // The way from `from` to the last edge, x = v0 t + a t^2 / 2.
        const double way = (last - from) / edges_per_rad_;
        const double rate = (speed_radps_ - before) / step_s;
        const double root = std::sqrt(std::max(before * before + 2.0 * rate * way, 0.0));
        edge_s_ = now_s - step_s + (before + root > 0.0 ? 2.0 * way / (before + root) : step_s);
    }

    [[nodiscard]] antiskid::can::SpeedSample sample() const {
        return {.edge_count = static_cast<std::uint32_t>(static_cast<std::uint64_t>(edges_)),
                .edge_time = antiskid::control::Time{std::llround(edge_s_ * 1e9)},
                .speed_radps = static_cast<float>(speed_radps_)};
    }

  private:
    double edges_per_rad_;
    double edges_ = 0.0;
    double edge_s_ = 0.0;
    double speed_radps_ = 0.0;
};

}  // namespace rig::replay
