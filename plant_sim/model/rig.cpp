#include "plant_sim/model/rig.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace plant {

Rig::Rig(const rig::RigParameters& parameters, double step_s, std::uint64_t seed)
    : parameters_(parameters),
      dynamics_(parameters.wheel, BrakeTorque(parameters.brake, parameters.friction_curve, parameters.mean_friction, parameters.brake_on_mps),
                parameters.surface),
      play_(parameters.valve.hysteresis_mA),
      valve_(parameters.valve, step_s),
      wheel_encoder_(parameters.wheel_encoder),
      flywheel_encoder_(parameters.flywheel_encoder),
      random_(seed),
      step_s_(step_s) {
    state_.v_mps = parameters.touchdown_mps > 0.0 ? parameters.touchdown_mps : parameters.brake_on_mps;
    if (parameters.wheel.compliance.any() || !parameters.surface.plain() || !parameters.runway.plain()) {
        compliant_.emplace(parameters.wheel, dynamics_.law().brake, parameters.surface.curve());
        compliant_->set_surface(parameters.surface, spun_up_);
        compliant_->settle(state_);
    }
    if (parameters.clamping.any()) clamp_.emplace(parameters.clamping);
}

/// The surface under the wheel is constant within a step: 6 cm at 61 m/s.
void Rig::update_surface() {
    // Halfway is far from both ends: a wheel that loses or regains contact in deep water passes it quickly.
    constexpr double kTurns = 0.5;
    const std::size_t patch = parameters_.runway.begun(runway_m());
    const bool spun_up = state_.omega_radps * parameters_.wheel.free_radius_m > kTurns * state_.v_mps;
    if (patch == patch_ && (spun_up == spun_up_ || !surface().wet)) return;
    patch_ = patch;
    spun_up_ = spun_up;
    dynamics_.set_tyre(surface().law());
    if (compliant_) compliant_->set_surface(surface(), spun_up);
}

void Rig::start_rolling() {
    contact_ = true;
    begin_runway();
    state_.v_mps = parameters_.brake_on_mps;
    const rig::LoadParameters& law = parameters_.load;
    device_load_N_ = law.base_N - law.lift_Ns2pm2 * state_.v_mps * state_.v_mps;
    const double radius = parameters_.wheel.free_radius_m - device_load_N_ / parameters_.wheel.stiffness_Npm;
    state_.omega_radps = state_.v_mps / radius;
    state_.held = false;
    if (compliant_) compliant_->settle(state_);
}

void Rig::start_at_rest(double rim_mps) {
    contact_ = false;
    device_load_N_ = 0.0;
    state_.v_mps = rim_mps;
    state_.omega_radps = 0.0;
    state_.held = true;
    if (compliant_) compliant_->settle(state_);
}

void Rig::set_load(double base_N, double lift_Ns2pm2) {
    parameters_.load.base_N = base_N;
    parameters_.load.lift_Ns2pm2 = lift_Ns2pm2;
}

void Rig::set_brake(double mean_friction, double brake_on_mps) {
    if (!(rig::min_friction(parameters_.friction_curve, mean_friction) > 0.0) || !(brake_on_mps > 0.0))
        throw std::invalid_argument("mean friction takes the friction curve below zero, or no brake-on speed");
    parameters_.mean_friction = mean_friction;
    parameters_.brake_on_mps = brake_on_mps;
    const BrakeTorque brake(parameters_.brake, parameters_.friction_curve, mean_friction, brake_on_mps);
    dynamics_.set_brake(brake);
    if (compliant_) compliant_->set_brake(brake);
}

bool Rig::idle() const {
    constexpr double kNoPressure_Pa = 1.0;
    constexpr double kNoLoad_N = 1e-3;
    return !contact_ && state_.omega_radps == 0.0 && pressure_Pa_ < kNoPressure_Pa && device_load_N_ < kNoLoad_N && outside_.drive_N == 0.0;
}

void Rig::pass_idle(double seconds, const Drag& drag) {
    const auto steps = static_cast<std::uint64_t>(std::llround(seconds / step_s_));
    if (!idle() || steps == 0) return;
    const double time = static_cast<double>(steps) * step_s_;
    const double before = state_.v_mps;
    const double energy = kinetic_energy_J();
    const CoastDown end = coast_down(drag, parameters_.wheel.mass_kg, before, time);
    state_.v_mps = end.v_mps;
    state_.distance_m += end.distance_m;
    energy_drag_J_ += energy - kinetic_energy_J();
    device_load_N_ = 0.0;
    steps_ += steps - 1;
    sense(0.0, before, time);
}

/// Applies a uniform acceleration over the next step. The excess distance and angle that the integrator will add with the changed speeds is
/// subtracted, so that both correspond to the mean speed.
void Rig::push() {
    const double v0 = state_.v_mps;
    const double omega0 = state_.omega_radps;
    const double energy = kinetic_energy_J();
    const double h = step_s_;
    const double v1 = std::max(v0 + (outside_.drive_N - outside_.drag_N) * h / parameters_.wheel.mass_kg, 0.0);
    const double omega1 = std::max(omega0 - outside_.wheel_drag_Nm * h / parameters_.wheel.inertia_kgm2, 0.0);
    const double drive_J = outside_.drive_N * 0.5 * (v0 + v1) * h;
    state_.v_mps = v1;
    state_.omega_radps = omega1;
    const bool moves = v1 > Wheel::kSlowest_mps;
    state_.distance_m += 0.5 * (v0 + v1) * h - (moves ? v1 * h : 0.0);
    state_.angle_rad += 0.5 * (omega0 + omega1) * h - (moves ? omega1 * h : 0.0);
    energy_drive_J_ += drive_J;
    energy_drag_J_ += drive_J - (kinetic_energy_J() - energy);
}

double Rig::load_decay(double h) {
    for (const Decay& known : decays_) {
        if (known.h_s == h) return known.factor;
    }
    Decay& fresh = decays_[oldest_decay_];
    oldest_decay_ = 1 - oldest_decay_;
    fresh = {h, std::exp(-h / parameters_.load.lag_s)};
    return fresh.factor;
}

LoadArc Rig::load_arc(double h) {
    const rig::LoadParameters& law = parameters_.load;
    if (law.lag_s <= 0.0) return contact_ ? LoadArc{law.base_N, 0.0, law.lift_Ns2pm2} : LoadArc{};
    // The device follows its set-point by a first-order lag, exact for a set-point that is held over the
    // step.
    const double set_point = contact_ ? law.base_N - law.lift_Ns2pm2 * state_.v_mps * state_.v_mps : 0.0;
    const double before = device_load_N_;
    device_load_N_ = set_point + (before - set_point) * load_decay(h);
    return {before, device_load_N_ - before, 0.0};
}

Forces Rig::forces() const {
    const rig::LoadParameters& law = parameters_.load;
    const LoadArc now = law.lag_s > 0.0 ? LoadArc{device_load_N_, 0.0, 0.0} : contact_ ? LoadArc{law.base_N, 0.0, law.lift_Ns2pm2} : LoadArc{};
    const double pressure_Pa = clamp_ ? clamp_->pressure_Pa(state_.angle_rad) : pressure_Pa_;
    return compliant_ ? compliant_->forces(state_, pressure_Pa, now) : dynamics_.forces(state_, pressure_Pa, now);
}

void Rig::move(const PressureArc& pressure, const LoadArc& load, double h) {
    const PressureArc clamping = clamp_ ? clamp_->follow(pressure, state_.angle_rad, state_.angle_rad + state_.omega_radps * h) : pressure;
    if (compliant_)
        compliant_->advance(state_, clamping, load, h);
    else
        dynamics_.advance(state_, clamping, load, h);
}

void Rig::sense(double wheel_before, double flywheel_before, double since_s) {
    ++steps_;
    const double now = time_s();
    const double per_radius = 1.0 / parameters_.flywheel_radius_m;
    wheel_encoder_.advance(state_.angle_rad, wheel_before, state_.omega_radps, now, since_s, random_);
    flywheel_encoder_.advance(state_.distance_m * per_radius, flywheel_before * per_radius, state_.v_mps * per_radius, now, since_s, random_);
    measured_pressure_Pa_ = reading_Pa(parameters_.transducer, pressure_Pa_, random_);
}

Rig::Step Rig::begin(double start_mA, double end_mA) {
    const double wheel_before = state_.omega_radps;
    const double flywheel_before = state_.v_mps;
    if (pushed_) push();
    update_surface();
    const double start_Pa = parameters_.pressure_map.pressure_Pa(play_.follow(start_mA));
    const double end_Pa = end_mA == start_mA ? start_Pa : parameters_.pressure_map.pressure_Pa(play_.follow(end_mA));
    const Valve::Arcs arcs = valve_.advance(start_Pa, end_Pa);
    if (valve_.first_s() > 0.0) move(arcs.first, load_arc(valve_.first_s()), valve_.first_s());
    return {wheel_before, flywheel_before, arcs.second, load_arc(valve_.second_s()), valve_.second_s()};
}

void Rig::end(const Step& step) {
    pressure_Pa_ = valve_.pressure_Pa();
    sense(step.wheel_before_radps, step.flywheel_before_mps, step_s_);
}

void Rig::advance_current(double start_mA, double end_mA) {
    const Step step = begin(start_mA, end_mA);
    move(step.pressure, step.load, step.h);
    end(step);
}

void Rig::advance_pressure(std::span<const PressurePart> parts) {
    const double wheel_before = state_.omega_radps;
    const double flywheel_before = state_.v_mps;
    if (pushed_) push();
    update_surface();
    for (const PressurePart& part : parts) {
        const double h = part.share * step_s_;
        move(PressureArc::linear(part.start_Pa, part.end_Pa), load_arc(h), h);
    }
    pressure_Pa_ = parts.back().end_Pa;
    sense(wheel_before, flywheel_before, step_s_);
}

}  // namespace plant
