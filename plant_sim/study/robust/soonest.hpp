/// What the valve leaves of brake-on and of a change of surface: full current or none, by one who knows the plant, until the wheel has its slip,
/// which is held exactly from then on. What it costs to stay there is not in it.
#pragma once

#include "firmware/control/config.hpp"
#include "plant_sim/model/rig.hpp"
#include "plant_sim/study/robust/regrip.hpp"

namespace robust {

/// J_mu as held_j_mu() has it, from rolling at `rig.brake_on_mps`: full current for as many periods as leave the slip below the reference in
/// force when there is none after them; held from where the slip rises no more.
[[nodiscard]] double soonest_j_mu(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference,
                                  double drop_out_mps, double period_s);

/// The same by one who knows the plant and what it does now, but not the runway ahead: full current for as long as the wheel would not lock if
/// friction rose no more than it did `late_s` before and the brake were let go next, none otherwise; the reference in force is held exactly from
/// where the wheel first has it. On no runway does friction stop rising before `earliest_peak_slip`.
[[nodiscard]] double wary_j_mu(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference, double drop_out_mps,
                               double period_s, double late_s);

struct SoonestRegrip {
    Regrip regrip;
    double j_mu = 0.0;  ///< of what was looked at
};
/// From the slip of most friction of `rig.surface`, held at `speed_mps`, to that of `other`, known at once. None while there is more slip or more
/// pressure than that needs, full current while there is less.
[[nodiscard]] SoonestRegrip soonest_regrip(const rig::RigParameters& rig, const rig::Surface& other, double speed_mps, double period_s);

}  // namespace robust
