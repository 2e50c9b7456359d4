#include "plant_sim/model/encoder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace plant {

Encoder::Encoder(const rig::EncoderParameters& parameters)
    : parameters_(parameters), edges_per_rad_(parameters.teeth / (2.0 * std::numbers::pi)), rad_per_edge_(1.0 / edges_per_rad_), next_edge_(1.0) {
    if (parameters.pitch_error == 0.0 && parameters.eccentricity == 0.0) return;
    constexpr std::uint64_t kTheseTeeth = 1;
    rig::Random places(kTheseTeeth);
    misplaced_rad_.resize(static_cast<std::size_t>(parameters.teeth));
    for (std::size_t tooth = 0; tooth < misplaced_rad_.size(); ++tooth) {
        const double evenly = static_cast<double>(places.bits() >> 11U) * 0x1.0p-52 - 1.0;
        misplaced_rad_[tooth] =
            parameters.pitch_error * rad_per_edge_ * evenly + parameters.eccentricity * std::sin(rad_per_edge_ * static_cast<double>(tooth));
    }
}

void Encoder::advance(double angle_rad, double before_radps, double after_radps, double now_s, double step_s, rig::Random& random) {
    const double edges = angle_rad * edges_per_rad_;
    if (edges < next_edge_) return;
    const auto last = static_cast<double>(static_cast<std::int64_t>(edges));
    const auto passed = static_cast<std::uint32_t>(last - next_edge_ + 1.0);
    next_edge_ = last + 1.0;
    if (after_radps * edges_per_rad_ < parameters_.slowest_edges_hz) return;  // too slow for the pick-up: these edges are lost

    // Time since the edge at constant acceleration over the step: solve omega t - a t^2 / 2 = angle, the
    // stable way.
    double angle = (edges - last) * rad_per_edge_;
    if (!misplaced_rad_.empty()) {
        const auto tooth = static_cast<std::size_t>(last) % misplaced_rad_.size();
        angle = std::max(angle - misplaced_rad_[tooth], 0.0);
    }
    const double acceleration = (after_radps - before_radps) / step_s;
    const double root = std::sqrt(std::max(after_radps * after_radps - 2.0 * acceleration * angle, 0.0));
    const double since = std::min(2.0 * angle / (after_radps + root), step_s);
    count_ += passed;
    // A stamp is neither before the previous one nor in the future.
    const double stamp = std::min(std::max(now_s - since + parameters_.jitter_s * random.noise(), edge_time_s_), now_s);
    if (stamp > edge_time_s_) speed_radps_ = passed * rad_per_edge_ / (stamp - edge_time_s_);
    edge_time_s_ = stamp;
}

}  // namespace plant
