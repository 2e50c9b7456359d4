#include "firmware/control/estimator.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

namespace {
constexpr float kSlowest_mps = 0.5F;            // slip divides by the speed
constexpr float kCalibrationSpeed_mps = 15.0F;  // free rolling below it is too short to average
constexpr float kFreePressure_Pa = 2e5F;
constexpr float kFreeAcceleration_radps2 = 60.0F;
constexpr float kRadiusMemory_s = 0.05F;
constexpr float kMostReading = 2.0F;  // times full pressure

/// A reading that cannot be (or is no number) must not reach a filter, where it would stay. The monitor names it.
SpeedReading usable(SpeedReading reading, float most_radps) {
    if (!(reading.speed_radps >= 0.0F && reading.speed_radps <= most_radps)) {
        reading.fresh = false;
        reading.bounded = false;
    }
    return reading;
}
}  // namespace

Estimator::Estimator(const WheelConfig& wheel, const FlywheelConfig& flywheel, const ValveConfig& valve,
                     const EstimatorConfig& estimator, const ObserverConfig& observer, float period_s)
    : wheel_(wheel),
      valve_(valve),
      flywheel_most_radps_(flywheel.encoder.max_speed_radps),
      flywheel_radius_m_(flywheel.radius_m),
      period_s_(period_s),
      brake_gain_(wheel.brake_gain_m3 / wheel.inertia_kgm2),
      lift_per_stiffness_(wheel.lift_Ns2pm2 / wheel.stiffness_Npm),
      wheel_speed_(wheel.encoder.teeth),
      flywheel_speed_(flywheel.encoder.teeth),
      observes_(observer.used),
      outlook_share_(observer.outlook_share),
      wheel_tracker_(estimator.wheel_bandwidth_radps, wheel.encoder.max_acceleration_radps2),
      wheel_observer_(observer, wheel.encoder, period_s),
      flywheel_tracker_(estimator.aircraft_bandwidth_radps, flywheel.encoder.max_acceleration_radps2),
      valve_model_(valve, period_s, estimator),
      standing_radius_m_(wheel.nominal_radius_m) {}

/// A wheel that rolls freely shows its radius: v / omega. Brake torque would show as slip, spin-up as
/// acceleration: both are waited out. In the air it turns at any speed.
inline void Estimator::calibrate_radius(bool on_wheels) {
    const Estimate& e = estimate_;
    const bool free = on_wheels && e.pressure.pressure_Pa < kFreePressure_Pa &&
                      e.v_mps > kCalibrationSpeed_mps && wheel_reading_.fresh &&
                      magnitude(road_radps2()) < kFreeAcceleration_radps2;
    if (!free) return;
    const float measured = e.v_mps / e.omega_radps - lift_per_stiffness_ * e.v_mps * e.v_mps;
    const float low = wheel_.nominal_radius_m * (1.0F - wheel_.radius_tolerance);
    const float high = wheel_.nominal_radius_m * (1.0F + wheel_.radius_tolerance);
    if (measured < low || measured > high) return;
    standing_radius_m_ += (measured - standing_radius_m_) * period_s_ / (kRadiusMemory_s + period_s_);
}

/// What the wheel does without the brake.
inline float Estimator::road_radps2() const {
    return observes_ ? wheel_observer_.motion().road_radps2 : wheel_tracker_.acceleration();
}

inline void Estimator::follow_wheel(const PressureState& before) {
    const PressureState& now = valve_model_.now();
    const SpeedReading reading = usable(wheel_reading_, wheel_.encoder.max_speed_radps);
    const float braking = brake_gain_ * 0.5F * (before.pressure_Pa + now.pressure_Pa);
    if (observes_) [[unlikely]] {
        wheel_observer_.update(reading, {.brake_radps2 = braking,
                                         .brake_now_radps2 = brake_gain_ * now.pressure_Pa,
                                         .steady_radps2 = steady_radps2_});
    } else {
        wheel_tracker_.update(reading, period_s_, -braking * period_s_, -brake_gain_ * now.pressure_Pa);
    }
}

/// The road's torque follows the slip meanwhile. Not inlined: the tracker's path would pay for its registers.
[[gnu::noinline]] float Estimator::observed_late_radps(float steady_radps2) {
    Estimate& e = estimate_;
    steady_radps2_ = steady_radps2;
    e.answer_per_s = wheel_observer_.answer_per_s();
    const float believed = e.answer_per_s > 0.0F ? outlook_share_ * e.answer_per_s : e.answer_per_s;
    WheelMotion late = wheel_observer_.motion();
    e.late_pressure = e.pressure;
    for (std::size_t period = 1; period <= valve_model_.delay_periods(); ++period) {
        const PressureState next = valve_model_.after(e.late_pressure, period);
        const float mean_Pa = 0.5F * (e.late_pressure.pressure_Pa + next.pressure_Pa);
        late = moved(late, brake_gain_ * mean_Pa, steady_radps2, believed, period_s_);
        e.late_pressure = next;
    }
    e.late_balance_Pa = larger(late.road_radps2 - steady_radps2, 0.0F) / brake_gain_;
    return late.omega_radps;
}

/// With what the road gives held.
inline float Estimator::tracked_late_radps() {
    const ValveModel::Outlook outlook = valve_model_.outlook();
    estimate_.late_pressure = outlook.end;
    return larger(estimate_.omega_radps + wheel_tracker_.acceleration() * valve_model_.delay_s() -
                      brake_gain_ * outlook.impulse_Pas,
                  0.0F);
}

/// Over the valve's delay, from commands already given.
inline void Estimator::look_ahead(float v_mps, float steady_radps2) {
    Estimate& e = estimate_;
    e.late_v_mps = larger(v_mps + e.v_dot_mps2 * valve_model_.delay_s(), kSlowest_mps);
    float late_omega = 0.0F;
    if (observes_) [[unlikely]]
        late_omega = observed_late_radps(steady_radps2);
    else
        late_omega = tracked_late_radps();
    e.late_slip = limited(1.0F - late_omega * e.radius_m / e.late_v_mps, -1.0F, 1.0F);
}

const Estimate& Estimator::update(const Sensors& sensors, float last_current_mA) {
    const PressureState before = valve_model_.now();
    const float measured_Pa = sensors.pressure.pressure_Pa;
    const bool fresh = sensors.pressure.received != pressure_received_ &&
                       magnitude(measured_Pa) <= kMostReading * valve_.full_pressure_Pa;
    valve_model_.update(valve_pressure_Pa(valve_, last_current_mA), measured_Pa, fresh);
    pressure_received_ = sensors.pressure.received;
    const PressureState pressure = valve_model_.now();

    flywheel_reading_ = flywheel_speed_.update(sensors.flywheel);
    wheel_reading_ = wheel_speed_.update(sensors.wheel);
    flywheel_tracker_.update(usable(flywheel_reading_, flywheel_most_radps_), period_s_, 0.0F, 0.0F);
    follow_wheel(before);

    Estimate& e = estimate_;
    e.speeds_known = wheel_reading_.valid && flywheel_reading_.valid;
    e.brake_gain = brake_gain_;
    e.v_mps = flywheel_tracker_.speed() * flywheel_radius_m_;
    e.v_dot_mps2 = flywheel_tracker_.acceleration() * flywheel_radius_m_;
    e.omega_radps = observes_ ? wheel_observer_.motion().omega_radps : wheel_tracker_.speed();
    e.omega_dot_radps2 = road_radps2() - brake_gain_ * pressure.pressure_Pa;
    e.pressure = pressure;
    calibrate_radius(sensors.maneuver.weight_on_wheels);

    const float v = larger(e.v_mps, kSlowest_mps);
    e.radius_m = standing_radius_m_ + lift_per_stiffness_ * v * v;
    e.slip = e.v_mps > kSlowest_mps ? limited(1.0F - e.omega_radps * e.radius_m / v, -1.0F, 1.0F) : 0.0F;
    // A constant slip needs omega_dot = omega v_dot / v; what the road gives beyond it, the brake must take.
    const float steady_radps2 = e.omega_radps * e.v_dot_mps2 / v;
    e.balance_Pa = larger(road_radps2() - steady_radps2, 0.0F) / brake_gain_;
    look_ahead(v, steady_radps2);
    return e;
}

}  // namespace antiskid::control
