#include "firmware/control/estimator.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

namespace {
constexpr float kSlowest_mps = 0.5F;  // slip divides by the speed
constexpr float kCalibrates = 3.0F;   // times the drop-out speed: free rolling below it is too short to average
constexpr float kFreeAcceleration_radps2 = 60.0F;
constexpr float kRadiusMemory_s = 0.05F;
constexpr float kMaxReading = 2.0F;  // times full pressure
}  // namespace

Estimator::Estimator(const Config& config)
    : wheel_(config.wheel),
      max_reading_Pa_(kMaxReading * config.valve.full_pressure_Pa),
      free_Pa_(config.supervisor.demand_threshold_Pa),
      calibrates_above_mps_(kCalibrates * config.supervisor.drop_out_mps),
      flywheel_radius_m_(config.flywheel.radius_m),
      period_s_(config.period_s),
      brake_gain_(config.wheel.brake_gain_m3 / config.wheel.inertia_kgm2),
      half_gain_(0.5F * brake_gain_),
      lift_per_stiffness_(config.wheel.lift_Ns2pm2 / config.wheel.stiffness_Npm),
      wheel_speed_(config.wheel.encoder.teeth),
      flywheel_speed_(config.flywheel.encoder.teeth),
      wheel_observer_(config.observer, config.wheel, config.period_s),
      prediction_share_(config.observer.prediction_share),
      flywheel_tracker_(config.estimator.aircraft_bandwidth_radps, config.flywheel.encoder),
      valve_model_(config.valve, config.period_s, config.estimator),
      standing_radius_m_(config.wheel.nominal_radius_m) {
    estimate_.brake_gain = brake_gain_;
}

/// A wheel that rolls freely shows its radius: v / omega. Not during braking (slip) or spin-up (acceleration), and not in the air, where it turns at
/// any speed.
inline void Estimator::calibrate_radius(bool on_wheels) {
    const Estimate& e = estimate_;
    const bool free = on_wheels && e.pressure.pressure_Pa < free_Pa_ && e.v_mps > calibrates_above_mps_ && wheel_reading_.fresh &&
                      magnitude(wheel_observer_.motion().road_radps2) < kFreeAcceleration_radps2;
    if (!free) return;
    const float measured = e.v_mps / e.omega_radps - lift_per_stiffness_ * e.v_mps * e.v_mps;
    const float low = wheel_.nominal_radius_m * (1.0F - wheel_.radius_tolerance);
    const float high = wheel_.nominal_radius_m * (1.0F + wheel_.radius_tolerance);
    if (measured < low || measured > high) return;
    standing_radius_m_ += (measured - standing_radius_m_) * period_s_ / (kRadiusMemory_s + period_s_);
}

/// Over the valve's delay, from commands already given. The road's torque follows the slip meanwhile.
inline void Estimator::look_ahead(float v_mps) {
    Estimate& e = estimate_;
    const float believed = e.wheel_pole_radps > 0.0F ? prediction_share_ * e.wheel_pole_radps : e.wheel_pole_radps;
    // As repeated WheelSteps with the speed changes added up: a wheel that would stop in between stops at the end.
    const WheelStep step(believed, period_s_);
    const float follows = believed * step.acting_s();
    WheelMotion late = wheel_observer_.motion();
    PressureState pressure = e.pressure;
    float excess_radps2 = 0.0F;
    for (std::size_t period = 1; period <= valve_model_.delay_periods(); ++period) {
        const PressureState next = valve_model_.after(pressure, period);
        const float excess = late.road_radps2 - half_gain_ * (pressure.pressure_Pa + next.pressure_Pa) - steady_radps2_;
        late.road_radps2 -= follows * excess;
        excess_radps2 += excess;
        pressure = next;
    }
    late.omega_radps = larger(late.omega_radps + step.acting_s() * excess_radps2 + steady_radps2_ * valve_model_.delay_s(), 0.0F);
    e.late_pressure = pressure;
    e.late_v_mps = larger(v_mps + e.v_dot_mps2 * valve_model_.delay_s(), kSlowest_mps);
    e.late_balance_Pa = larger(late.road_radps2 - steady_radps2_, 0.0F) / brake_gain_;
    e.late_slip = limited(1.0F - late.omega_radps * e.radius_m / e.late_v_mps, -1.0F, 1.0F);
}

const Estimate& Estimator::update(const Sensors& sensors, float held_Pa) {
    const float before_Pa = valve_model_.now().pressure_Pa;
    const float measured_Pa = sensors.pressure.pressure_Pa;
    const bool fresh = sensors.pressure.received != pressure_received_ && magnitude(measured_Pa) <= max_reading_Pa_;
    valve_model_.update(held_Pa, measured_Pa, fresh);
    pressure_received_ = sensors.pressure.received;
    const PressureState pressure = valve_model_.now();

    flywheel_reading_ = flywheel_speed_.update(sensors.flywheel);
    wheel_reading_ = wheel_speed_.update(sensors.wheel);
    flywheel_tracker_.update(flywheel_reading_, period_s_);
    wheel_observer_.update(wheel_reading_, {.brake_radps2 = half_gain_ * (before_Pa + pressure.pressure_Pa),
                                            .brake_now_radps2 = brake_gain_ * pressure.pressure_Pa,
                                            .steady_radps2 = steady_radps2_});

    Estimate& e = estimate_;
    e.speeds_known = wheel_reading_.valid && flywheel_reading_.valid;
    e.v_mps = flywheel_tracker_.speed() * flywheel_radius_m_;
    e.v_dot_mps2 = flywheel_tracker_.acceleration() * flywheel_radius_m_;
    e.omega_radps = wheel_observer_.motion().omega_radps;
    e.omega_dot_radps2 = wheel_observer_.motion().road_radps2 - brake_gain_ * pressure.pressure_Pa;
    e.wheel_pole_radps = wheel_observer_.wheel_pole_radps();
    e.wheel_pole_variance_radps2 = wheel_observer_.wheel_pole_variance_radps2();
    e.road_radps2 = wheel_observer_.motion().road_radps2;
    e.another_road = wheel_observer_.another_road();
    e.pressure = pressure;
    calibrate_radius(sensors.maneuver.weight_on_wheels);

    const float v = larger(e.v_mps, kSlowest_mps);
    e.radius_m = standing_radius_m_ + lift_per_stiffness_ * v * v;
    e.slip = e.v_mps > kSlowest_mps ? limited(1.0F - e.omega_radps * e.radius_m / v, -1.0F, 1.0F) : 0.0F;
    // A constant slip needs omega_dot = omega v_dot / v; what the road gives beyond it, the brake must take.
    steady_radps2_ = e.omega_radps * e.v_dot_mps2 / v;
    look_ahead(v);
    return e;
}

}  // namespace antiskid::control
