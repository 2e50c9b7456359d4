/// A configuration that never changes, so that tests and golden numbers outlive a retuning of config/controller.toml.
#pragma once

#include <limits>
#include <numbers>

#include "firmware/control/config.hpp"
#include "firmware/control/types.hpp"

namespace control_test {

inline constexpr float kPeriod_s = 1e-3F;
inline constexpr antiskid::control::Time kMillisecond{1'000'000};
inline constexpr float kExact_s = 1.0F / 1024.0F;  // sums of it are not rounded
inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

[[nodiscard]] inline antiskid::control::Config fixed_config(const float period_s = 1e-3F) {
    namespace control = antiskid::control;
    control::Config c;
    c.period_s = period_s;
    c.wheel = {.encoder = {.teeth = 60.0F, .max_speed_radps = 400.0F, .max_acceleration_radps2 = 30'000.0F, .reject_timeout_s = 0.01F},
               .inertia_kgm2 = 1.3F,
               .nominal_radius_m = 0.322F,
               .radius_tolerance = 0.05F,
               .stiffness_Npm = 2.7e6F,
               .lift_Ns2pm2 = 3.61375F,
               .brake_gain_m3 = 1.04e-3F,
               .hardest_brake = 2.0F};
    c.flywheel = {.encoder = {.teeth = 60.0F, .max_speed_radps = 250.0F, .max_acceleration_radps2 = 1'000.0F, .reject_timeout_s = 0.01F},
                  .radius_m = 0.6F};
    c.valve.points = 10;
    c.valve.current_mA = {3.0F, 5.0F, 8.0F, 12.0F, 16.0F, 20.0F, 25.0F, 30.0F, 35.0F, 40.0F};
    c.valve.pressure_Pa = {0.0F, 0.7e6F, 2.1e6F, 4.3e6F, 6.7e6F, 9.2e6F, 12.3e6F, 15.3e6F, 18.1e6F, 20.7e6F};
    c.valve.natural_frequency_radps = 40.0F * std::numbers::pi_v<float>;
    c.valve.damping = 0.8F;
    c.valve.delay_s = 6e-3F;
    c.valve.safe_current_mA = 0.0F;
    c.valve.full_pressure_Pa = 20.7e6F;
    c.estimator = {.aircraft_bandwidth_radps = 50.0F, .pressure_bandwidth_radps = 470.0F};
    c.observer = {.reading_noise = 0.05F,
                  .road_noise_radps2 = 4000.0F,
                  .pole_noise = 3.5F,
                  .pole_floor_radps = 100.0F,
                  .max_mean_innovation = 6.0F,
                  .prediction_share = 0.2F};
    c.slip = {.k_p_per_s = 100.0F,
              .k_i_per_s2 = 200.0F,
              .k_d = 4.0F,
              .k_dd_s = 0.005F,
              .k_pole = 0.3F,
              .max_slip_rate_per_s = 20.0F,
              .earliest_peak_slip = 0.03F,
              .early_slip_rate_per_s = 40.0F,
              .reference_rate_per_s = 50.0F,
              .low_speed_mps = 24.0F,
              .low_speed_floor_mps = 8.0F,
              .low_speed_slip = 0.14F,
              .runaway_per_s = 15.0F,
              .pole_scale_radps = 30.0F,
              .pole_filter_radps = 30.0F,
              .rise_per_s = 0.2F,
              .excess_fall_per_s = 10.0F};
    c.deceleration = {
        .k_p_Pa_per_mps2 = 0.2e6F, .k_i_Pa_per_m_per_s = 4e6F, .filter_radps = 40.0F, .onset_mps3 = 10.0F, .slip_limit = 0.15F, .drop_out_mps = 1.0F};
    c.threshold = {.first_rise_Paps = 64e6F,
                   .rise_Paps = 2e6F,
                   .fall_Paps = 400e6F,
                   .slip_high = 0.4F,
                   .deceleration_high_mps2 = 35.0F,
                   .acceleration_high_mps2 = 2.0F,
                   .slip_low = 0.2F,
                   .restore_share = 0.9F};
    c.peak = {.start_slip = 0.16F,
              .min_slip = 0.03F,
              .max_slip = 0.4F,
              .elasticity = 0.0F,
              .swing = 0.25F,
              .swing_Hz = 5.0F,
              .filter_radps = 50.0F,
              .gain = 2.0F,
              .rate_per_s = 4.0F,
              .lock_fall_per_s = 10.0F,
              .min_speed_mps = 6.0F};
    c.pressure_bias = {.reference_fall_mps2 = 10.0F,
                       .dead_band_mps = 2.0F,
                       .k_transient_Pa_per_mps = 0.5e6F,
                       .k_bias_Pa_per_m = 8e6F,
                       .first_bleed_Paps = 64e6F,
                       .bleed_Paps = 4e6F,
                       .max_bias_share = 0.9F,
                       .lead_dead_band_mps2 = 40.0F,
                       .k_lead_Pa_per_mps2 = 1e4F};
    c.supervisor = {.self_test_s = 0.05F,
                    .residual_pressure_Pa = 0.5e6F,
                    .spin_up_mps = 30.0F,
                    .touchdown_timeout_s = 3.0F,
                    .demand_threshold_Pa = 0.2e6F,
                    .lock_share = 0.3F,
                    .unlock_share = 0.7F,
                    .min_spin_up_mps2 = 50.0F,
                    .release_s = 0.125F,
                    .drop_out_mps = 5.0F,
                    .drop_out_hysteresis_mps = 1.0F,
                    .pass_through_rate_Paps = 10e6F};
    c.monitor = {.sensor_max_age_s = 0.02F,
                 .maneuver_max_age_s = 0.1F,
                 .heartbeat_max_age_s = 0.35F,
                 .implausible_s = 0.005F,
                 .stuck_s = 0.25F,
                 .pressure_range_Pa = 25e6F,
                 .pressure_rate_Paps = 5e9F,
                 .pressure_moves_Pa = 1e6F,
                 .overspeed_share = 0.15F,
                 .free_slip = 0.2F,
                 .hardly_braked_Pa = 0.1e6F,
                 .steady_mps2 = 15.0F,
                 .off_command_Pa = 3e6F,
                 .off_command_s = 0.1F,
                 .plausible_above_mps = 8.0F,
                 .overruns = 10,
                 .max_deceleration_mps2 = 15.0F,
                 .max_current_mA = 100.0F};
    return c;
}

}  // namespace control_test
