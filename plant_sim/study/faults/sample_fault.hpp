/// Faults of the values that the rig's side sends, wherever in its sample they stand.
#pragma once

#include "firmware/can/rig_sample.hpp"
#include "plant_sim/model/rig.hpp"
#include "plant_sim/study/faults/value_fault.hpp"
#include "plant_sim/study/rig_session.hpp"

namespace faults {

/// A bias of the law is the next one; a spike another one at random in a share of the periods; saturation the largest code. An
/// emergency stop is pressed for as long as the fault lasts, at least for kPressed_s.
class SampleFault {
  public:
    static constexpr double kPressed_s = 0.5;

    SampleFault(const Fault& fault, const rig::RigParameters& rig, double period_s);
    void apply(antiskid::can::RigSample& sample, const study::RigSession& session, bool active, rig::Random& random);

  private:
    void apply_law(antiskid::can::ManeuverSample& maneuver, rig::Random& random) const;

    Fault fault_;
    ValueFault value_;
    SwitchFault switch_;
    EncoderFault encoder_;
    double flywheel_radius_m_;
    double period_s_;
    double pressed_until_s_ = -1.0;
};

}  // namespace faults
