#include "rig_bridge/bridge/maneuver_run.hpp"

#include <algorithm>

namespace rig::bridge {

namespace {

// The controller refuses the first frames of a bridge whose counters go on elsewhere than those of the last one: it needs a few heartbeats before it
// may be armed.
constexpr double kIntroduction_s = 0.5;

bool rests(rig::Phase phase) {
    return phase == rig::Phase::cool_down || phase == rig::Phase::finished || phase == rig::Phase::aborted;
}

}  // namespace

bool ManeuverRun::ready(const Moment& moment) const {
    constexpr double kFirstReading_s = 3.0;
    if (waited_s(moment) < kIntroduction_s) return false;
    if (!moment.inputs.plc_fresh) return waited_s(moment) > kFirstReading_s;
    const bool hot = moment.inputs.brake_temperature_C > std::min(plan_.cool_to_C, plan_.brake_on_limit_C);
    return !hot || waited_s(moment) > plan_.cool_down_limit_s;
}

std::string ManeuverRun::waits_for(const Moment& moment) const {
    if (waited_s(moment) < kIntroduction_s) return "";
    return moment.inputs.plc_fresh ? "waits for the brake to cool" : "waits for the PLC";
}

bool ManeuverRun::follow(const Moment& moment, antiskid::can::Time at, record::SampleLog& samples) {
    if (!recording()) return false;
    if (moment.plc.counters.polls != polls_) {
        polls_ = moment.plc.counters.polls;
        samples.write(at, moment.plc.values);
    }
    if (record_error_.empty()) record_error_ = moment.bus.missing != 0 ? moment.bus.recording_error : samples.error();
    return rests(moment.outputs.phase) && ++resting_ > kTail;
}

void ManeuverRun::finish(record::BusLog& log, record::SampleLog& samples) {
    const bool logged = log.finish();
    const bool sampled = samples.finish();
    if (!logged || !sampled) record_error_ = logged ? samples.error() : log.error();
}

}  // namespace rig::bridge
