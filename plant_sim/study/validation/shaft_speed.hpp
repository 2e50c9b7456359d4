/// The mean speed of a toothed shaft over a window between two of its edges, and the same window of a simulated shaft: like is
/// compared with like, whatever the lag of a speed estimate.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include "firmware/control/types.hpp"

namespace validation {

class ShaftSpeed {
  public:
    struct Window {
        double from_s, to_s;  ///< log time; equal where the sensor reports speed itself
        double speed_radps;   ///< mean between them
    };

    explicit ShaftSpeed(double teeth) : rad_per_edge_(2.0 * std::numbers::pi / teeth) {}

    /// After every sample, at its log time. The sensor's clock is taken to log time by the smallest distance seen so far: an
    /// edge is read at once at best.
    void see(const antiskid::control::SpeedInput& input, double time_s) {
        if (input.received == antiskid::control::kNever) return;
        now_s_ = time_s;
        source_ = input.source;
        reported_radps_ = static_cast<double>(input.speed_radps);
        if (started_ && input.edge_count == count_) return;
        count_ = input.edge_count;
        edge_s_ = static_cast<double>(input.edge_time.count()) * 1e-9;
        offset_s_ = std::min(offset_s_, time_s - edge_s_);
        if (!started_) restart();
        started_ = true;
    }

    /// From the end of the last window to the newest edge; none while no edge has come since.
    [[nodiscard]] std::optional<Window> take() {
        if (!started_) return std::nullopt;
        if (source_ == antiskid::control::SpeedSource::speed) return Window{now_s_, now_s_, reported_radps_};
        const double length = edge_s_ - from_edge_s_;
        const auto edges = static_cast<double>(count_ - from_count_);
        if (edges < 1.0 || !(length > 0.0)) return std::nullopt;
        const Window window{from_edge_s_ + offset_s_, edge_s_ + offset_s_, edges * rad_per_edge_ / length};
        restart();
        return window;
    }

  private:
    void restart() {
        from_count_ = count_;
        from_edge_s_ = edge_s_;
    }

    double rad_per_edge_;
    bool started_ = false;
    antiskid::control::SpeedSource source_{};
    std::uint32_t count_ = 0, from_count_ = 0;
    double edge_s_ = 0.0, from_edge_s_ = 0.0;
    double offset_s_ = std::numeric_limits<double>::infinity();
    double now_s_ = 0.0;
    double reported_radps_ = 0.0;
};

}  // namespace validation
