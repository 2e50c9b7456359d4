/// Wheel inertia J_w and brake gain k_b from eq. (1), with the road's force eliminated:
///
///     J_w domega/dt + r m dv/dt = -k_b(v) P_clamp,      k_b(v) = G (a0 + a1 x + a2 x^2 + a3 x^3),  x = v / v_brake_on
///
/// integrated from before the wheel touches the rim: the spin-up determines J_w, braking k_b. P_clamp is the pressure P of eq. (5), or what contact
/// pressure and piston friction (rig::Clamping) leave of it, where the recordings show them. Speeds are distances by the encoders over windows; m is
/// the flywheel's mass, G the brake's geometry of eq. (5). The rim's drag counts while the wheel is off it.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant_sim/study/identification/estimate.hpp"
#include "plant_sim/study/identification/motion.hpp"

namespace identification {

struct WheelResiduals {
    std::string recording;
    bool braking = false;           ///< whether the stop was used; otherwise only the time up to brake-on
    std::vector<double> time_s;     ///< since brake-on
    std::vector<double> speed_mps;  ///< measured rim speed
    std::vector<double> error_mps;  ///< measured minus modelled
};

struct WheelFit {
    Estimate inertia_kgm2;                                ///< J_w
    Estimate gain_m3;                                     ///< k_b, mean over a stop of constant deceleration
    Estimate friction;                                    ///< mean mu_b, k_b without geometry
    std::optional<Estimate> contact_Pa, piston_friction;  ///< of rig::Clamping; none: the recordings show no other than 0
    std::string friction_class;
    std::array<Estimate, 4> relative_friction;  ///< mu_b over its mean, powers of x
    double misfit = 0.0;                        ///< of the balance, over what errors of the sensors explain, RMS: about 1 for a brake of this form
    double lags_s = 0.0;
    std::vector<WheelResiduals> residuals;
};

/// Uses the touchdowns of all runs, and the stops of those of `friction_class`. Throws NotIdentifiable.
[[nodiscard]] WheelFit fit_wheel(std::span<const Run> runs, const std::string& friction_class);

}  // namespace identification
