/// Every number of the controller. Loaded and range-checked from config/controller.toml by the programs; a
/// microcontroller compiles it in. The controller trusts these values: whoever fills the struct validates it.
/// Ranges and sources stand in config/controller.toml.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace antiskid::control {

/// A toothed encoder and what its speed may plausibly do.
struct EncoderConfig {
    float teeth = 0.0F;
    float max_speed_radps = 0.0F;
    float max_acceleration_radps2 = 0.0F;  ///< above this between two frames the reading is implausible
    float pitch_error = 0.0F;              ///< of a sound ring's teeth, of their pitch: what a reading may be off by it is not implausible
    float patience_s = 0.0F;               ///< without a reading that is believed: then it is the prediction that is wrong
};

/// Rolling radius r(F_z) = r_0 - F_z / k_r with eq. (2): a free-rolling wheel before brake-on calibrates it,
/// lift carries it on.
struct WheelConfig {
    EncoderConfig encoder;
    float inertia_kgm2 = 0.0F;      ///< J_w
    float nominal_radius_m = 0.0F;  ///< used until the wheel has rolled freely
    float radius_tolerance = 0.0F;  ///< calibrated radius stays within this fraction of the nominal one
    float stiffness_Npm = 0.0F;     ///< k_r
    float lift_Ns2pm2 = 0.0F;       ///< rho S C_l / 2 of eq. (2)
    float brake_gain_m3 = 0.0F;     ///< nominal k_b
    float hardest_brake = 0.0F;     ///< no brake grips harder than so many times that
};

struct FlywheelConfig {
    EncoderConfig encoder;
    float radius_m = 0.0F;  ///< R_f
};

struct ValveConfig {
    static constexpr std::size_t kMaxPoints = 16;
    std::uint8_t points = 0;                      ///< points in use, 2 to 16
    std::array<float, kMaxPoints> current_mA{};   ///< strictly increasing
    std::array<float, kMaxPoints> pressure_Pa{};  ///< strictly increasing
    float natural_frequency_radps = 0.0F;         ///< omega_n, eq. (6)
    float damping = 0.0F;                         ///< xi
    float delay_s = 0.0F;                         ///< tau, at most 16 periods
    float safe_current_mA = 0.0F;                 ///< no pressure
    float full_pressure_Pa = 0.0F;
};

/// Bandwidths of the other estimators, rad/s.
struct EstimatorConfig {
    float aircraft_bandwidth_radps = 0.0F;  ///< speed and deceleration from the flywheel encoder
    float pressure_bandwidth_radps = 0.0F;  ///< correction of the valve model by the transducer
    float valve_offset_radps = 0.0F;        ///< at which the valve's offset from its map is learnt; 0: never
    float valve_offset_share = 0.0F;        ///< of the pressure asked for: more is not made up for
};

/// The wheel's observer, wheel_observer.hpp.
struct ObserverConfig {
    float reading_noise = 0.0F;       ///< standard deviation of a reading, of the encoder's pitch over the time that it took
    float road_noise_radps2 = 0.0F;   ///< random walk of the road's torque as wheel acceleration, in the root of a second
    float answer_noise = 0.0F;        ///< random walk of the road's answer, of itself and the floor, in the root of a second; 0: the
                                      ///< answer is not learnt
    float answer_floor_per_s = 0.0F;  ///< as uncertain as this is an answer of zero; the filter starts at half of it
    float surprise = 0.0F;            ///< standard deviations by which readings are off to one side on another road
    float prediction_share = 0.0F;    ///< of a restoring answer that is believed over the valve's delay, 0 to 1
};

/// PID on predicted slip. Gains act on slip rate (1/s): the law multiplies by J v / (r k_b), which is the
/// schedule with speed.
struct SlipConfig {
    float k_p_per_s = 0.0F;
    float k_i_per_s2 = 0.0F;
    float k_d = 0.0F;                    ///< on the slip rate
    float k_dd_s = 0.0F;                 ///< on the rate of the slip rate, which the valve model gives without differentiation
    float k_answer = 0.0F;               ///< added to k_p: this share of a restoring answer
    float max_slip_rate_per_s = 0.0F;    ///< asked for at most: the pressure above balance that a slippery runway meets
    float earliest_peak_slip = 0.0F;     ///< no runway's friction has its peak before: up to here the road restores the slip
    float early_slip_rate_per_s = 0.0F;  ///< asked for at most without slip; falls to max_slip_rate_per_s there
    float reference_rate_per_s = 0.0F;   ///< the reference in force follows a change at this rate
    float low_speed_mps = 0.0F;          ///< below it the reference falls with speed; 0: the paper's exact law
    float low_speed_floor_mps = 0.0F;    ///< at and below it the reference is `low_speed_slip` at the most
    float low_speed_slip = 0.0F;

    // The share of the reference that is in force is the integral of rise_per_s (answer + runaway_per_s) / answer_scale_per_s, which
    // exceeds rise_per_s at no time.
    float runaway_per_s = 0.0F;  ///< a wheel that runs away as fast as this is still held
    float restless_slip = 0.0F;  ///< no fall while the slip stays so near the reference: it is held, whatever the answer seems to be
    float answer_scale_per_s = 0.0F;
    float answer_filter_radps = 0.0F;
    float rise_per_s = 0.0F;
    /// The share falls by this for each 1 of slip that is beyond 0.05 above the reference in force.
    float excess_fall_per_s = 0.0F;
};

/// The search for the slip of most friction, peak_seeker.hpp.
struct PeakConfig {
    float start_slip = 0.0F;  ///< sought from here at brake-on, and on another road if less was in force
    float min_slip = 0.0F;
    float max_slip = 0.0F;
    float elasticity = 0.0F;       ///< asked for, of friction over slip: 0 is the peak, above it less slip
    float swing = 0.0F;            ///< of the reference, of itself: without it the road tells nothing
    float swing_Hz = 0.0F;         ///< below what the loop can follow, above how fast the load changes
    float filter_radps = 0.0F;     ///< of the elasticity
    float gain = 0.0F;             ///< share of `rate_per_s` for an elasticity of 1; the whole of it at most
    float rate_per_s = 0.0F;       ///< the reference changes by this share of itself at most
    float lock_fall_per_s = 0.0F;  ///< and falls so while the wheel slips by more than 0.6
    float min_speed_mps = 0.0F;    ///< below it nothing is sought
};

/// Wheel deceleration law: PI on the wheel's rim deceleration; the slip law with `slip_limit` is its
/// anti-skid ceiling.
struct DecelerationConfig {
    float k_p_Pa_per_mps2 = 0.0F;
    float k_i_Pa_per_m_per_s = 0.0F;  ///< Pa per (m/s2 s)
    float filter_radps = 0.0F;        ///< of the measured deceleration
    float onset_mps3 = 0.0F;          ///< the reference rises at this rate
    float slip_limit = 0.0F;
    float drop_out_mps = 0.0F;  ///< below it the last pressure is held to standstill
};

/// The switching baseline: INCREASE, HOLD and DECREASE on slip and wheel deceleration.
struct ThresholdConfig {
    float first_rise_Paps = 0.0F;         ///< INCREASE until the first skid
    float rise_Paps = 0.0F;               ///< INCREASE after it
    float fall_Paps = 0.0F;               ///< DECREASE
    float slip_high = 0.0F;               ///< above: DECREASE
    float deceleration_high_mps2 = 0.0F;  ///< wheel rim deceleration beyond which a skid begins: DECREASE
    float acceleration_high_mps2 = 0.0F;  ///< wheel rim acceleration at which the wheel recovers: DECREASE ends in HOLD
    float slip_low = 0.0F;                ///< below: HOLD ends in INCREASE
    float restore_share = 0.0F;           ///< INCREASE starts at this share of the pressure at which the last skid began
};

/// Pressure-bias modulation: what is taken off the demand for velocity error, its integral and the wheel's deceleration.
struct PressureBiasConfig {
    float reference_fall_mps2 = 0.0F;     ///< the reference speed follows the wheel down no faster
    float dead_band_mps = 0.0F;           ///< velocity error up to which the wheel does not skid
    float k_transient_Pa_per_mps = 0.0F;  ///< of the error beyond it, at once
    float k_bias_Pa_per_m = 0.0F;         ///< of its integral: the bias
    float first_bleed_Paps = 0.0F;        ///< the bias of the start bleeds off so until the first skid
    float bleed_Paps = 0.0F;              ///< and so after it, while the wheel does not skid
    float max_bias_share = 0.0F;          ///< of the demand
    float lead_dead_band_mps2 = 0.0F;     ///< rim deceleration up to which there is no lead
    float k_lead_Pa_per_mps2 = 0.0F;      ///< of the deceleration beyond it
};

/// States and their thresholds.
struct SupervisorConfig {
    float self_test_s = 0.0F;           ///< every input good and the wheel at rest for this long
    float residual_pressure_Pa = 0.0F;  ///< largest reading that counts as no pressure
    float spin_up_mps = 0.0F;           ///< touchdown protection ends at this rim speed of the wheel
    float touchdown_timeout_s = 0.0F;   ///< or after this time on the wheels
    float demand_threshold_Pa = 0.0F;   ///< a smaller demand is none
    float lock_share = 0.0F;            ///< rim speed below this share of the aircraft's: locked, dump
    float unlock_share = 0.0F;          ///< above it: restore
    float min_spin_up_mps2 = 0.0F;      ///< of a released wheel's rim on the slipperiest runway, mu F_z r^2 / J_w
    float release_s = 0.0F;             ///< until the valve has let go and an edge can show it
    float drop_out_mps = 0.0F;          ///< below it the demand passes through
    float drop_out_hysteresis_mps = 0.0F;
    float pass_through_rate_Paps = 0.0F;  ///< at most
};

/// Limits of the input checks. Each fault's condition is in monitor.hpp.
struct MonitorConfig {
    float sensor_max_age_s = 0.0F;
    float maneuver_max_age_s = 0.0F;
    float heartbeat_max_age_s = 0.0F;
    float implausible_s = 0.0F;  ///< range, rate and plausibility conditions last this long before they are a fault
    float stuck_s = 0.0F;
    float pressure_range_Pa = 0.0F;
    float pressure_rate_Paps = 0.0F;
    float pressure_moves_Pa = 0.0F;  ///< a modelled change by this much must show in the reading
    float overspeed_share = 0.0F;    ///< rim speed of the wheel above the aircraft's by this share; leap of the aircraft's own speed
    float free_slip = 0.0F;          ///< steady slip of a wheel that is hardly braked
    float off_command_Pa = 0.0F;
    float off_command_s = 0.0F;
    float plausible_above_mps = 0.0F;    ///< speeds are compared above it
    std::uint16_t overruns = 0;          ///< missed periods in quick succession: ten good ones pay for each
    float max_deceleration_mps2 = 0.0F;  ///< largest reference that is accepted
};

struct Config {
    float period_s = 0.0F;  ///< 1e-3 to 5e-3
    WheelConfig wheel;
    FlywheelConfig flywheel;
    ValveConfig valve;
    EstimatorConfig estimator;
    ObserverConfig observer;
    SlipConfig slip;
    PeakConfig peak;
    DecelerationConfig deceleration;
    ThresholdConfig threshold;
    PressureBiasConfig pressure_bias;
    SupervisorConfig supervisor;
    MonitorConfig monitor;
};

}  // namespace antiskid::control
