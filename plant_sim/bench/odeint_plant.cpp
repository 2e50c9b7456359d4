#include "plant_sim/bench/odeint_plant.hpp"

#include <cmath>

namespace bench {

namespace odeint = boost::numeric::odeint;

Equations::Equations(const rig::RigParameters& rig)
    : brake_(rig.brake, rig.friction_curve, rig.mean_friction, rig.brake_on_mps),
      tyre_(rig.surface.law()),
      base_N_(rig.load.base_N),
      lift_(rig.load.lift_Ns2pm2),
      free_radius_(rig.wheel.free_radius_m),
      per_stiffness_(1.0 / rig.wheel.stiffness_Npm),
      per_mass_(1.0 / rig.wheel.mass_kg),
      per_inertia_(1.0 / rig.wheel.inertia_kgm2),
      w2_(rig.valve.natural_frequency_radps * rig.valve.natural_frequency_radps),
      damping_(2.0 * rig.valve.damping * rig.valve.natural_frequency_radps) {}

OdeintRig::OdeintRig(const rig::RigParameters& rig, double tolerance, std::uint64_t seed)
    : parameters_(rig),
      equations_(rig),
      stepper_(odeint::make_controlled<Dopri5>(tolerance, tolerance)),
      delay_line_(static_cast<std::size_t>(std::lround(rig.valve.delay_s / kStep_s)), 0.0),
      wheel_encoder_(rig.wheel_encoder),
      flywheel_encoder_(rig.flywheel_encoder),
      random_(seed) {
    x_[kSpeed] = rig.brake_on_mps;
    equations_.loaded = false;
}

void OdeintRig::advance_current(double current_mA) {
    const double wheel_before = x_[kOmega];
    const double flywheel_before = x_[kSpeed];
    double acting = parameters_.pressure_map.pressure_Pa(current_mA);
    if (!delay_line_.empty()) {
        std::swap(acting, delay_line_[next_]);
        next_ = (next_ + 1) % delay_line_.size();
    }
    equations_.start_Pa = acting;
    if (!standstill()) {
        // A new input: what the method kept from its last stage is no longer true.
        stepper_.reset();
        double t = time_s();
        const double end = t + kStep_s;
        while (t < end - 1e-12) {
            double step = std::min(next_step_s_, end - t);
            const bool cut = step < next_step_s_;
            if (stepper_.try_step(std::cref(equations_), x_, t, step) == odeint::success) {
                if (!cut || step < next_step_s_) next_step_s_ = step;
                if (x_[kOmega] < 0.0) x_[kOmega] = 0.0;
            } else {
                next_step_s_ = step;
            }
        }
    }
    ++steps_;
    const double per_radius = 1.0 / parameters_.flywheel_radius_m;
    wheel_encoder_.advance(x_[kAngle], wheel_before, x_[kOmega], time_s(), kStep_s, random_);
    flywheel_encoder_.advance(x_[kDistance] * per_radius, flywheel_before * per_radius, x_[kSpeed] * per_radius, time_s(), kStep_s, random_);
    measured_Pa_ = plant::reading_Pa(parameters_.transducer, std::max(x_[kPressure], 0.0), random_);
}

}  // namespace bench
