/// A toothed shaft with perfect electronics: edge counts and edge times of a motion that is exact between two samples. Neighbouring teeth may be
/// missing.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "firmware/control/types.hpp"

namespace control_test {

class Shaft {
  public:
    explicit Shaft(const double teeth, const int missing = 0)
        : teeth_(std::lround(teeth)), missing_(missing), tooth_rad_(2.0 * std::numbers::pi / teeth) {}

    /// The next `h` seconds, with the speed going linearly from the last one to `radps`.
    void turn_to(const double radps, const double h) {
        const double a = (radps - radps_) / h;
        const double start = angle_rad_;
        angle_rad_ += radps_ * h + 0.5 * a * h * h;
        const auto last = static_cast<std::int64_t>(std::floor(angle_rad_ / tooth_rad_));
        while (tooth_ < last) {
            if (++tooth_ % teeth_ < missing_) continue;
            // omega t + a t^2 / 2 = distance to the edge, the stable root
            const double distance = static_cast<double>(tooth_) * tooth_rad_ - start;
            const double root = std::sqrt(std::max(radps_ * radps_ + 2.0 * a * distance, 0.0));
            edge_time_s_ = time_s_ + std::min(2.0 * distance / (radps_ + root), h);
            ++edges_;
        }
        radps_ = radps;
        time_s_ += h;
    }

    void report(antiskid::control::SpeedInput& input, const antiskid::control::Time now) const {
        input.received = now;
        input.source = antiskid::control::SpeedSource::edges;
        input.edge_count = first_count + edges_;
        input.edge_time = first_time + antiskid::control::Time{static_cast<std::int64_t>(std::llround(edge_time_s_ * 1e9))};
        input.speed_radps = static_cast<float>(radps_);
    }

    [[nodiscard]] double radps() const { return radps_; }

    std::uint32_t first_count = 0;
    antiskid::control::Time first_time{};

  private:
    std::int64_t teeth_;
    std::int64_t missing_;
    double tooth_rad_;
    double angle_rad_ = 0.0;
    double radps_ = 0.0;
    std::int64_t tooth_ = 0;
    std::uint32_t edges_ = 0;
    double time_s_ = 0.0;
    double edge_time_s_ = 0.0;
};

}  // namespace control_test
