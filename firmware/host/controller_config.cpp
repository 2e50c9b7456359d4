#include "firmware/host/controller_config.hpp"

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string>
#include <string_view>

#include "firmware/control/valve_model.hpp"
#include "firmware/host/settings/settings.hpp"

namespace antiskid {

namespace {

using control::Config;

float number(const settings::Table& table, std::string_view key, double min, double max) {
    return static_cast<float>(table.number(key, {.min = min, .max = max}));
}

/// Milliseconds in the file, seconds in the controller.
float milliseconds(const settings::Table& table, std::string_view key, double min, double max) {
    return static_cast<float>(table.number(key, {.min = min, .max = max}) * 1e-3);
}

/// Keys that resemble each other: known from the start, so that none is taken for a slip of another that is missing.
void tell_apart(const settings::Table& table, std::initializer_list<std::string_view> keys) {
    for (const std::string_view key : keys) static_cast<void>(table.has(key));
}

control::EncoderConfig encoder(const settings::Table& t) {
    return {.teeth = static_cast<float>(t.integer<int>("teeth", {.min = 1, .max = 10000})),
            .max_speed_radps = number(t, "max_speed_radps", 1.0, 1e4),
            .max_acceleration_radps2 = number(t, "max_acceleration_radps2", 1.0, 1e6),
            .pitch_error = number(t, "pitch_error", 0.0, 0.2)};
}

control::WheelConfig wheel(const settings::Table& t) {
    const double rho = t.number("air_density_kgpm3", {.min = 0.0, .max = 2.0});
    const double lift_area = t.number("lift_area_m2", {.min = 0.0, .max = 100.0});
    return {.encoder = encoder(t.table("encoder")),
            .inertia_kgm2 = number(t, "inertia_kgm2", 0.01, 100.0),
            .nominal_radius_m = number(t, "nominal_radius_m", 0.05, 2.0),
            .radius_tolerance = number(t, "radius_tolerance", 0.005, 0.2),
            .stiffness_Npm = number(t, "stiffness_Npm", 1e4, 1e9),
            .lift_Ns2pm2 = static_cast<float>(0.5 * rho * lift_area),
            .brake_gain_m3 = number(t, "brake_gain_m3", 1e-6, 1.0)};
}

control::ValveConfig valve(const settings::Table& t, float period_s) {
    using control::ValveConfig;
    ValveConfig v;
    const settings::Count count{.min = 2, .max = ValveConfig::kMaxPoints};
    const auto current = t.numbers("current_mA", {.range = {.min = 0.0, .max = 1000.0}, .count = count, .strictly_increasing = true});
    const auto pressure = t.numbers("pressure_Pa", {.range = {.min = 0.0, .max = 1e8}, .count = count, .strictly_increasing = true});
    if (current.size() != pressure.size()) {
        t.fail("pressure_Pa", "has " + std::to_string(pressure.size()) + " points, current_mA has " + std::to_string(current.size()) +
                                  "; both need the same number");
    }
    v.points = static_cast<std::uint8_t>(current.size());
    for (std::size_t i = 0; i < current.size(); ++i) {
        v.current_mA[i] = static_cast<float>(current[i]);
        v.pressure_Pa[i] = static_cast<float>(pressure[i]);
    }
    v.natural_frequency_radps = static_cast<float>(2.0 * std::numbers::pi * t.number("natural_frequency_Hz", {.min = 1.0, .max = 200.0}));
    v.damping = number(t, "damping", 0.1, 2.0);
    const double max_delay = static_cast<double>(period_s) * static_cast<double>(control::ValveModel::kMaxDelay);
    v.delay_s = milliseconds(t, "delay_ms", 0.0, max_delay * 1e3);
    v.safe_current_mA = number(t, "safe_current_mA", 0.0, current.front());
    v.full_pressure_Pa = number(t, "full_pressure_Pa", 1e5, pressure.back());
    return v;
}

control::EstimatorConfig estimator(const settings::Table& t) {
    return {.aircraft_bandwidth_radps = number(t, "aircraft_bandwidth_radps", 1.0, 1000.0),
            .pressure_bandwidth_radps = number(t, "pressure_bandwidth_radps", 1.0, 5000.0),
            .valve_offset_radps = number(t, "valve_offset_radps", 0.0, 100.0),
            .valve_offset_share = number(t, "valve_offset_share", 0.0, 0.5)};
}

control::ObserverConfig observer(const settings::Table& t) {
    return {.reading_noise = number(t, "reading_noise", 1e-4, 1.0),
            .road_noise_radps2 = number(t, "road_noise_radps2", 1.0, 1e6),
            .pole_noise = number(t, "pole_noise", 0.0, 100.0),
            .pole_floor_radps = number(t, "pole_floor_radps", 1.0, 1e4),
            .max_mean_innovation = number(t, "max_mean_innovation", 1.0, 1e3),
            .prediction_share = number(t, "prediction_share", 0.0, 1.0)};
}

control::SlipConfig slip(const settings::Table& t) {
    const float low_speed = number(t, "low_speed_mps", 0.0, 100.0);
    control::SlipConfig s{.k_p_per_s = number(t, "k_p_per_s", 0.0, 1e4),
                          .k_i_per_s2 = number(t, "k_i_per_s2", 0.0, 1e5),
                          .k_d = number(t, "k_d", -1.0, 100.0),
                          .k_dd_s = number(t, "k_dd_s", 0.0, 1.0),
                          .k_pole = number(t, "k_pole", 0.0, 10.0),
                          .max_slip_rate_per_s = number(t, "max_slip_rate_per_s", 0.1, 1e4),
                          .earliest_peak_slip = number(t, "earliest_peak_slip", 0.001, 0.5),
                          .early_slip_rate_per_s = number(t, "early_slip_rate_per_s", 0.1, 1e4),
                          .reference_rate_per_s = number(t, "reference_rate_per_s", 0.01, 1e4),
                          .low_speed_mps = low_speed,
                          .low_speed_floor_mps = number(t, "low_speed_floor_mps", 0.0, 100.0),
                          .low_speed_slip = number(t, "low_speed_slip", 0.0, 0.5),
                          .runaway_per_s = number(t, "runaway_per_s", 0.0, 1e3),
                          .max_held_slip_error = number(t, "max_held_slip_error", 0.0, 1.0),
                          .pole_scale_radps = number(t, "pole_scale_radps", 0.1, 1e4),
                          .pole_filter_radps = number(t, "pole_filter_radps", 0.1, 200.0),
                          .rise_per_s = number(t, "rise_per_s", 0.0, 100.0),
                          .excess_fall_per_s = number(t, "excess_fall_per_s", 0.0, 1000.0)};
    if (low_speed > 0.0F && s.low_speed_floor_mps >= low_speed) {
        t.fail("low_speed_floor_mps", "must be below low_speed_mps");
    }
    return s;
}

control::PeakConfig peak(const settings::Table& t) {
    control::PeakConfig p{.start_slip = number(t, "start_slip", 0.01, 0.5),
                          .min_slip = number(t, "min_slip", 0.005, 0.5),
                          .max_slip = number(t, "max_slip", 0.01, 0.5),
                          .elasticity = number(t, "elasticity", -0.5, 0.9),
                          .swing = number(t, "swing", 0.0, 0.5),
                          .swing_Hz = number(t, "swing_Hz", 0.5, 20.0),
                          .filter_radps = number(t, "filter_radps", 1.0, 200.0),
                          .gain = number(t, "gain", 0.0, 100.0),
                          .rate_per_s = number(t, "rate_per_s", 0.0, 100.0),
                          .lock_fall_per_s = number(t, "lock_fall_per_s", 0.0, 100.0),
                          .min_speed_mps = number(t, "min_speed_mps", 0.0, 100.0)};
    if (p.min_slip > p.start_slip) t.fail("min_slip", "must not be above start_slip");
    if (p.start_slip > p.max_slip) t.fail("start_slip", "must not be above max_slip");
    return p;
}

control::DecelerationConfig deceleration(const settings::Table& t) {
    return {.k_p_Pa_per_mps2 = number(t, "k_p_Pa_per_mps2", 0.0, 1e9),
            .k_i_Pa_per_m_per_s = number(t, "k_i_Pa_per_m_per_s", 0.0, 1e9),
            .filter_radps = number(t, "filter_radps", 1.0, 1000.0),
            .onset_mps3 = number(t, "onset_mps3", 0.1, 1e4),
            .slip_limit = number(t, "slip_limit", 0.01, 0.5),
            .drop_out_mps = number(t, "drop_out_mps", 0.5, 10.0)};
}

control::ThresholdConfig threshold(const settings::Table& t) {
    return {.first_rise_Paps = number(t, "first_rise_Paps", 1e5, 1e10),
            .rise_Paps = number(t, "rise_Paps", 1e5, 1e10),
            .fall_Paps = number(t, "fall_Paps", 1e5, 1e10),
            .slip_high = number(t, "slip_high", 0.01, 0.95),
            .deceleration_high_mps2 = number(t, "deceleration_high_mps2", 1.0, 1e4),
            .acceleration_high_mps2 = number(t, "acceleration_high_mps2", 0.0, 1e4),
            .slip_low = number(t, "slip_low", 0.005, 0.9),
            .restore_share = number(t, "restore_share", 0.0, 1.0)};
}

control::PressureBiasConfig pressure_bias(const settings::Table& t) {
    tell_apart(t, {"bleed_Paps", "first_bleed_Paps", "dead_band_mps", "lead_dead_band_mps2"});
    return {.reference_fall_mps2 = number(t, "reference_fall_mps2", 0.1, 1e3),
            .dead_band_mps = number(t, "dead_band_mps", 0.0, 50.0),
            .k_transient_Pa_per_mps = number(t, "k_transient_Pa_per_mps", 0.0, 1e9),
            .k_bias_Pa_per_m = number(t, "k_bias_Pa_per_m", 0.0, 1e10),
            .first_bleed_Paps = number(t, "first_bleed_Paps", 1e5, 1e10),
            .bleed_Paps = number(t, "bleed_Paps", 1e4, 1e10),
            .max_bias_share = number(t, "max_bias_share", 0.0, 1.0),
            .lead_dead_band_mps2 = number(t, "lead_dead_band_mps2", 0.0, 1e4),
            .k_lead_Pa_per_mps2 = number(t, "k_lead_Pa_per_mps2", 0.0, 1e8)};
}

/// What a key of the file decides further, as a share of it. docs/engineering/controller.md has the reasons.
namespace derived {
constexpr float kSelfTest = 0.2F;       // of stuck_ms
constexpr float kDemand = 0.4F;         // of residual_pressure_Pa: less is no demand
constexpr float kHysteresis = 0.2F;     // of drop_out_mps
constexpr float kPlausible = 0.9F;      // of drop_out_mps: a reference that died above it would look like drop-out
constexpr float kStandstill_s = 0.1F;   // frames without an edge that make a standstill, SpeedEstimator
constexpr float kSettled = 3.0F;        // time constants of the valve
constexpr float kImplausible = 0.25F;   // of sensor_max_age_ms
constexpr float kOverruns = 2.5F;       // of the periods in sensor_max_age_ms
constexpr float kOffCommand = 0.4F;     // of stuck_ms
constexpr float kMoves = 1.0F / 3.0F;   // of off_command_Pa
constexpr float kPressureRate = 2.0F;   // of a full step's rate by eq. (6); the rest is noise of one reading
constexpr float kOverspeed = 3.0F;      // of radius_tolerance
constexpr float kRejectTimeout = 0.5F;  // of sensor_max_age_ms, as frames that are that late count as lost
constexpr float kHardest = 2.0F;        // of brake_gain_m3: linings grip 1.3 times that (uncertainty.toml), a carcass swings back by the rest
constexpr float kHardlyBraked = 0.5F;   // of the pressure whose torque is that of the most slippery runway, J_w min_spin_up_mps2 / r
constexpr float kSteady = 0.3F;         // of min_spin_up_mps2: under half of the runway's torque a wheel gains at least half of it
constexpr float kCurrent = 1.01F;       // of the valve map's last current: half a step of its field
constexpr float kFreeSlip = 1.6F;       // of radius_tolerance: a wheel whose radius is not learnt seems to slip by so much
}  // namespace derived

control::SupervisorConfig supervisor(const settings::Table& t, const control::ValveConfig& v, float stuck_s) {
    const float residual_Pa = number(t, "residual_pressure_Pa", 1e4, 1e7);
    const float lock_share = number(t, "lock_share", 0.01, 0.45);
    const float drop_out_mps = number(t, "drop_out_mps", 1.2, 20.0);
    return {.self_test_s = derived::kSelfTest * stuck_s,
            .residual_pressure_Pa = residual_Pa,
            .spin_up_mps = number(t, "spin_up_mps", 1.0, 100.0),
            .touchdown_timeout_s = number(t, "touchdown_timeout_s", 0.1, 30.0),
            .demand_threshold_Pa = derived::kDemand * residual_Pa,
            .lock_share = lock_share,
            .unlock_share = 1.0F - lock_share,
            .min_spin_up_mps2 = number(t, "min_spin_up_mps2", 1.0, 1e4),
            .release_s = derived::kStandstill_s + v.delay_s + derived::kSettled / v.natural_frequency_radps,
            .drop_out_mps = drop_out_mps,
            .drop_out_hysteresis_mps = derived::kHysteresis * drop_out_mps,
            .pass_through_rate_Paps = number(t, "pass_through_rate_Paps", 1e5, 1e10)};
}

control::MonitorConfig monitor(const settings::Table& t, const Config& c, float stuck_s) {
    const double period_ms = static_cast<double>(c.period_s) * 1e3;
    const float max_age_s = milliseconds(t, "sensor_max_age_ms", 2.0 * period_ms, 1000.0);
    const float torque_Nm = c.wheel.inertia_kgm2 * c.supervisor.min_spin_up_mps2 / c.wheel.nominal_radius_m;  // of the most slippery runway
    const float off_command_Pa = number(t, "off_command_Pa", 1e4, 1e8);
    return {.sensor_max_age_s = max_age_s,
            .maneuver_max_age_s = milliseconds(t, "maneuver_max_age_ms", 2.0 * period_ms, 5000.0),
            .heartbeat_max_age_s = milliseconds(t, "heartbeat_max_age_ms", 2.0 * period_ms, 10000.0),
            .implausible_s = derived::kImplausible * max_age_s,
            .stuck_s = stuck_s,
            .pressure_range_Pa = number(t, "pressure_range_Pa", c.valve.full_pressure_Pa, 1e9),
            .pressure_rate_Paps = derived::kPressureRate * c.valve.natural_frequency_radps * c.valve.full_pressure_Pa,
            .pressure_moves_Pa = derived::kMoves * off_command_Pa,
            .overspeed_share = derived::kOverspeed * c.wheel.radius_tolerance,
            .free_slip = derived::kFreeSlip * c.wheel.radius_tolerance,
            .hardly_braked_Pa = derived::kHardlyBraked * torque_Nm / c.wheel.brake_gain_m3,
            .steady_mps2 = derived::kSteady * c.supervisor.min_spin_up_mps2,
            .off_command_Pa = off_command_Pa,
            .off_command_s = derived::kOffCommand * stuck_s,
            .plausible_above_mps = derived::kPlausible * c.supervisor.drop_out_mps,
            .overruns = static_cast<std::uint16_t>(std::lround(derived::kOverruns * max_age_s / c.period_s)),
            .max_deceleration_mps2 = number(t, "max_deceleration_mps2", 0.1, 100.0),
            .max_current_mA = derived::kCurrent * c.valve.current_mA[c.valve.points - 1U]};
}

}  // namespace

control::Config load_controller_config(const std::filesystem::path& path) {
    const auto doc = settings::Document::load(path);
    const settings::Table root = doc.root();
    Config c;
    c.period_s = milliseconds(root, "period_ms", 1.0, 5.0);
    c.wheel = wheel(root.table("wheel"));
    const settings::Table flywheel = root.table("flywheel");
    c.flywheel = {.encoder = encoder(flywheel.table("encoder")), .radius_m = number(flywheel, "radius_m", 0.05, 10.0)};
    c.valve = valve(root.table("valve"), c.period_s);
    c.estimator = estimator(root.table("estimator"));
    c.observer = observer(root.table("observer"));
    c.slip = slip(root.table("slip"));
    c.deceleration = deceleration(root.table("deceleration"));
    c.threshold = threshold(root.table("threshold"));
    c.peak = peak(root.table("peak"));
    c.pressure_bias = pressure_bias(root.table("pressure_bias"));
    const settings::Table states = root.table("supervisor");
    const settings::Table checks = root.table("monitor");
    const float stuck_s = milliseconds(checks, "stuck_ms", 50.0, 5000.0);
    c.supervisor = supervisor(states, c.valve, stuck_s);
    c.monitor = monitor(checks, c, stuck_s);
    c.wheel.hardest_brake = derived::kHardest;
    c.wheel.encoder.reject_timeout_s = c.flywheel.encoder.reject_timeout_s = derived::kRejectTimeout * c.monitor.sensor_max_age_s;
    doc.finish();
    return c;
}

}  // namespace antiskid
