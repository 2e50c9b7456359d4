#include "firmware/control/monitor.hpp"

#include "firmware/control/arithmetic.hpp"
#include "firmware/control/slip_law.hpp"

namespace antiskid::control {

namespace {
/// Compared as it is: a difference of times as a float costs a Cortex-M7 some twenty instructions.
Time nanoseconds(float time_s) {
    return Time{static_cast<std::int64_t>(time_s * 1e9F)};
}
FaultSet only(Fault fault, bool if_so) {
    FaultSet set;
    if (if_so) set.insert(fault);
    return set;
}
FaultSet only(Fault fault) {
    return only(fault, true);
}
/// A healthy sensor's frame is never late; a late one counts as several readings.
void take_reading(FaultCounter& counter, FaultSet wrong, Fault lost) {
    constexpr int kMore = 3;
    counter.take(wrong);
    if (wrong.contains(lost))
        for (int times = 0; times < kMore; ++times) counter.take(wrong);
}
}  // namespace

Monitor::Arrival::Arrival(float max_age_s, float frame_period_s)
    : max_age(nanoseconds(max_age_s)), max_reject_score(max_age_s / frame_period_s + 0.5F) {}

Monitor::Monitor(const Config& config)
    : config_(config.monitor),
      wheel_encoder_(config.wheel.encoder),
      flywheel_encoder_(config.flywheel.encoder),
      flywheel_radius_m_(config.flywheel.radius_m),
      hardest_brake_(config.wheel.hardest_brake),
      released_Pa_(config.supervisor.residual_pressure_Pa),
      period_s_(config.period_s),
      acted_keeps_(1.0F - config.period_s / config.monitor.off_command_s),
      slower_(1.0F - config.monitor.overspeed_share),
      faster_(1.0F + config.monitor.overspeed_share),
      compensated_share_(config.estimator.valve_offset_share),
      wheel_arrival_(config.monitor.sensor_max_age_s, config.period_s),
      flywheel_arrival_(config.monitor.sensor_max_age_s, config.period_s),
      pressure_arrival_(config.monitor.sensor_max_age_s, config.period_s),
      maneuver_arrival_(config.monitor.maneuver_max_age_s, 0.5F * config.monitor.sensor_max_age_s),
      latest_s_(0.5F * config.monitor.sensor_max_age_s),
      heartbeat_max_age_(nanoseconds(config.monitor.heartbeat_max_age_s)),
      wheel_(config.monitor, config.period_s),
      wheel_hurries_(config.monitor.stuck_s, config.period_s),
      flywheel_(config.monitor, config.period_s),
      pressure_reading_(config.monitor.implausible_s, config.period_s),
      pressure_stays_(config.monitor.off_command_s, config.period_s) {}

inline Monitor::Arrival::MessageState Monitor::Arrival::judge(Time newest, std::uint32_t rejected_now, Time now) {
    // If most frames fail their checks, some bad ones pass by chance, so that even accepted values are unreliable. A repeat of each good frame is
    // harmless.
    if (const std::uint32_t more = rejected_now - rejected_before; more != 0) {
        rejected_before = rejected_now;
        constexpr std::uint32_t kCountWentBack = 1U << 31U;
        if (more < kCountWentBack) reject_score = smaller(reject_score + static_cast<float>(more), 2.0F * max_reject_score);
    }
    if (newest != received) {
        received = newest;
        rejected = rejected_now;
        reject_score = larger(reject_score - 1.0F, 0.0F);
    }
    if (reject_score > max_reject_score) return MessageState::corrupt;
    if (newest != kNever && now - newest <= max_age) return MessageState::good;
    return rejected_now != rejected ? MessageState::corrupt : MessageState::lost;
}

inline void Monitor::check_arrivals(FaultSet& faults, const Sensors& sensors, Time now) {
    const auto name = [&faults](Arrival::MessageState verdict, Fault lost, Fault corrupt) {
        if (verdict == Arrival::MessageState::lost) faults.insert(lost);
        if (verdict == Arrival::MessageState::corrupt) faults.insert(corrupt);
    };
    name(wheel_arrival_.judge(sensors.wheel.received, sensors.wheel.rejected, now), Fault::wheel_lost, Fault::wheel_corrupt);
    name(flywheel_arrival_.judge(sensors.flywheel.received, sensors.flywheel.rejected, now), Fault::flywheel_lost, Fault::flywheel_corrupt);
    name(pressure_arrival_.judge(sensors.pressure.received, sensors.pressure.rejected, now), Fault::pressure_lost, Fault::pressure_corrupt);
    name(maneuver_arrival_.judge(sensors.maneuver.received, sensors.maneuver.rejected, now), Fault::maneuver_lost, Fault::maneuver_corrupt);
    const Time heartbeat = sensors.rig_heartbeat_received;
    if (heartbeat == kNever || now - heartbeat > heartbeat_max_age_) faults.insert(Fault::heartbeat_lost);
}

inline FaultSet Monitor::wrong_by_itself(Speed& speed, const SpeedReading& reading, const EncoderConfig& encoder, const SpeedNames& names) const {
    const bool had = speed.known;
    speed.known = reading.valid;
    if (!reading.fresh) return {};
    if (reading.late_s > latest_s_) return only(names.lost);
    if (!is_possible(reading, encoder.max_speed_radps)) return only(names.range);
    // A reading is a mean over its interval: two of them in a row cannot differ by more than the acceleration times that. Each has an error of at
    // most two misplaced teeth; the worst case of all four at once does not occur.
    constexpr float kThreePitches = 3.0F * 6.28318531F;
    const float span = larger(reading.interval_s, period_s_);
    const float beyond = magnitude(reading.speed_radps - speed.last_radps) - encoder.max_acceleration_radps2 * span;
    speed.last_radps = reading.speed_radps;
    return only(names.rate, had && beyond > 0.0F && beyond * span * encoder.teeth > kThreePitches * encoder.pitch_error);
}

inline void Monitor::check_wheel(FaultSet& faults, const Estimator& estimator, const PreviousStep& previous) {
    const Estimate& e = estimator.estimate();
    const SpeedReading& reading = estimator.wheel_reading();
    FaultSet wrong = wrong_by_itself(wheel_, reading, wheel_encoder_, {Fault::wheel_lost, Fault::wheel_range, Fault::wheel_rate});
    const bool moving = e.v_mps > config_.plausible_above_mps;
    const bool rolls = previous.rolling && moving;
    const bool stands = reading.speed_radps == 0.0F;

    // A wheel slows by brake torque alone, k_b P / J_w, and with the aircraft: the road only slows a wheel that is faster than the aircraft. Residual
    // pressure may drag, and torque stored in the carcass by brake or road is released.
    const float brakes_Pa = larger(larger(e.pressure.pressure_Pa, estimator.uncorrected_pressure_Pa()), released_Pa_);
    acted_radps2_ = larger(larger(e.brake_gain * brakes_Pa, e.road_radps2), acted_radps2_ * acted_keeps_);
    const float fall = hardest_brake_ * acted_radps2_;
    const float freely = e.v_mps / e.radius_m;
    const float surely = smaller(reading.speed_radps, e.omega_radps) - fall * reading.interval_s;
    wheel_.min = rolls ? smaller(larger(surely, wheel_.min - fall * period_s_), freely) : 0.0F;
    constexpr float kSlow = 3.0F;  // times as fast as speeds are compared: a slower wheel swings by as much as it turns
    const bool falls = reading.speed_radps < slower_ * wheel_.min && wheel_.min * e.radius_m > kSlow * config_.plausible_above_mps;
    if (wrong.empty()) wrong = only(reading.fresh && !stands ? Fault::speeds_disagree : Fault::wheel_stuck, falls);
    if (reading.fresh || (reading.bounded && falls)) take_reading(wheel_.reading, wrong, Fault::wheel_lost);

    // By the command, not by the reading: on ice the braking pressure itself is within the transducer's error.
    const float model_Pa = estimator.uncorrected_pressure_Pa();
    const float rim = e.omega_radps * e.radius_m;
    const bool hurries = rim > e.v_mps * faster_ && rim > config_.plausible_above_mps;
    // A wheel that spins up again slips legitimately.
    const bool hardly_braked = model_Pa < config_.hardly_braked_Pa;
    const bool slips = rolls && hardly_braked && e.slip > config_.free_slip && magnitude(e.omega_dot_radps2) * e.radius_m < config_.steady_mps2;
    const bool released = model_Pa < 0.04F * released_Pa_;
    const bool stuck = rolls && released && stands;
    wheel_.stays.take(stuck ? only(Fault::wheel_stuck) : only(Fault::speeds_disagree, slips));
    if (wheel_hurries_.holds(hurries)) faults.insert(Fault::speeds_disagree);
    faults.insert(wheel_.reading.found());
    faults.insert(wheel_.stays.found());
}

/// An encoder that fails or jumps at speed must be found before the law uses it: the law would lock the wheel, after which both encoders agree, or
/// hardly brake.
inline void Monitor::check_flywheel(FaultSet& faults, const Estimator& estimator, bool lands) {
    const Estimate& e = estimator.estimate();
    const SpeedReading& reading = estimator.flywheel_reading();
    FaultSet wrong = wrong_by_itself(flywheel_, reading, flywheel_encoder_, {Fault::flywheel_lost, Fault::flywheel_range, Fault::flywheel_rate});
    const float reads_mps = reading.speed_radps * flywheel_radius_m_;
    const float sensible_mps = flywheel_encoder_.max_speed_radps * flywheel_radius_m_;
    const float step_mps = config_.max_deceleration_mps2 * period_s_;
    // Neither a single wild reading nor the tracker's overshoot after it may count as an earlier speed. A real jump persists.
    flywheel_.min = larger(smaller(smaller(reads_mps, e.v_mps), sensible_mps), flywheel_.min - step_mps);
    const float fastest_mps = larger(reads_mps, e.v_mps);
    const bool held = lands && !flywheel_.reading.found().contains(Fault::flywheel_rate);
    max_mps_ = held ? smaller(fastest_mps, max_mps_ + step_mps) : fastest_mps;
    const bool falls = reads_mps < slower_ * flywheel_.min && reading.valid && flywheel_.min > config_.plausible_above_mps;
    const bool jumps = reads_mps > faster_ * max_mps_ && reads_mps > config_.plausible_above_mps;
    if (!wrong.contains(Fault::flywheel_range)) wrong.insert(falls ? only(Fault::flywheel_stuck) : only(Fault::flywheel_rate, jumps));
    // A reading that stays for several periods counts once, otherwise its noise would count several times.
    if (reading.fresh || (reading.bounded && falls)) take_reading(flywheel_.reading, wrong, Fault::flywheel_lost);

    const bool stands = reading.speed_radps == 0.0F && e.omega_radps * e.radius_m > config_.plausible_above_mps;
    flywheel_.stays.take(only(Fault::flywheel_stuck, stands));
    faults.insert(flywheel_.reading.found());
    faults.insert(flywheel_.stays.found());
}

inline void Monitor::check_pressure(FaultSet& faults, const Sensors& sensors, const Estimator& estimator, const PreviousStep& previous) {
    const float reading = sensors.pressure.pressure_Pa;
    const float model = estimator.uncorrected_pressure_Pa();
    const Time at = sensors.pressure.received;
    if (at != last_reading_at_ && at != kNever) {
        const bool sensible = reading >= -released_Pa_ && reading <= config_.pressure_range_Pa;
        const float span = last_reading_at_ == kNever ? 0.0F : larger(seconds(at - last_reading_at_), period_s_);
        const bool jumps = span > 0.0F && magnitude(reading - last_reading_Pa_) > config_.pressure_rate_Paps * span;
        pressure_reading_.take(sensible ? only(Fault::pressure_rate, jumps) : only(Fault::pressure_range));
        last_reading_at_ = at;
        if (reading != last_reading_Pa_) model_at_change_Pa_ = model;
        last_reading_Pa_ = reading;
    }

    const bool frozen = magnitude(model - model_at_change_Pa_) > config_.pressure_moves_Pa;
    const bool off = magnitude(reading - model) > config_.off_command_Pa;
    // Without current the map has no tolerance: remaining pressure is a leak or a sticking spool, and may lock a wheel on ice.
    const ManeuverInput& maneuver = sensors.maneuver;
    const bool moving = estimator.estimate().v_mps > config_.plausible_above_mps;
    const bool matters = previous.rolling || (moving && maneuver.weight_on_wheels) || maneuver.arm;
    const bool remains = matters && model < 0.04F * released_Pa_ && reading > released_Pa_;
    // The offset that the pressure laws can compensate.
    const bool means_pressure = holds_slip(maneuver.law) || maneuver.law == Law::deceleration;
    const bool shifted = previous.braking && means_pressure && model > 2.0F * released_Pa_ &&
                         magnitude(estimator.valve_offset_Pa()) > larger(compensated_share_ * model, released_Pa_);
    pressure_stays_.take(frozen ? only(Fault::pressure_stuck) : only(Fault::pressure_off_command, off || remains || shifted));
    faults.insert(pressure_reading_.found());
    faults.insert(pressure_stays_.found());
}

/// Integrates slip above the reference, reduced by slip below it. A loop that swings with its valve comes back to the reference again and again;
/// speeds that disagree hold the slip up. Paused without pressure, because a released wheel on ice spins up slowly.
inline void Monitor::check_slip(FaultSet& faults, const ManeuverInput& maneuver, const Estimator& estimator, const PreviousStep& previous) {
    constexpr float kMax_s = 0.1F;
    const Estimate& e = estimator.estimate();
    if (!holds_slip(maneuver.law) || !previous.braking) {
        held_slip_ = 0.0F;
        excess_slip_s_ = 0.0F;
    } else if (estimator.uncorrected_pressure_Pa() >= config_.hardly_braked_Pa) {
        held_slip_ = smaller(e.slip, held_slip_ + (e.slip - held_slip_) * period_s_ / config_.stuck_s);
        excess_slip_s_ = larger(excess_slip_s_ + (held_slip_ - previous.slip_reference - kHeldWithin) * period_s_, 0.0F);
        if (excess_slip_s_ > kMax_s) faults.insert(Fault::speeds_disagree);
    }
}

void Monitor::check_maneuver(FaultSet& faults, const ManeuverInput& m) const {
    if (m.received == kNever) return;
    const bool sensible = m.demand_Pa >= 0.0F && m.demand_Pa <= config_.pressure_range_Pa && m.slip_reference >= 0.0F &&
                          m.slip_reference <= kMaxSlipReference && m.deceleration_mps2 >= 0.0F &&
                          m.deceleration_mps2 <= config_.max_deceleration_mps2 && m.current_mA >= 0.0F && m.current_mA <= config_.max_current_mA &&
                          static_cast<std::uint8_t>(m.law) < kLawCount;
    if (!sensible) faults.insert(Fault::maneuver_range);
}

inline void Monitor::check_overrun(FaultSet& faults, std::uint32_t missed_periods) {
    constexpr std::uint32_t kPaidBackBy = 10;  // good periods that make up for a missed one
    const std::uint32_t max = kPaidBackBy * config_.overruns;
    if (overrun_score_ > 0) --overrun_score_;
    overrun_score_ += kPaidBackBy * (missed_periods < max ? missed_periods : max);
    if (overrun_score_ > max) {
        faults.insert(Fault::overrun);
        overrun_score_ = max;
    }
}

FaultSet Monitor::check(const Sensors& sensors, const Estimator& estimator, const PreviousStep& previous, Time now) {
    FaultSet faults;
    check_arrivals(faults, sensors, now);
    check_wheel(faults, estimator, previous);
    check_flywheel(faults, estimator, previous.rolling && sensors.maneuver.arm);  // no drive turns it
    check_pressure(faults, sensors, estimator, previous);
    check_slip(faults, sensors.maneuver, estimator, previous);
    check_maneuver(faults, sensors.maneuver);
    check_overrun(faults, sensors.missed_periods);
    if (sensors.emergency_stop) faults.insert(Fault::emergency_stop);
    if (sensors.bus_off) faults.insert(Fault::bus_off);
    return faults;
}

}  // namespace antiskid::control
