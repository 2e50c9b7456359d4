/// Every number of the controller. Loaded and range-checked from config/controller.toml by the programs; a
/// microcontroller compiles it in. The controller does not check these values: the code that fills the struct must. Ranges and sources:
/// config/controller.toml.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace antiskid::control {

/// A toothed encoder and the plausible range of its speed.
struct EncoderConfig {
    float teeth = 0.0F;
    float max_speed_radps = 0.0F;
    float max_acceleration_radps2 = 0.0F;  ///< above this between two frames the reading is implausible
    float pitch_error = 0.0F;              ///< of a sound toothed ring, as share of the pitch; readings are allowed an error of this size
    float reject_timeout_s = 0.0F;         ///< after this time without an accepted reading the prediction is taken to be wrong, and restarted
};

/// Rolling radius r(F_z) = r_0 - F_z / k_r with eq. (2): calibrated by the free-rolling wheel before brake-on, then updated for lift.
struct WheelConfig {
    EncoderConfig encoder;
    float inertia_kgm2 = 0.0F;      ///< J_w
    float nominal_radius_m = 0.0F;  ///< used until the wheel has rolled freely
    float radius_tolerance = 0.0F;  ///< the calibrated radius is limited to the nominal one, within this share
    float stiffness_Npm = 0.0F;     ///< k_r
    float lift_Ns2pm2 = 0.0F;       ///< rho S C_l / 2 of eq. (2)
    float brake_gain_m3 = 0.0F;     ///< nominal k_b
    float hardest_brake = 0.0F;     ///< largest possible brake gain, as multiple of `brake_gain_m3`
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
    float valve_offset_radps = 0.0F;        ///< bandwidth at which the valve's offset from its map is learnt; 0: never
    float valve_offset_share = 0.0F;        ///< largest offset that is compensated, as share of the requested pressure
};

/// Settings of the wheel's observer, wheel_observer.hpp.
struct ObserverConfig {
    float reading_noise = 0.0F;        ///< standard deviation of the edge positions of a reading, as share of the encoder's pitch
    float road_noise_radps2 = 0.0F;    ///< random walk of the road torque as wheel acceleration, per root of a second
    float pole_noise = 0.0F;           ///< random walk of the wheel's pole, relative to itself plus the floor, per root of a second; 0: the
                                       ///< pole is not learnt
    float pole_floor_radps = 0.0F;     ///< uncertainty of a pole of zero; the filter starts with half of it
    float max_mean_innovation = 0.0F;  ///< mean innovation of the readings, in standard deviations, beyond which the wheel is on another road
    float prediction_share = 0.0F;     ///< share of a stable pole that is used for the prediction over the valve's delay, 0 to 1
};

/// PID on predicted slip. Gains act on slip rate (1/s): the law multiplies by J v / (r k_b), which is the
/// schedule with speed.
struct SlipConfig {
    float k_p_per_s = 0.0F;
    float k_i_per_s2 = 0.0F;
    float k_d = 0.0F;                    ///< on the slip rate
    float k_dd_s = 0.0F;                 ///< on the second derivative of slip, which the valve model gives without differentiation
    float k_pole = 0.0F;                 ///< added to k_p: this share of a stable pole
    float max_slip_rate_per_s = 0.0F;    ///< largest slip rate requested: limits the pressure above balance when the runway becomes slippery
    float earliest_peak_slip = 0.0F;     ///< friction of every runway peaks at a larger slip: up to here the road is restoring
    float early_slip_rate_per_s = 0.0F;  ///< largest slip rate requested at zero slip; falls to max_slip_rate_per_s at earliest_peak_slip
    float reference_rate_per_s = 0.0F;   ///< the reference in force follows a change at this rate
    float low_speed_mps = 0.0F;          ///< below it the reference falls with speed; 0: the paper's exact law
    float low_speed_floor_mps = 0.0F;    ///< at and below it the reference is `low_speed_slip` at the most
    float low_speed_slip = 0.0F;

    // Share of the reference in force: integral of rise_per_s (pole + runaway_per_s) / pole_scale_radps, an integrand of at most rise_per_s.
    float runaway_per_s = 0.0F;        ///< a wheel that runs away at this rate can still be controlled
    float max_held_slip_error = 0.0F;  ///< no fall while the slip stays this close to the reference, whatever the estimated pole
    float pole_scale_radps = 0.0F;
    float pole_filter_radps = 0.0F;
    float rise_per_s = 0.0F;
    /// Rate at which the share falls, per unit of slip beyond 0.05 above the reference in force.
    float excess_fall_per_s = 0.0F;
};

/// Search for the slip of maximum friction, peak_seeker.hpp.
struct PeakConfig {
    float start_slip = 0.0F;  ///< start of the search at brake-on, and on another road if the reference was smaller
    float min_slip = 0.0F;
    float max_slip = 0.0F;
    float elasticity = 0.0F;       ///< target elasticity of friction over slip: 0 is the peak, positive means less slip
    float swing = 0.0F;            ///< amplitude of the test signal on the reference, as share of the reference
    float swing_Hz = 0.0F;         ///< frequency of the test signal: low enough for the loop to follow, higher than load changes
    float filter_radps = 0.0F;     ///< of the elasticity
    float gain = 0.0F;             ///< share of `rate_per_s` per elasticity of 1; limited to 1
    float rate_per_s = 0.0F;       ///< largest relative rate of change of the reference
    float lock_fall_per_s = 0.0F;  ///< relative rate at which the reference falls while slip is above 0.6
    float min_speed_mps = 0.0F;    ///< below it the search is suspended
};

/// Wheel deceleration law: PI on the wheel's rim deceleration; the slip law with `slip_limit` is its
/// anti-skid ceiling.
struct DecelerationConfig {
    float k_p_Pa_per_mps2 = 0.0F;
    float k_i_Pa_per_m_per_s = 0.0F;  ///< Pa per (m/s2 s)
    float filter_radps = 0.0F;        ///< of the measured deceleration
    float onset_mps3 = 0.0F;          ///< the reference rises at this rate
    float slip_limit = 0.0F;
    float drop_out_mps = 0.0F;  ///< below it the last pressure is held until standstill
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

/// Pressure-bias modulation: reduction of the demand for velocity error, its integral and the wheel's deceleration.
struct PressureBiasConfig {
    float reference_fall_mps2 = 0.0F;     ///< largest rate at which the reference speed follows the wheel down
    float dead_band_mps = 0.0F;           ///< velocity error that does not count as a skid
    float k_transient_Pa_per_mps = 0.0F;  ///< on the velocity error beyond the dead band
    float k_bias_Pa_per_m = 0.0F;         ///< on its integral: the bias
    float first_bleed_Paps = 0.0F;        ///< rate at which the initial bias decreases until the first skid
    float bleed_Paps = 0.0F;              ///< rate of decrease after it, while the wheel does not skid
    float max_bias_share = 0.0F;          ///< of the demand
    float lead_dead_band_mps2 = 0.0F;     ///< rim deceleration without lead term
    float k_lead_Pa_per_mps2 = 0.0F;      ///< on the deceleration beyond it
};

/// States and their thresholds.
struct SupervisorConfig {
    float self_test_s = 0.0F;           ///< every input good and the wheel at rest for this long
    float residual_pressure_Pa = 0.0F;  ///< largest reading that counts as no pressure
    float spin_up_mps = 0.0F;           ///< touchdown protection ends at this rim speed of the wheel
    float touchdown_timeout_s = 0.0F;   ///< or after this time on the wheels
    float demand_threshold_Pa = 0.0F;   ///< a smaller demand counts as none
    float lock_share = 0.0F;            ///< rim speed below this share of the aircraft's: wheel locked, pressure dumped
    float unlock_share = 0.0F;          ///< rim speed above this share: pressure restored
    float min_spin_up_mps2 = 0.0F;      ///< rim acceleration of a released wheel on the most slippery runway, mu F_z r^2 / J_w
    float release_s = 0.0F;             ///< time until the pressure has gone and an edge can show it
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
    float pressure_moves_Pa = 0.0F;  ///< a change of the modelled pressure by this must show in the reading
    float overspeed_share = 0.0F;    ///< allowed excess of the wheel's rim speed over the aircraft's, and jump of the aircraft's speed, as share
    float free_slip = 0.0F;          ///< largest steady slip of a wheel that is hardly braked
    float hardly_braked_Pa = 0.0F;   ///< a wheel that slips steadily needs more pressure than this, whatever the runway
    float steady_mps2 = 0.0F;        ///< rim acceleration below which a hardly braked wheel does not spin up again
    float off_command_Pa = 0.0F;
    float off_command_s = 0.0F;
    float plausible_above_mps = 0.0F;    ///< speeds are compared above it
    std::uint16_t overruns = 0;          ///< allowed missed periods in quick succession; ten good periods offset a missed one
    float max_deceleration_mps2 = 0.0F;  ///< largest reference that is accepted
    float max_current_mA = 0.0F;         ///< largest open-loop current that is accepted
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
