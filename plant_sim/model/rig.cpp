#include "plant_sim/model/rig.hpp"

#include <cmath>

namespace plant {

Rig::Rig(const RigParameters& parameters, double step_s, std::uint64_t seed)
    : parameters_(parameters),
      dynamics_(parameters.wheel,
                BrakeTorque(parameters.brake, parameters.friction_curve, parameters.mean_friction,
                            parameters.brake_on_mps),
                parameters.surface),
      valve_(parameters.valve, step_s),
      wheel_encoder_(parameters.wheel_encoder),
      flywheel_encoder_(parameters.flywheel_encoder),
      random_(seed),
      step_s_(step_s) {
    state_.v_mps = parameters.touchdown_mps > 0.0 ? parameters.touchdown_mps : parameters.brake_on_mps;
}

void Rig::start_rolling() {
    contact_ = true;
    state_.v_mps = parameters_.brake_on_mps;
    const LoadParameters& law = parameters_.load;
    device_load_N_ = law.base_N - law.lift_Ns2pm2 * state_.v_mps * state_.v_mps;
    const double radius = parameters_.wheel.free_radius_m - device_load_N_ / parameters_.wheel.stiffness_Npm;
    state_.omega_radps = state_.v_mps / radius;
    state_.held = false;
}

LoadArc Rig::load_arc(double h) {
    const LoadParameters& law = parameters_.load;
    if (law.lag_s <= 0.0) return contact_ ? LoadArc{law.base_N, 0.0, law.lift_Ns2pm2} : LoadArc{};
    // The device follows its set-point by a first-order lag, exact for a set-point that is held over the
    // step.
    const double set_point = contact_ ? law.base_N - law.lift_Ns2pm2 * state_.v_mps * state_.v_mps : 0.0;
    const double before = device_load_N_;
    device_load_N_ = set_point + (before - set_point) * std::exp(-h / law.lag_s);
    return {before, device_load_N_ - before, 0.0};
}

Forces Rig::forces() const {
    const LoadParameters& law = parameters_.load;
    const LoadArc now = law.lag_s > 0.0 ? LoadArc{device_load_N_, 0.0, 0.0}
                        : contact_      ? LoadArc{law.base_N, 0.0, law.lift_Ns2pm2}
                                        : LoadArc{};
    return dynamics_.forces(state_, pressure_Pa_, now);
}

void Rig::move(const PressureArc& pressure, double h) {
    dynamics_.advance(state_, pressure, load_arc(h), h);
}

void Rig::sense(double wheel_before, double flywheel_before) {
    ++steps_;
    const double now = time_s();
    const double per_radius = 1.0 / parameters_.flywheel_radius_m;
    wheel_encoder_.advance(state_.angle_rad, wheel_before, state_.omega_radps, now, step_s_, random_);
    flywheel_encoder_.advance(state_.distance_m * per_radius, flywheel_before * per_radius,
                              state_.v_mps * per_radius, now, step_s_, random_);
    measured_pressure_Pa_ = reading_Pa(parameters_.transducer, pressure_Pa_, random_);
}

void Rig::advance_current(double start_mA, double end_mA) {
    const double wheel_before = state_.omega_radps;
    const double flywheel_before = state_.v_mps;
    const double start_Pa = parameters_.pressure_map.pressure_Pa(start_mA);
    const double end_Pa = end_mA == start_mA ? start_Pa : parameters_.pressure_map.pressure_Pa(end_mA);
    const Valve::Arcs arcs = valve_.advance(start_Pa, end_Pa);
    if (valve_.first_s() > 0.0) move(arcs.first, valve_.first_s());
    move(arcs.second, valve_.second_s());
    pressure_Pa_ = valve_.pressure_Pa();
    sense(wheel_before, flywheel_before);
}

void Rig::advance_pressure(std::span<const PressurePart> parts) {
    const double wheel_before = state_.omega_radps;
    const double flywheel_before = state_.v_mps;
    for (const PressurePart& part : parts)
        move(PressureArc::linear(part.start_Pa, part.end_Pa), part.share * step_s_);
    pressure_Pa_ = parts.back().end_Pa;
    sense(wheel_before, flywheel_before);
}

}  // namespace plant
