/// A frequency analyser on the real estimator and slip law: sines added to the valve command while the loop is closed, against a wheel at
/// a frozen speed that is integrated here in small steps, behind a toothed encoder.
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <optional>

#include "firmware/control/estimator.hpp"
#include "firmware/control/slip_law.hpp"
#include "plant_sim/model/compliant_wheel.hpp"
#include "plant_sim/study/margins/operating_point.hpp"
#include "tests/control/shaft.hpp"
#include "tests/control/valve_truth.hpp"

namespace margins_test {

/// Eq. (1b) and (3) at a constant speed, the aircraft's deceleration in v' only, the pressure by eq. (6), and the shipped law on it. On a
/// tyre that gives way the wheel is plant::CompliantWheel, and speed stays constant only with a mass that nothing slows down.
class FrozenStop {
  public:
    FrozenStop(antiskid::control::Config config, const rig::RigParameters& rig, const study::margins::OperatingPoint& at)
        : at_(at),
          surface_(rig.surface),
          config_(with_radius(config, at)),
          estimator_(config_),
          law_(config_.slip, config_.period_s),
          valve_(rig.valve.natural_frequency_radps, rig.valve.damping, rig.valve.delay_s),
          line_s_(rig.valve.line_s),
          wheel_(rig.wheel_encoder.teeth),
          flywheel_(rig.flywheel_encoder.teeth),
          flywheel_radius_m_(rig.flywheel_radius_m),
          slip_(at.slip) {
        if (rig.wheel.compliance.any()) {
            tyre_.emplace(rig.wheel, plant::BrakeTorque(rig.brake, rig.friction_curve, rig.mean_friction, rig.brake_on_mps), rig.surface.law());
            motion_ = {.v_mps = at.speed_mps, .omega_radps = (1.0 - at.slip) * at.speed_mps / at.radius_m, .held = false};
            tyre_->settle(motion_);
        }
        config_.slip.low_speed_mps = 0.0F;
        law_ = antiskid::control::SlipLaw(config_.slip, config_.period_s);
        command_Pa_ = at.pressure_Pa;
        // Long enough at the equilibrium for the trackers to have forgotten their start.
        hold_ = true;
        for (int k = 0; k < 600; ++k) step(0.0);
        hold_ = false;
        law_.start(estimator_.estimate());
        for (int k = 0; k < 3000; ++k) step(0.0);
    }

    /// One period with `added_Pa` on top of the law's command; returns that command.
    double step(double added_Pa) {
        const double h = static_cast<double>(config_.period_s);
        const double given = command_Pa_;
        if (hold_ || deaf_) {
            // A tyre that gives way comes to its equilibrium by itself, where it has one.
            valve_.hold(at_.pressure_Pa, h, [this](double p, double dt) {
                pass_line(p, dt);
                if (tyre_ && hold_) move(brake_Pa_, dt);
            });
        } else {
            valve_.hold(at_.pressure_Pa + gain_ * (given + added_Pa - at_.pressure_Pa), h, [this](double p, double dt) {
                pass_line(p, dt);
                move(brake_Pa_, dt);
            });
        }
        now_ += antiskid::control::Time(std::llround(h * 1e9));
        wheel_.turn_to((1.0 - slip_) * at_.speed_mps / at_.radius_m, h);
        flywheel_.turn_to(at_.speed_mps / flywheel_radius_m_, h);
        wheel_.report(sensors_.wheel, now_);
        flywheel_.report(sensors_.flywheel, now_);
        sensors_.pressure.received = now_;
        sensors_.pressure.pressure_Pa = static_cast<float>(brake_Pa_);
        const auto& e = estimator_.update(sensors_, static_cast<float>(given));
        if (!hold_)
            command_Pa_ =
                static_cast<double>(estimator_.compensated_Pa(law_.pressure_Pa(e, static_cast<float>(at_.slip), config_.valve.full_pressure_Pa)));
        return command_Pa_;
    }

    /// L at `frequency_radps` (rounded to whole periods in the window): - (law's command) / (valve's command).
    std::complex<double> loop(double& frequency_radps, double amplitude_Pa, double seconds) {
        const double h = static_cast<double>(config_.period_s);
        const double turns = std::max(1.0, std::round(frequency_radps * seconds / (2.0 * std::numbers::pi)));
        frequency_radps = turns * 2.0 * std::numbers::pi / seconds;
        const auto count = static_cast<std::int64_t>(std::llround(seconds / h));
        std::complex<double> given = 0.0, acting = 0.0;
        for (std::int64_t k = -count / 2; k < count; ++k) {
            const double phase = frequency_radps * h * static_cast<double>(k);
            const double added = amplitude_Pa * std::sin(phase);
            const double command = command_Pa_ - at_.pressure_Pa;
            if (k >= 0) {
                given += command * std::polar(1.0, -phase);
                acting += (command + added) * std::polar(1.0, -phase);
            }
            step(added);
        }
        return -given / acting;
    }

    /// By how much a swing at `frequency_radps` grows in `seconds`, once started and left alone, with the valve's gain times `gain`.
    double growth(double gain, double frequency_radps, double amplitude_Pa, double seconds) {
        const double h = static_cast<double>(config_.period_s);
        gain_ = gain;
        std::int64_t k = 0;
        const auto count = static_cast<std::int64_t>(std::llround(seconds / h));
        // Under a Hann window, which keeps what drifts slowly out of it.
        const auto swing = [&](double added_Pa) {
            std::complex<double> sum = 0.0;
            for (std::int64_t i = 0; i < count; ++i, ++k) {
                const double phase = frequency_radps * h * static_cast<double>(k);
                const double window = 1.0 - std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count));
                sum += window * (step(added_Pa * std::sin(phase)) - at_.pressure_Pa) * std::polar(1.0, -phase);
            }
            return std::abs(sum);
        };
        swing(amplitude_Pa);
        swing(0.0);
        const double before = swing(0.0);
        return swing(0.0) / before;
    }

    /// Where the law's command ends, over the pressure of the equilibrium, when `kick_Pa` was added to one command and no sensor reacts to any.
    double alone(double kick_Pa, double seconds) {
        deaf_ = true;
        command_Pa_ += kick_Pa;
        for (auto k = std::llround(seconds / static_cast<double>(config_.period_s)); k > 0; --k) step(0.0);
        return command_Pa_ / at_.pressure_Pa;
    }

    /// What the observer takes the wheel's pole for.
    [[nodiscard]] double wheel_pole_radps() const { return static_cast<double>(estimator_.estimate().wheel_pole_radps); }
    [[nodiscard]] double slip() const { return slip_; }
    [[nodiscard]] double pressure_Pa() const { return brake_Pa_; }

  private:
    static antiskid::control::Config with_radius(antiskid::control::Config c, const study::margins::OperatingPoint& at) {
        const double lift = static_cast<double>(c.wheel.lift_Ns2pm2) / static_cast<double>(c.wheel.stiffness_Npm);
        c.wheel.nominal_radius_m = static_cast<float>(at.radius_m - lift * at.speed_mps * at.speed_mps);
        return c;
    }

    /// First-order lag, exact for a pressure that is held over the step.
    void pass_line(double valve_Pa, double dt) { brake_Pa_ += (valve_Pa - brake_Pa_) * (line_s_ > 0.0 ? -std::expm1(-dt / line_s_) : 1.0); }

    void move(double pressure_Pa, double dt) {
        if (!tyre_) {
            slip_ += rate(pressure_Pa) * dt;
            return;
        }
        tyre_->advance(motion_, plant::PressureArc::linear(pressure_Pa, pressure_Pa), {at_.load_N, 0.0, 0.0}, dt);
        slip_ = 1.0 - motion_.omega_radps * at_.radius_m / at_.speed_mps;
    }

    [[nodiscard]] double rate(double pressure_Pa) const {
        const double mu = rig::friction(surface_, slip_).mu;
        const double ratio = at_.mass_kg * at_.radius_m * at_.radius_m / at_.inertia_kgm2;
        return at_.radius_m * at_.brake_gain_m3 * pressure_Pa / (at_.inertia_kgm2 * at_.speed_mps) -
               at_.load_N * mu / (at_.mass_kg * at_.speed_mps) * ((1.0 - slip_) + ratio);
    }

    study::margins::OperatingPoint at_;
    rig::Surface surface_;
    double gain_ = 1.0;
    antiskid::control::Config config_;
    antiskid::control::Estimator estimator_;
    antiskid::control::SlipLaw law_;
    control_test::ValveTruth valve_;
    double line_s_;
    double brake_Pa_ = 0.0;
    control_test::Shaft wheel_, flywheel_;
    double flywheel_radius_m_;
    antiskid::control::Sensors sensors_;
    antiskid::control::Time now_{};
    double slip_;
    std::optional<plant::CompliantWheel> tyre_;  // where it gives way: then the wheel is the plant's own
    plant::WheelState motion_;
    double command_Pa_ = 0.0;
    bool hold_ = true;
    bool deaf_ = false;  // the plant stays where it is
};

}  // namespace margins_test
