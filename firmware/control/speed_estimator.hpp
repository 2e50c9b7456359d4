/// Speed of a toothed wheel by the M/T method: number of whole edges divided by their exact time.
#pragma once

#include <cstdint>

#include "firmware/control/types.hpp"

namespace antiskid::control {

/// Speed reading from the frame of one period.
struct SpeedReading {
    float speed_radps = 0.0F;  ///< mean speed over the interval, or an upper bound if no edge came
    float interval_s = 0.0F;   ///< time the edges took; the reading belongs to its middle
    bool fresh = false;        ///< edges came (or a speed frame): a measurement
    bool bounded = false;      ///< no edge came for longer than the last speed explains: `speed_radps` is an upper bound
    float late_s = 0.0F;       ///< delay of the frame after its newest edge, beyond the smallest delay so far
    bool valid = false;        ///< false until two edges, or no edge for 100 ms, have been seen
};

/// False for an impossible reading or NaN, which must not enter a filter; the monitor reports it.
[[nodiscard]] constexpr bool is_possible(const SpeedReading& reading, float max_speed_radps) {
    return reading.speed_radps >= 0.0F && reading.speed_radps <= max_speed_radps;
}

class SpeedEstimator {
  public:
    explicit SpeedEstimator(float teeth);

    /// One period. A shaft whose frames show no edge for 100 ms counts as standing: a valid zero. A missing frame gives no reading.
    SpeedReading update(const SpeedInput& input);

  private:
    [[nodiscard]] float late_s(const SpeedInput& input);

    float radians_per_edge_;
    bool clock_known_ = false;
    Time quickest_{};  // smallest delay of a frame after its newest edge, the one on our clock, the other on the sensor's
    bool started_ = false;
    bool running_ = false;   // an edge seen since the last standstill
    bool measured_ = false;  // speed_radps_ is known: two edges, or a standstill
    std::uint32_t edge_count_ = 0;
    Time edge_time_{};
    Time newest_edge_seen_{};  // arrival of the frame with the newest edge
    Time last_received_ = kNever;
    float speed_radps_ = 0.0F;
};

}  // namespace antiskid::control
