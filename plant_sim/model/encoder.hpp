/// A toothed magnetic encoder: counts edges and stamps the last one. It has no signal when the shaft turns too slowly.
#pragma once

#include <cstdint>
#include <vector>

#include "rig_bridge/rig/random.hpp"
#include "rig_bridge/rig/rig_parameters.hpp"

namespace plant {

class Encoder {
  public:
    explicit Encoder(const rig::EncoderParameters& parameters);

    /// Call once a step. `angle_rad`: angle of the shaft at `now_s`, which must not decrease. `before_radps`, `after_radps`: speed `step_s` before
    /// `now_s`, and at `now_s`.
    void advance(double angle_rad, double before_radps, double after_radps, double now_s, double step_s, rig::Random& random);

    [[nodiscard]] std::uint32_t edge_count() const { return count_; }  ///< rolls over
    [[nodiscard]] double edge_time_s() const { return edge_time_s_; }  ///< time stamp of the last edge, with jitter
    /// Speed as reported by electronics that send a speed instead of edges: edges over their time; 0 from 100 ms after the last edge.
    [[nodiscard]] double speed_radps(double now_s) const { return now_s - edge_time_s_ < 0.1 ? speed_radps_ : 0.0; }

  private:
    rig::EncoderParameters parameters_;
    double edges_per_rad_, rad_per_edge_;
    std::vector<double> misplaced_rad_;  // error of each tooth's position; empty: no error
    double next_edge_;                   // angle of the next edge, in edges
    std::uint32_t count_ = 0;
    double edge_time_s_ = 0.0;
    double speed_radps_ = 0.0;
};

}  // namespace plant
