#include "firmware/control/monitor.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

namespace {
/// Compared as it is: a difference of times as a float costs a Cortex-M7 some twenty instructions.
Time nanoseconds(float time_s) {
    return Time{static_cast<std::int64_t>(time_s * 1e9F)};
}
// Whatever the runway, a wheel that slips steadily would need more torque than this to stay there.
constexpr float kHardlyBraked_Pa = 1e5F;
constexpr float kCommandPeriod_s = 0.01F;  // no sequencer commands faster; config/antiskid.dbc: 20 ms
}  // namespace

Monitor::Arrival::Arrival(float max_age_s, float frame_period_s)
    : max_age(nanoseconds(max_age_s)), most_refused(max_age_s / frame_period_s + 0.5F) {}

Monitor::Monitor(const Config& config)
    : config_(config.monitor),
      wheel_encoder_(config.wheel.encoder),
      flywheel_encoder_(config.flywheel.encoder),
      flywheel_radius_m_(config.flywheel.radius_m),
      released_Pa_(config.supervisor.residual_pressure_Pa),
      period_s_(config.period_s),
      made_up_for_share_(config.estimator.valve_offset_share),
      wheel_(config.monitor.sensor_max_age_s, config.period_s),
      flywheel_(config.monitor.sensor_max_age_s, config.period_s),
      pressure_(config.monitor.sensor_max_age_s, config.period_s),
      maneuver_(config.monitor.maneuver_max_age_s, kCommandPeriod_s),
      heartbeat_max_age_(nanoseconds(config.monitor.heartbeat_max_age_s)),
      wheel_speed_(config.monitor.implausible_s, config.period_s),
      flywheel_speed_(config.monitor.implausible_s, config.period_s),
      pressure_range_(config.monitor.implausible_s, config.period_s),
      pressure_rate_(config.monitor.implausible_s, config.period_s),
      pressure_off_(config.monitor.off_command_s, config.period_s),
      valve_off_(config.monitor.stuck_s, config.period_s),
      free_slip_(config.monitor.stuck_s, config.period_s),
      pressure_stuck_(config.monitor.stuck_s, config.period_s),
      pressure_stays_(config.monitor.off_command_s, config.period_s),
      wheel_stuck_(config.monitor.stuck_s, config.period_s),
      flywheel_stuck_(config.monitor.stuck_s, config.period_s),
      flywheel_blind_(config.monitor.implausible_s, config.period_s),
      flywheel_leaps_(config.monitor.implausible_s, config.period_s),
      overspeed_(config.monitor.stuck_s, config.period_s) {}

Monitor::Arrival::Verdict Monitor::Arrival::judge(Time newest, std::uint32_t rejected_now, Time now) {
    // Of frames that mostly fail their checks some pass by chance: what they say is worth nothing. A repeat of each good one is harmless.
    if (const std::uint32_t more = rejected_now - rejected_before; more != 0) {
        rejected_before = rejected_now;
        constexpr std::uint32_t kCountWentBack = 1U << 31U;
        if (more < kCountWentBack) refused = smaller(refused + static_cast<float>(more), 2.0F * most_refused);
    }
    if (newest != received) {
        received = newest;
        rejected = rejected_now;
        refused = larger(refused - 1.0F, 0.0F);
    }
    if (refused > most_refused) return Verdict::corrupt;
    if (newest != kNever && now - newest <= max_age) return Verdict::good;
    return rejected_now != rejected ? Verdict::corrupt : Verdict::lost;
}

void Monitor::check_arrivals(FaultSet& faults, const Sensors& sensors, Time now) {
    const auto name = [&faults](Arrival::Verdict verdict, Fault lost, Fault corrupt) {
        if (verdict == Arrival::Verdict::lost) faults.insert(lost);
        if (verdict == Arrival::Verdict::corrupt) faults.insert(corrupt);
    };
    name(wheel_.judge(sensors.wheel.received, sensors.wheel.rejected, now), Fault::wheel_lost,
         Fault::wheel_corrupt);
    name(flywheel_.judge(sensors.flywheel.received, sensors.flywheel.rejected, now), Fault::flywheel_lost,
         Fault::flywheel_corrupt);
    name(pressure_.judge(sensors.pressure.received, sensors.pressure.rejected, now), Fault::pressure_lost,
         Fault::pressure_corrupt);
    name(maneuver_.judge(sensors.maneuver.received, sensors.maneuver.rejected, now), Fault::maneuver_lost,
         Fault::maneuver_corrupt);
    const Time heartbeat = sensors.rig_heartbeat_received;
    if (heartbeat == kNever || now - heartbeat > heartbeat_max_age_) faults.insert(Fault::heartbeat_lost);
}

void Monitor::check_speed(FaultSet& faults, SpeedCheck& check, const SpeedReading& reading,
                          const EncoderConfig& encoder, Fault lost, Fault range, Fault rate) const {
    const float speed = reading.speed_radps;
    const bool sensible = speed >= 0.0F && speed <= encoder.max_speed_radps;  // false for NaN
    if (reading.fresh) {
        check.ranges = check.range.holds(!sensible);
        check.lags = check.late.holds(reading.late);
    }
    if (check.lags) faults.insert(lost);
    if (check.ranges) faults.insert(range);

    // A reading is a mean over its interval: two of them in a row cannot differ by more than the acceleration
    // times that.
    const float span = larger(reading.interval_s, period_s_);
    // Each is off by two misplaced teeth at the most; all four at their worst do not come together.
    constexpr float kThreePitches = 3.0F * 6.28318531F;
    const float beyond = magnitude(speed - check.last_radps) - encoder.max_acceleration_radps2 * span;
    const bool jumps = beyond > 0.0F && check.known && sensible &&
                       beyond * span * encoder.teeth > kThreePitches * encoder.pitch_error;
    if (reading.fresh && sensible) {
        check.jumps = check.rate.holds(jumps);
        check.last_radps = speed;
    }
    if (check.jumps) faults.insert(rate);
    check.known = reading.valid;
}

void Monitor::check_pressure(FaultSet& faults, const Sensors& sensors, const Estimator& estimator) {
    const float reading = sensors.pressure.pressure_Pa;
    const bool sensible = reading >= -released_Pa_ && reading <= config_.pressure_range_Pa;
    if (pressure_range_.holds(!sensible)) faults.insert(Fault::pressure_range);

    const Time at = sensors.pressure.received;
    const bool fresh = at != last_reading_at_ && at != kNever;
    if (fresh) {
        const float span =
            last_reading_at_ == kNever ? 0.0F : larger(seconds(at - last_reading_at_), period_s_);
        const bool jumps =
            span > 0.0F && magnitude(reading - last_reading_Pa_) > config_.pressure_rate_Paps * span;
        pressure_jumps_ = pressure_rate_.holds(jumps);
        last_reading_at_ = at;
    }
    if (pressure_jumps_) faults.insert(Fault::pressure_rate);

    const float model = estimator.uncorrected_pressure_Pa();
    if (fresh && reading != last_reading_Pa_) {
        last_reading_Pa_ = reading;
        model_at_change_Pa_ = model;
    }
    const bool frozen = magnitude(model - model_at_change_Pa_) > config_.pressure_moves_Pa;
    if (pressure_stuck_.holds(frozen)) faults.insert(Fault::pressure_stuck);

    const bool off = magnitude(reading - model) > config_.off_command_Pa;
    if (pressure_off_.holds(off)) faults.insert(Fault::pressure_off_command);
}

void Monitor::check_plausibility(FaultSet& faults, const Sensors& sensors, const Estimator& estimator,
                                 bool rolling) {
    const Estimate& e = estimator.estimate();
    const float rim = e.omega_radps * e.radius_m;
    const bool moving = e.v_mps > config_.plausible_above_mps;
    // By the command, not by the reading: on ice the braking pressure itself is within the transducer's
    // error.
    constexpr float kReleased_Pa = 2e4F;
    constexpr float kSteady_mps2 = 15.0F;  // a wheel that spins up again slips legitimately
    const float model_Pa = estimator.uncorrected_pressure_Pa();
    const bool released = model_Pa < kReleased_Pa;

    // No current has no tolerance of the valve's map: what stays then is a leak or a spool that sticks, and enough to lock a wheel on ice.
    const bool loaded = rolling || (moving && sensors.maneuver.weight_on_wheels);
    const bool stays =
        (loaded || sensors.maneuver.arm) && released && sensors.pressure.pressure_Pa > released_Pa_;
    if (pressure_stays_.holds(stays)) faults.insert(Fault::pressure_off_command);

    const bool wheel_stands = rolling && moving && released && estimator.wheel_reading().speed_radps == 0.0F;
    if (wheel_stuck_.holds(wheel_stands)) faults.insert(Fault::wheel_stuck);
    // An encoder that dies or leaps at speed must be found before the law believes it: it would lock the wheel, and then both
    // encoders agree, or hardly brake. Neither one wild reading nor the tracker's overshoot after it may count as a speed that was.
    constexpr float kHardest_mps2 = 20.0F;  // twice what the best tyre can do
    const SpeedReading& flywheel = estimator.flywheel_reading();
    const float reads_mps = flywheel.speed_radps * flywheel_radius_m_;
    const float most_mps = flywheel_encoder_.max_speed_radps * flywheel_radius_m_;
    carried_mps_ =
        larger(smaller(smaller(reads_mps, e.v_mps), most_mps), carried_mps_ - kHardest_mps2 * period_s_);
    const bool falls = flywheel.valid && reads_mps >= 0.0F && carried_mps_ > config_.plausible_above_mps &&
                       reads_mps < (1.0F - config_.overspeed_share) * carried_mps_;
    // A reading that stays for periods is one reading: noise must not count for more than it is.
    const bool news = flywheel.fresh || flywheel.bounded;
    if (news) blind_ = flywheel_blind_.holds(falls);
    const bool stands = flywheel.speed_radps == 0.0F && rim > config_.plausible_above_mps;
    const bool stuck = flywheel_stuck_.holds(stands);
    if (blind_ || stuck) faults.insert(Fault::flywheel_stuck);

    constexpr float kThrust_mps2 = 2.0F;
    const bool lands = rolling && sensors.maneuver.arm;  // no drive turns the flywheel
    const float fastest_mps = larger(reads_mps, e.v_mps);
    reached_mps_ =
        lands && !leaps_ ? smaller(fastest_mps, reached_mps_ + kThrust_mps2 * period_s_) : fastest_mps;
    const bool leaps = lands && reads_mps > config_.plausible_above_mps && reads_mps <= most_mps &&
                       reads_mps > (1.0F + config_.overspeed_share) * reached_mps_;
    if (news) leaps_ = flywheel_leaps_.holds(leaps);
    if (leaps_) faults.insert(Fault::flywheel_rate);

    const bool overspeed =
        rim > e.v_mps * (1.0F + config_.overspeed_share) && rim > config_.plausible_above_mps;
    const bool overspeeds = overspeed_.holds(overspeed);
    const bool steady = magnitude(e.omega_dot_radps2) * e.radius_m < kSteady_mps2;
    const bool hardly_braked = model_Pa < kHardlyBraked_Pa;
    const bool slips_freely =
        rolling && moving && hardly_braked && steady && !wheel_stands && e.slip > config_.free_slip;
    const bool disagrees = free_slip_.holds(slips_freely);
    if (overspeeds || disagrees) faults.insert(Fault::speeds_disagree);
}

/// What the laws that mean a pressure make of it.
void Monitor::check_law(FaultSet& faults, const ManeuverInput& maneuver, const Estimator& estimator,
                        const Before& before) {
    // Slip above what is asked for adds up, slip below it pays back: no sound loop is above it for long, on any surface. Without pressure
    // it does neither: on ice a released wheel takes its time.
    constexpr float kMore = 0.05F;
    constexpr float kMost_s = 0.1F;
    const bool by_slip = holds_slip(maneuver.law);
    const float model_Pa = estimator.uncorrected_pressure_Pa();
    if (!by_slip || !before.braking) excess_slip_s_ = 0.0F;
    if (by_slip && before.braking && model_Pa >= kHardlyBraked_Pa) {
        const float excess = estimator.estimate().slip - before.slip_reference - kMore;
        excess_slip_s_ = larger(excess_slip_s_ + excess * period_s_, 0.0F);
        if (excess_slip_s_ > kMost_s) faults.insert(Fault::speeds_disagree);
    }

    const float offset_Pa = magnitude(estimator.valve_offset_Pa());
    const bool means_pressure = by_slip || maneuver.law == Law::deceleration;
    const bool off = before.braking && means_pressure && model_Pa > 2.0F * released_Pa_ &&
                     offset_Pa > larger(made_up_for_share_ * model_Pa, released_Pa_);
    if (valve_off_.holds(off)) faults.insert(Fault::pressure_off_command);
}

void Monitor::check_maneuver(FaultSet& faults, const ManeuverInput& m) const {
    if (m.received == kNever) return;
    const bool sensible = m.demand_Pa >= 0.0F && m.demand_Pa <= config_.pressure_range_Pa &&
                          m.slip_reference >= 0.0F && m.slip_reference <= 0.5F &&
                          m.deceleration_mps2 >= 0.0F &&
                          m.deceleration_mps2 <= config_.most_deceleration_mps2 && m.current_mA >= 0.0F &&
                          m.current_mA <= 100.0F && static_cast<std::uint8_t>(m.law) < kLawCount;
    if (!sensible) faults.insert(Fault::maneuver_range);
}

FaultSet Monitor::check(const Sensors& sensors, const Estimator& estimator, const Before& before, Time now) {
    FaultSet faults;
    check_arrivals(faults, sensors, now);
    check_speed(faults, wheel_speed_, estimator.wheel_reading(), wheel_encoder_, Fault::wheel_lost,
                Fault::wheel_range, Fault::wheel_rate);
    check_speed(faults, flywheel_speed_, estimator.flywheel_reading(), flywheel_encoder_,
                Fault::flywheel_lost, Fault::flywheel_range, Fault::flywheel_rate);
    check_pressure(faults, sensors, estimator);
    check_plausibility(faults, sensors, estimator, before.rolling);
    check_law(faults, sensors.maneuver, estimator, before);
    check_maneuver(faults, sensors.maneuver);
    if (sensors.emergency_stop) faults.insert(Fault::emergency_stop);
    if (sensors.bus_off) faults.insert(Fault::bus_off);

    constexpr std::uint32_t kPaidBackBy = 10;  // good periods that make up for a missed one
    const std::uint32_t most = kPaidBackBy * config_.overruns;
    if (overrun_score_ > 0) --overrun_score_;
    overrun_score_ += kPaidBackBy * (sensors.missed_periods < most ? sensors.missed_periods : most);
    if (overrun_score_ > most) {
        faults.insert(Fault::overrun);
        overrun_score_ = most;
    }
    return faults;
}

}  // namespace antiskid::control
