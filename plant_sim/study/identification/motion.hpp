/// Motion of wheel and flywheel from the edges of their encoders: distances over windows, which need no estimate of speed and have no lag.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "plant_sim/study/identification/recording.hpp"

namespace identification {

/// Angle of one shaft over time, linear between edges.
class ShaftTrack {
  public:
    /// Uses `samples` [from, to). The sensor's clock is converted to that of the samples with the smallest difference seen, as if the promptest edge
    /// had no delay.
    ShaftTrack(const Recording& recording, Edges Sample::*shaft, double teeth, std::size_t from, std::size_t to);

    /// Angle since the first edge, rad. If edges are more than kRest_s apart, the shaft is at rest between them.
    [[nodiscard]] double angle(double time_s) const;
    /// Position of an instant among the edges: after edge `edge`, at `share` of the interval to the next.
    struct Place {
        std::size_t edge;
        double share;
    };
    [[nodiscard]] Place place(double time_s) const;
    /// Mean speed over a window, rad/s.
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
    /// None: the recording has no touchdown and braking. `cell_age_s`: see below.
    [[nodiscard]] static std::optional<Motion> of(const Run& run, double cell_age_s);

    [[nodiscard]] double contact_s() const { return contact_s_; }  ///< time at which the wheel starts to turn
    [[nodiscard]] double brake_on_s() const { return brake_on_s_; }
    [[nodiscard]] double end_s() const { return end_s_; }  ///< standstill, by the recording's phase
    [[nodiscard]] double brake_on_mps() const { return brake_on_mps_; }
    [[nodiscard]] double free_radius_m() const { return free_radius_m_; }  ///< r_0, from free rolling before brake-on
    /// Standard deviation of free_radius_m(), from jitter of the edges and noise of the load over the rolling distance. All slips of the maneuver
    /// share this error.
    [[nodiscard]] double free_radius_deviation_m() const { return free_radius_deviation_m_; }

    [[nodiscard]] double v_mps(double from_s, double to_s) const { return flywheel_.speed(from_s, to_s) * R_f_m_; }
    [[nodiscard]] double omega_radps(double from_s, double to_s) const { return wheel_.speed(from_s, to_s); }
    [[nodiscard]] const ShaftTrack& wheel() const { return wheel_; }
    [[nodiscard]] const ShaftTrack& flywheel() const { return flywheel_; }
    [[nodiscard]] double load_N(double time_s) const;  ///< by the load cell, corrected for its age
    [[nodiscard]] double radius_m(double time_s) const { return free_radius_m_ - load_N(time_s) / stiffness_Npm_; }
    /// Slip, eq. (3), as mean over the window.
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

/// Age of the load cells' readings relative to the samples that contain them, from poll and frame, over all runs. It is found from the build-up of
/// force at brake-on, where the flywheel's deceleration shows the same force without delay. 0 if no run shows it.
[[nodiscard]] double cell_age_s(std::span<const Run> runs);

}  // namespace identification
