/// Bounds by the valve for brake-on and for a change of surface: full or no current, chosen with exact knowledge of the plant, until the wheel has
/// its slip, which is then held exactly. Errors of holding are not included.
#pragma once

#include "firmware/control/config.hpp"
#include "plant_sim/model/rig.hpp"
#include "plant_sim/study/robust/regrip.hpp"

namespace robust {

/// J_mu as in held_j_mu(), from rolling at `rig.brake_on_mps`. Full current for the largest number of periods after which, without current, the slip
/// stays below the reference in force; held from the instant at which the slip stops rising.
[[nodiscard]] double soonest_j_mu(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference,
                                  double drop_out_mps, double period_s);

/// The same with exact knowledge of the plant and its present state, but not of the runway ahead: full current as long as the wheel would not lock if
/// friction rose no more than it did `late_s` before and the current were cut off next, none otherwise. The reference in force is held exactly from
/// the instant at which the wheel first has it. Friction is taken to rise up to `earliest_peak_slip` on every runway.
[[nodiscard]] double wary_j_mu(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference, double drop_out_mps,
                               double period_s, double late_s);

struct SoonestRegrip {
    Regrip regrip;
    double j_mu = 0.0;  ///< over the judged time
};
/// Changes from the peak slip of `rig.surface`, held at `speed_mps`, to that of `other`, known at once: no current while slip or pressure exceed that
/// state, full current while they are below.
[[nodiscard]] SoonestRegrip soonest_regrip(const rig::RigParameters& rig, const rig::Surface& other, double speed_mps, double period_s);

}  // namespace robust
