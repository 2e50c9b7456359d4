/// Friction readings of a braking maneuver: mu = F_x / F_z by the load cells and slip by the encoders, over a window around the instant of each
/// reading, and the covariance of their errors. Errors of slip count with the slope of the curve (effective variance: Barker and Diana, American
/// Journal of Physics 42, 1974).
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
    double moved;  ///< possible error of slip because of its instant; only a slip that changes fast has one
    bool held;     ///< whether slip changes slowly
};

/// Covariance of the errors of one maneuver's readings: own + common common'.
struct ReadingCovariance {
    Eigen::SparseMatrix<double> own;  ///< of each reading and with its neighbours
    Eigen::VectorXd common;           ///< an error shared by all readings
};

class FrictionReadings {
  public:
    static constexpr double kWindow_s = 0.01;
    static constexpr double kSlowest_mps = 10.0;  ///< below it a window has too few edges

    /// None: the run has no touchdown and braking. `cell_age_s`: see cell_age_s() of motion.hpp.
    [[nodiscard]] static std::optional<FrictionReadings> of(const Run& run, double cell_age_s);

    [[nodiscard]] const std::vector<FrictionReading>& all() const { return readings_; }

    /// Covariance of mu - curve(slip) for forces with noise of the standard deviation `force_noise_N`:
    /// - jitter of the edges at both ends of a window; the adjacent window has it with the opposite sign,
    /// - the free radius: all slips of a maneuver have the same error,
    /// - noise of the load cells; that of the vertical one also changes the radius.
    [[nodiscard]] ReadingCovariance covariance(const rig::Surface& curve, double force_noise_N) const;

  private:
    FrictionReadings(const Run& run, const Motion& motion);

    std::vector<FrictionReading> readings_;
    Eigen::SparseMatrix<double> jitter_;  // covariance of the slips
    double radius_share_;                 // relative standard deviation of the free radius
    double per_load_;                     // change of slip per N of vertical load
};

/// Standard deviation of one force reading, N, from adjacent readings at constant slip.
[[nodiscard]] double force_noise_N(const std::vector<FrictionReadings>& runs);

}  // namespace identification
