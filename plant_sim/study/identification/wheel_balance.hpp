/// The balance of eq. (1) of the wheel over recorded touchdowns and stops, of which wheel_fit.hpp finds the parameters: windows of 20 ms, the
/// integral of r m dv in each, and the expected covariance of its errors.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "plant_sim/study/identification/motion.hpp"
#include "plant_sim/study/identification/wheel_fit.hpp"
#include "rig_bridge/rig/clamping.hpp"

namespace identification {

inline constexpr std::size_t kFrictionPowers = 4;
inline constexpr double kSpeedWindow_s = 0.02;

/// One window: the terms of the balance, which is linear in them.
struct WheelWindow {
    double time_s = 0.0, v_mps = 0.0;
    double momentum_Nms = 0.0;  ///< integral of r m dv since the start
    double omega_radps = 0.0;
    double coasting_s = 0.0;                        ///< time off the rim since the start
    std::array<double, kFrictionPowers> impulse{};  ///< integral of G P_clamp x^k dt, mean over the window
};

/// One sample of the gauge.
struct GaugeReading {
    double time_s = 0.0;
    double pressure_Pa = 0.0;  ///< 0 before brake-on, where a reading is noise, cut off at zero
    double smooth_Pa = 0.0;    ///< mean of five readings: discs that follow the gauge's noise would never let go
    double x = 0.0;
};

/// One recording's part of the balance.
struct WheelSegment {
    std::string name;
    bool braking = false;
    double brake_on_s = 0.0;
    double to_mps = 1.0;        ///< N m s per m/s
    double radius_share = 0.0;  ///< relative deviation of the free radius
    double gain_m3 = 0.0;       ///< G
    std::vector<GaugeReading> readings;
    std::vector<double> middles_s;      ///< of the windows, without a gap between them
    std::vector<WheelWindow> windows;   ///< those of them that count
    Eigen::LLT<Eigen::MatrixXd> noise;  ///< of the windows' expected covariance, (N m s)^2
};

/// `braking`: down to 6 m/s; otherwise up to brake-on. Without windows if the recording is too short.
[[nodiscard]] WheelSegment wheel_segment(const Run& run, const Motion& motion, bool braking);

/// Which part of rig::Clamping a fit looks for; the other is 0.
struct Sought {
    bool contact = false, piston_friction = false;
};

/// theta: J_w, the coefficients of friction over x, the contact pressure in MPa and the piston friction as far as they are sought, then offset and
/// drag of each segment.
class WheelBalance {
  public:
    WheelBalance(std::vector<WheelSegment> segments, const Sought& sought);

    [[nodiscard]] Eigen::Index contact() const { return 1 + static_cast<Eigen::Index>(kFrictionPowers); }
    [[nodiscard]] Eigen::Index piston_friction() const { return contact() + (sought_.contact ? 1 : 0); }
    /// How many parameters are not of one segment.
    [[nodiscard]] Eigen::Index common() const { return piston_friction() + (sought_.piston_friction ? 1 : 0); }
    [[nodiscard]] Eigen::Index parameters() const { return common() + 2 * static_cast<Eigen::Index>(segments_.size()); }
    [[nodiscard]] const Sought& sought() const { return sought_; }
    [[nodiscard]] std::size_t windows() const { return windows_; }

    /// Divided by their expected covariance.
    void residuals(const Eigen::VectorXd& theta, Eigen::VectorXd& out);
    /// Of the theta that residuals() was called with last.
    [[nodiscard]] std::vector<WheelResiduals> report(const Eigen::VectorXd& theta) const;

  private:
    void clamp(const rig::Clamping& clamping);
    [[nodiscard]] static double error_Nms(const WheelWindow& window, const Eigen::VectorXd& theta, Eigen::Index own);

    std::vector<WheelSegment> segments_;
    Sought sought_;
    rig::Clamping clamping_{};
    std::size_t windows_ = 0;
};

}  // namespace identification
