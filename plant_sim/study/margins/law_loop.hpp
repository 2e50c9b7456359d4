/// The shipped law as a linear loop: what control::Estimator, control::SlipLaw and the plant do to small motions around an equilibrium.
///
/// Opened at the valve current, period by period, exact: the plant's wheel and valve as sampled, its delay in whole and broken periods; the
/// controller's valve model with the commands in its pipe, its observer, its prediction over the delay, the law. An encoder whose edges are
/// further apart than a period gives news only in every N-th, N = round(T_edge / h): the loop is periodic then, and margins() takes its N
/// characteristic loci. Factor in front of L: an error of valve gain, brake gain (to first order) or current map.
///
/// The observer is one that has settled and knows the road's answer: the rigid wheel's pole, also where the tyre gives way (what it sees
/// below the tyre's mode). Neglected: how it learns that, and forgets it; limits
/// of pressure, slip rate and integral, the retreat of the reference and its rate limit; the chord of friction, which counts below
/// SlipConfig::earliest_peak_slip alone; noise, jitter and rounding; the
/// motion of the aircraft's speed and of its estimate; changes of load, radius and k_b while the loop settles; an edge interval that
/// is no whole number of periods (rounded) and its beat with the period; edges bound to the angle instead of time.
#pragma once

#include <optional>

#include "firmware/control/config.hpp"
#include "plant_sim/study/margins/operating_point.hpp"
#include "plant_sim/study/margins/sampled_loop.hpp"

namespace study::margins {

/// Linearised at `at`: `config` is the controller, `rig` the plant. `answer_per_s` is what the observer takes the road's answer for: the
/// wheel's pole, unless given.
[[nodiscard]] PeriodicSystem law_system(const antiskid::control::Config& config, const rig::RigParameters& rig, const OperatingPoint& at,
                                        Linearisation linearisation, std::optional<double> answer_per_s = {});

/// falling_reference() of slip_law.hpp.
[[nodiscard]] double scheduled_slip(const antiskid::control::SlipConfig& config, double slip_reference, double speed_mps);

}  // namespace study::margins
