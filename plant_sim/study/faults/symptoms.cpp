#include "plant_sim/study/faults/symptoms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/control/slip_law.hpp"
#include "firmware/control/valve_model.hpp"

namespace faults {

using antiskid::control::Command;
using antiskid::control::Estimate;
using antiskid::control::Sensors;
using antiskid::control::SpeedReading;
using antiskid::control::State;

void SymptomMeter::take_wheel(const Estimate& before) {
    const SpeedReading& reading = estimator_.wheel_reading();
    if (!reading.fresh) return;
    const double period_s = static_cast<double>(config_.period_s);
    const double took_s = static_cast<double>(reading.interval_s);
    const double since_s = std::max(took_s, period_s);
    const double age_s = 0.5 * (took_s + std::min(took_s, period_s));
    const double expected = static_cast<double>(before.omega_radps) + static_cast<double>(before.omega_dot_radps2) * (period_s - age_s);
    const double off = static_cast<double>(reading.speed_radps) - expected;
    const double pitch_rad = 2.0 * std::numbers::pi / static_cast<double>(config_.wheel.encoder.teeth);
    const double noise = static_cast<double>(config_.observer.reading_noise) * pitch_rad / since_s;
    const double brakes_radps2 = static_cast<double>(before.brake_gain) * static_cast<double>(estimator_.estimate().pressure.pressure_Pa);
    const double acts_radps2 =
        off < 0.0 ? static_cast<double>(config_.wheel.hardest_brake) * std::max(brakes_radps2, static_cast<double>(before.road_radps2))
                  : static_cast<double>(config_.wheel.encoder.max_acceleration_radps2);
    constexpr double kChance = 4.0;  // standard deviations
    const bool fast = before.v_mps > 3.0F * config_.monitor.plausible_above_mps;
    constexpr double kForgotten_per_s = 2.0;
    wild_ = std::max(wild_ - kForgotten_per_s * since_s, 0.0);
    wild_ += fast && std::abs(off) > acts_radps2 * since_s + kChance * noise ? 1.0 : 0.0;
    most_wild_ = std::max(most_wild_, wild_);
    readings_ += 1.0;
    squares_ += off * off / (noise * noise);
}

void SymptomMeter::take_pressure(const Sensors& sensors, double model_before_Pa) {
    const double model_Pa = static_cast<double>(estimator_.uncorrected_pressure_Pa());
    const double reads_Pa = static_cast<double>(sensors.pressure.pressure_Pa);
    const double rate = (model_Pa - model_before_Pa) / static_cast<double>(config_.period_s);
    periods_ += 1.0;
    off_Pa_ += std::abs(reads_Pa - model_Pa);
    lag_up_ += (model_Pa - reads_Pa) * rate;
    lag_down_ += rate * rate;
}

void SymptomMeter::take(const Sensors& sensors, const Command& command, bool counts) {
    const Estimate before = estimator_.estimate();
    const double model_before_Pa = static_cast<double>(estimator_.uncorrected_pressure_Pa());
    const Estimate& e = estimator_.update(sensors, held_Pa_);
    held_Pa_ = antiskid::control::valve_pressure_Pa(config_.valve, command.current_mA);
    const std::uint32_t refused = sensors.wheel.rejected + sensors.flywheel.rejected + sensors.pressure.rejected + sensors.maneuver.rejected;
    if (counts) {
        refused_ += refused - refused_before_;
        late_s_ = std::max(late_s_, static_cast<double>(estimator_.wheel_reading().late_s));
    }
    refused_before_ = refused;
    if (!counts || (command.state != State::braking && command.state != State::locked_wheel)) return;
    const double period_s = static_cast<double>(config_.period_s);
    now_mps_ = static_cast<double>(e.v_mps);
    if (!begun_) began_mps_ = now_mps_;
    begun_ = true;
    impulse_Ns_ += static_cast<double>(config_.wheel.inertia_kgm2 * e.road_radps2 / e.radius_m) * period_s;
    take_wheel(before);
    take_pressure(sensors, model_before_Pa);
    const double excess = static_cast<double>(e.slip - command.slip_reference - antiskid::control::kHeldWithin);
    excess_s_ = std::max(excess_s_ + excess * period_s, 0.0);
    most_excess_s_ = std::max(most_excess_s_, excess_s_);
}

Symptoms SymptomMeter::symptoms() const {
    const auto share = [](double part, double whole) { return whole > 0.0 ? part / whole : 0.0; };
    return {late_s_,
            static_cast<double>(refused_),
            most_wild_,
            std::sqrt(share(squares_, readings_)),
            share(impulse_Ns_, began_mps_ - now_mps_),
            share(off_Pa_, periods_),
            share(lag_up_, lag_down_),
            most_excess_s_};
}

}  // namespace faults
