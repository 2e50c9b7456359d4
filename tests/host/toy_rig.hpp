/// A landing in a few lines: enough for the controller to pass through its states, nothing to learn about brakes from.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>

#include "firmware/can/rig_sample.hpp"
#include "firmware/control/config.hpp"

namespace host_test {

/// In the air with the wheel at rest, armed at 0.2 s, on the ground at 0.5 s, spun up, brake on at 1.2 s. The aircraft slows down as the
/// pressure says; the wheel slips in proportion to it.
class ToyRig {
  public:
    ToyRig(const antiskid::control::Config& config, const antiskid::control::Law law) : config_(config) {
        sample_.maneuver.law = law;
        sample_.maneuver.slip_reference = 0.1F;
        sample_.maneuver.deceleration_mps2 = 3.0F;
        sample_.maneuver.current_mA = 12.0F;
    }

    [[nodiscard]] const antiskid::can::RigSample& sample() const { return sample_; }

    void advance(const double current_mA, const double h) {
        t_ += h;
        sample_.maneuver.arm = t_ >= 0.2;
        sample_.maneuver.weight_on_wheels = t_ >= 0.5;
        sample_.maneuver.demand_Pa = t_ >= 1.2 ? 10e6F : 0.0F;
        pressure_Pa_ += (static_pressure_Pa(current_mA) - pressure_Pa_) * std::min(1.0, h / 0.015);
        sample_.pressure_Pa = static_cast<float>(pressure_Pa_);
        v_ = std::max(0.0, v_ - h * pressure_Pa_ * 0.6e-6);
        const double slip = std::min(1.0, pressure_Pa_ / 80e6);
        const double spin_up = std::clamp((t_ - 0.5) / 0.2, 0.0, 1.0);
        const auto nominal = static_cast<double>(config_.wheel.nominal_radius_m);
        turn(wheel_angle_, spin_up * v_ * (1.0 - slip) / nominal, h, sample_.wheel, config_.wheel.encoder);
        turn(flywheel_angle_, v_ / static_cast<double>(config_.flywheel.radius_m), h, sample_.flywheel, config_.flywheel.encoder);
    }

  private:
    [[nodiscard]] double static_pressure_Pa(const double current_mA) const {
        const auto& map = config_.valve;
        const auto last = static_cast<std::size_t>(map.points - 1);
        if (current_mA <= static_cast<double>(map.current_mA[0])) return static_cast<double>(map.pressure_Pa[0]);
        for (std::size_t i = 1; i <= last; ++i) {
            const auto i1 = static_cast<double>(map.current_mA[i]);
            if (current_mA > i1) continue;
            const auto i0 = static_cast<double>(map.current_mA[i - 1]);
            const auto p0 = static_cast<double>(map.pressure_Pa[i - 1]);
            return p0 + (static_cast<double>(map.pressure_Pa[i]) - p0) * (current_mA - i0) / (i1 - i0);
        }
        return static_cast<double>(map.pressure_Pa[last]);
    }

    void turn(double& angle, const double speed_radps, const double h, antiskid::can::SpeedSample& speed,
              const antiskid::control::EncoderConfig& encoder) const {
        const double tooth = 2.0 * std::numbers::pi / static_cast<double>(encoder.teeth);
        angle += speed_radps * h;
        speed.speed_radps = static_cast<float>(speed_radps);
        const auto edges = static_cast<std::uint32_t>(angle / tooth);
        if (edges == speed.edge_count) return;
        speed.edge_count = edges;
        const double since_edge = (angle - edges * tooth) / speed_radps;
        speed.edge_time = antiskid::control::Time{static_cast<std::int64_t>((t_ - since_edge) * 1e9)};
    }

    antiskid::control::Config config_;
    antiskid::can::RigSample sample_;
    double t_ = 0.0;
    double v_ = 60.0;
    double pressure_Pa_ = 0.0;
    double wheel_angle_ = 0.0;
    double flywheel_angle_ = 0.0;
};

}  // namespace host_test
