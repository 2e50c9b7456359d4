#include "plant_sim/study/validation/simulated_stop.hpp"

#include <algorithm>

namespace validation {

namespace {

constexpr double kStep_s = 1e-3;
constexpr std::size_t kRemembered = 2000;  // steps

plant::Rig rolling(rig::RigParameters parameters, double speed_mps) {
    const double nominal_mps = parameters.brake_on_mps;
    parameters.brake_on_mps = speed_mps;
    plant::Rig rig(parameters, kStep_s, 0);
    rig.start_rolling();
    rig.set_brake(parameters.mean_friction, nominal_mps);
    return rig;
}

}  // namespace

SimulatedStop::SimulatedStop(const rig::RigParameters& parameters, double speed_mps, double start_s, double pressure_Pa)
    : rig_(rolling(parameters, speed_mps)), start_s_(start_s), given_s_(start_s), given_Pa_(pressure_Pa), pressure_Pa_(pressure_Pa) {
    rig_.start_pressure(pressure_Pa);
    remember();
}

double SimulatedStop::newest_s() const {
    return start_s_ + static_cast<double>(steps_) * kStep_s;
}

void SimulatedStop::advance(double time_s, double pressure_Pa) {
    constexpr double kRounding_s = 1e-9;
    while (!rig_.standstill() && newest_s() + kStep_s <= time_s + kRounding_s) {
        const double share = time_s > given_s_ ? (newest_s() + kStep_s - given_s_) / (time_s - given_s_) : 1.0;
        const double next_Pa = given_Pa_ + std::clamp(share, 0.0, 1.0) * (pressure_Pa - given_Pa_);
        rig_.advance_pressure(pressure_Pa_, next_Pa);
        pressure_Pa_ = next_Pa;
        ++steps_;
        remember();
    }
    given_s_ = time_s;
    given_Pa_ = pressure_Pa;
}

void SimulatedStop::remember() {
    const plant::WheelState& w = rig_.wheel();
    past_.push_back({w.distance_m, w.angle_rad, w.v_mps, w.omega_radps, rig_.forces().radius_m});
    if (past_.size() > kRemembered) past_.pop_front();
}

std::optional<SimulatedStop::Instant> SimulatedStop::at(double time_s) const {
    const double index = static_cast<double>(past_.size() - 1) - (newest_s() - time_s) / kStep_s;
    if (index < 0.0) return std::nullopt;
    const auto i = static_cast<std::size_t>(index);
    if (i + 1 >= past_.size()) return past_.back();
    const double x = index - static_cast<double>(i);
    const Instant& a = past_[i];
    const Instant& b = past_[i + 1];
    const auto between = [x](double p, double q) { return p + x * (q - p); };
    return Instant{between(a.distance_m, b.distance_m), between(a.angle_rad, b.angle_rad), between(a.v_mps, b.v_mps),
                   between(a.omega_radps, b.omega_radps), between(a.radius_m, b.radius_m)};
}

std::optional<SimulatedStop::Motion> SimulatedStop::mean(double from_s, double to_s) const {
    constexpr double kInstant_s = 1e-6;
    const auto a = at(from_s);
    const auto b = at(to_s);
    if (!a || !b) return std::nullopt;
    const double length = to_s - from_s;
    if (length < kInstant_s) return Motion{b->v_mps, b->omega_radps, b->radius_m};
    return Motion{(b->distance_m - a->distance_m) / length, (b->angle_rad - a->angle_rad) / length, 0.5 * (a->radius_m + b->radius_m)};
}

}  // namespace validation
