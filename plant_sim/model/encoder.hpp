/// A toothed magnetic encoder: counts edges, stamps the last one, goes blind when the wheel turns too slowly.
#pragma once

#include <cstdint>
#include <vector>

#include "rig_bridge/rig/random.hpp"
#include "rig_bridge/rig/rig_parameters.hpp"

namespace plant {

class Encoder {
  public:
    explicit Encoder(const rig::EncoderParameters& parameters);

    /// The shaft has turned to `angle_rad` at time `now_s`, at speed `before_radps` a `step_s` ago and
    /// `after_radps` now. Angles must not fall.
    void advance(double angle_rad, double before_radps, double after_radps, double now_s, double step_s, rig::Random& random);

    [[nodiscard]] std::uint32_t edge_count() const { return count_; }  ///< rolls over
    [[nodiscard]] double edge_time_s() const { return edge_time_s_; }  ///< stamp of the last edge, jitter included
    /// What electronics that report speed instead would say: edges over the time they took, and zero 100 ms
    /// after the last one.
    [[nodiscard]] double speed_radps(double now_s) const { return now_s - edge_time_s_ < 0.1 ? speed_radps_ : 0.0; }

  private:
    rig::EncoderParameters parameters_;
    double edges_per_rad_, rad_per_edge_;
    std::vector<double> misplaced_rad_;  // of each tooth; none where all stand where they should
    double next_edge_;                   // angle in edges at which the next one comes
    std::uint32_t count_ = 0;
    double edge_time_s_ = 0.0;
    double speed_radps_ = 0.0;
};

}  // namespace plant
