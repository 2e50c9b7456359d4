/// The motion of wheel and flywheel from the edges of their encoders: ways over windows, which need no estimate of speed and have no lag.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "plant_sim/study/identification/recording.hpp"

namespace identification {

/// Angle of one shaft over time, linear between stamped edges.
class ShaftTrack {
  public:
    /// Of `samples` [from, to). The sensor's clock is taken to that of the samples by the smallest distance seen: an edge is read at once at
    /// best.
    ShaftTrack(const Recording& recording, Edges Sample::*shaft, double teeth, std::size_t from, std::size_t to);

    /// rad since the first edge. A pause of more than kRest_s between two edges is a shaft at rest.
    [[nodiscard]] double angle(double time_s) const;
    /// Where an instant lies among the stamped edges: after edge `edge`, by `share` of the way to the next.
    struct Place {
        std::size_t edge;
        double share;
    };
    [[nodiscard]] Place place(double time_s) const;
    /// Mean over a window, rad/s.
    [[nodiscard]] double speed(double from_s, double to_s) const { return (angle(to_s) - angle(from_s)) / (to_s - from_s); }

  private:
    static constexpr double kRest_s = 0.15;
    struct Point {
        double time_s, angle_rad;
    };
    std::vector<Point> points_;
};

/// One braking maneuver from before the wheel touches the rim.
class Motion {
  public:
    /// None where the recording has no touchdown and braking. `cell_age_s`: see cell_age().
    [[nodiscard]] static std::optional<Motion> of(const Run& run, double cell_age_s);

    [[nodiscard]] double contact_s() const { return contact_s_; }  ///< the wheel begins to turn
    [[nodiscard]] double brake_on_s() const { return brake_on_s_; }
    [[nodiscard]] double end_s() const { return end_s_; }  ///< standstill, as the recording's phase says
    [[nodiscard]] double brake_on_mps() const { return brake_on_mps_; }
    [[nodiscard]] double free_radius_m() const { return free_radius_m_; }  ///< r_0, from free rolling before brake-on
    /// Of free_radius_m(): jitter of the edges and noise of the load over the way that it was found on. All slips of the maneuver share it.
    [[nodiscard]] double free_radius_deviation_m() const { return free_radius_deviation_m_; }

    [[nodiscard]] double v_mps(double from_s, double to_s) const { return flywheel_.speed(from_s, to_s) * R_f_m_; }
    [[nodiscard]] double omega_radps(double from_s, double to_s) const { return wheel_.speed(from_s, to_s); }
    [[nodiscard]] const ShaftTrack& wheel() const { return wheel_; }
    [[nodiscard]] const ShaftTrack& flywheel() const { return flywheel_; }
    [[nodiscard]] double load_N(double time_s) const;  ///< by the load cell, its age taken off
    [[nodiscard]] double radius_m(double time_s) const { return free_radius_m_ - load_N(time_s) / stiffness_Npm_; }
    /// Eq. (3) as mean over the window.
    [[nodiscard]] double slip(double from_s, double to_s) const {
        return 1.0 - radius_m(0.5 * (from_s + to_s)) * omega_radps(from_s, to_s) / v_mps(from_s, to_s);
    }

    struct CellReading {
        double time_s;  ///< of the force, not of the frame
        double vertical_N, longitudinal_N;
    };
    [[nodiscard]] const std::vector<CellReading>& cells() const { return cells_; }

  private:
    Motion(const Run& run, double cell_age_s, std::size_t from, std::size_t to);
    void find_contact();

    ShaftTrack wheel_, flywheel_;
    double R_f_m_, stiffness_Npm_;
    double contact_s_ = 0.0, brake_on_s_ = 0.0, end_s_ = 0.0, brake_on_mps_ = 0.0;
    double free_radius_m_ = 0.0, free_radius_deviation_m_ = 0.0;
    std::vector<CellReading> cells_;
};

/// How much older the load cells' readings are than the samples that bring them, by poll and frame, over all runs: from the build-up of
/// force at brake-on, where the flywheel's momentum shows the same force without delay. 0 where no run shows it.
[[nodiscard]] double cell_age_s(std::span<const Run> runs);

}  // namespace identification
