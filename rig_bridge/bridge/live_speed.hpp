/// Speed of one shaft for view, picture and settling: mean between edges some milliseconds apart, by the sensor's clock, so that late frames have no
/// effect. Frames without a new edge lower it. While no frame is received it stays as it is, and the frame after such a pause does not lower it. The
/// figures of a maneuver come from the meter instead (rig_bridge/record/meter.hpp).
#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>

#include "firmware/control/types.hpp"
#include "firmware/host/seconds.hpp"

namespace rig::bridge {

class LiveSpeed {
  public:
    explicit LiveSpeed(double teeth) : pitch_rad_(2.0 * std::numbers::pi / teeth) {}

    /// Call with the newest input.
    void update(const antiskid::control::SpeedInput& input) {
        using antiskid::control::SpeedSource;
        if (input.received == antiskid::control::kNever) return;
        if (input.source == SpeedSource::speed) {
            radps_ = static_cast<double>(input.speed_radps);
            return;
        }
        const std::uint32_t edges = input.edge_count - from_count_;
        const double length_s = antiskid::host::seconds(input.edge_time - from_time_);
        if (!started_ || edges > kMaxEdges || length_s < 0.0) {
            started_ = true;
            radps_ = 0.0;
            begin(input);
            silence_ = kNone;
            received_ = input.received;
            newest_count_ = input.edge_count;
            return;
        }
        silence_ = input.edge_count == newest_count_ ? silence_ + std::clamp(input.received - received_, kNone, kLate) : kNone;
        received_ = input.received;
        newest_count_ = input.edge_count;
        if (edges > 0 && length_s >= kWindow_s) {
            radps_ = static_cast<double>(edges) * pitch_rad_ / length_s;
            begin(input);
        }
        // Frames without a new edge: at most one edge in that time.
        const double silent_s = antiskid::host::seconds(silence_ - kLate);
        if (silent_s > 0.0) radps_ = std::min(radps_, pitch_rad_ / silent_s);
    }

    [[nodiscard]] double radps() const { return radps_; }

  private:
    static constexpr double kWindow_s = 0.005;
    static constexpr antiskid::control::Time kNone{0};
    static constexpr antiskid::control::Time kLate{30'000'000};  // normal delay of a frame; a longer pause is not the sensor's
    static constexpr std::uint32_t kMaxEdges = 1 << 20;          // more edges mean another sensor, or a restarted one

    void begin(const antiskid::control::SpeedInput& input) {
        from_count_ = input.edge_count;
        from_time_ = input.edge_time;
    }

    double pitch_rad_;
    bool started_ = false;
    std::uint32_t from_count_ = 0;
    std::uint32_t newest_count_ = 0;
    antiskid::control::Time from_time_{};
    antiskid::control::Time received_{};
    antiskid::control::Time silence_{};  // of the edges, in frames that were received
    double radps_ = 0.0;
};

}  // namespace rig::bridge
