/// What a braking maneuver says of the road: mu = F_x / F_z by the load cells against slip by the encoders, over a window around the instant of
/// each reading, and how the errors of these readings hang together. Errors of slip count by the slope of the curve (effective variance: Barker
/// and Diana, American Journal of Physics 42, 1974).
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <optional>
#include <vector>

#include "plant_sim/study/identification/motion.hpp"
#include "rig_bridge/rig/tyre.hpp"

namespace identification {

struct FrictionReading {
    double slip, mu;
    double load_N;
    double moved;  ///< what slip may be off because its instant is: only a slip that moves fast
    bool held;     ///< slip moves slowly
};

/// Covariance of the errors of one maneuver's readings: own + common common'.
struct ReadingCovariance {
    Eigen::SparseMatrix<double> own;  ///< of readings by themselves and with their neighbours
    Eigen::VectorXd common;           ///< one error that all of them share
};

class FrictionReadings {
  public:
    static constexpr double kWindow_s = 0.01;
    static constexpr double kSlowest_mps = 10.0;  ///< below, a window holds too few edges

    /// None where the run has no touchdown and braking.
    [[nodiscard]] static std::optional<FrictionReadings> of(const Run& run, double cell_age_s);

    [[nodiscard]] const std::vector<FrictionReading>& all() const { return readings_; }

    /// Of mu - curve(slip), for forces with noise of this deviation:
    /// - jitter of the edges at both borders of a window, which its neighbour shares with the opposite sign,
    /// - the free radius, in which all slips of a maneuver are off alike,
    /// - noise of the cells, that of the vertical one in the radius, too.
    [[nodiscard]] ReadingCovariance covariance(const rig::Surface& curve, double force_noise_N) const;

  private:
    FrictionReadings(const Run& run, const Motion& motion);

    std::vector<FrictionReading> readings_;
    Eigen::SparseMatrix<double> jitter_;  // covariance of the slips
    double radius_share_;                 // relative deviation of the free radius
    double per_load_;                     // slip per N of vertical load
};

/// Deviation of one force, N, from readings next to each other at held slip.
[[nodiscard]] double force_noise_N(const std::vector<FrictionReadings>& runs);

}  // namespace identification
