/// The loop of Section V: PID on measured slip, valve of eq. (6) with its exact delay, wheel of eq. (15).
#pragma once

#include "plant_sim/study/margins/loop.hpp"
#include "plant_sim/study/margins/operating_point.hpp"

namespace study::margins {

/// Current = (J v / (r k_b K_st)) (v / 40 m/s)^(schedule - 1) C(s) (reference - slip), C(s) = k_p + k_i / s + k_d s / (1 + s T_f). The first factor
/// is the inverse of the wheel's gain, so that C acts on the slip rate, as the controller's gains do. J, r, k_b and K_st are those of the operating
/// point.
struct Pid {
    double k_p_per_s = 0.0;
    double k_i_per_s2 = 0.0;
    double k_d = 0.0;
    double filter_s = 0.0;  ///< T_f; > 0 if k_d is not 0
    double schedule = 1.0;  ///< exponent of the speed: 0: fixed gains; 1: proportional to the wheel's gain

    static constexpr double kScheduleSpeed_mps = 40.0;
};

/// L(s) = A(s) G_lambda(s) C(s).
[[nodiscard]] DelayLoop pid_loop(const Pid& pid, const rig::ValveParameters& valve, const OperatingPoint& at, Linearisation linearisation);
/// The same for a given wheel pole, with the factor of the schedule 1: the margins depend on nothing else.
[[nodiscard]] DelayLoop pid_loop(const Pid& pid, const rig::ValveParameters& valve, double wheel_pole_radps);
/// L(s) of Fig. 11, without a controller: A(s) G_lambda(s) with unit gain from commanded pressure (K_st = 1); slip per MPa.
[[nodiscard]] DelayLoop plant_loop(const rig::ValveParameters& valve, const OperatingPoint& at, Linearisation linearisation);

}  // namespace study::margins
