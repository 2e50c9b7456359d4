/// The shipped law as a linear loop: control::Estimator, control::SlipLaw and the plant for small motions around an equilibrium.
///
/// The loop is opened at the valve current and computed exactly, period by period: the sampled wheel, valve and hydraulic line of the plant, its
/// delay in whole and fractional periods; the controller's valve model with the commands in its delay line, its observer, its prediction over the
/// delay, the law. If the encoder's edges are further apart than a period, there is a new reading only in every N-th, N = round(T_edge / h): the
/// loop is periodic, and margins() uses its N characteristic loci. A gain error in front of L stands for one of valve gain, of brake gain (to first
/// order) or of the current map.
///
/// The observer is taken as settled, with the wheel's pole known: that of the rigid wheel, also for a compliant tyre (which is what the observer
/// sees below the tyre's mode). Neglected are: learning and forgetting of the pole; limits of pressure, slip rate and integral, the retreat of the
/// reference and its rate limit; the chord of friction, which only matters below SlipConfig::earliest_peak_slip; noise, jitter and rounding; the
/// change of the aircraft's speed and of its estimate; changes of load, radius and k_b while the loop settles; an edge interval that is not a whole
/// number of periods (it is rounded) and its beat with the period; edges bound to the angle instead of time.
#pragma once

#include <optional>

#include "firmware/control/config.hpp"
#include "plant_sim/study/margins/operating_point.hpp"
#include "plant_sim/study/margins/sampled_loop.hpp"

namespace study::margins {

/// Linearises controller `config` and plant `rig` at `at`. `wheel_pole_radps`: the observer's estimate; none: the true pole.
[[nodiscard]] PeriodicSystem law_system(const antiskid::control::Config& config, const rig::RigParameters& rig, const OperatingPoint& at,
                                        Linearisation linearisation, std::optional<double> wheel_pole_radps = {});

/// Reference in force at a speed, see falling_reference() of slip_law.hpp.
[[nodiscard]] double scheduled_slip(const antiskid::control::SlipConfig& config, double slip_reference, double speed_mps);

}  // namespace study::margins
