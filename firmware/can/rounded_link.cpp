#include "firmware/can/rounded_link.hpp"

namespace antiskid::can {

RoundedLink::RoundedLink(const Layout& layout, control::Time step) : layout_(layout), schedule_(layout, step) {}

const control::Sensors& RoundedLink::sense(const RigSample& sample, control::Time now) {
    sensors_.emergency_stop = sample.emergency_stop;
    if (schedule_.due(Role::wheel, step_index_)) {
        wheel_.apply(layout_.wheel, to_raw(layout_.wheel, sample.wheel), now, sensors_.wheel);
    }
    if (schedule_.due(Role::flywheel, step_index_)) {
        flywheel_.apply(layout_.flywheel, to_raw(layout_.flywheel, sample.flywheel), now, sensors_.flywheel);
    }
    if (schedule_.due(Role::pressure, step_index_)) {
        sensors_.pressure.received = now;
        sensors_.pressure.pressure_Pa = static_cast<float>(layout_.pressure_Pa.rounded(static_cast<double>(sample.pressure_Pa)));
    }
    if (schedule_.due(Role::maneuver, step_index_) && !apply(layout_.maneuver, to_raw(layout_.maneuver, sample.maneuver), now, sensors_.maneuver)) {
        ++sensors_.maneuver.rejected;
    }
    if (schedule_.due(Role::rig_heartbeat, step_index_)) sensors_.rig_heartbeat_received = now;
    ++step_index_;
    return sensors_;
}

}  // namespace antiskid::can
