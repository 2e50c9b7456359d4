#include "plant_sim/study/margins/operating_point.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace study::margins {

double OperatingPoint::wheel_pole_radps(Linearisation linearisation) const {
    const double inertia_ratio = mass_kg * radius_m * radius_m / inertia_kgm2;
    const double road = mu_1 * ((1.0 - slip) + inertia_ratio);
    const double aircraft = linearisation == Linearisation::full ? mu : 0.0;
    return load_N / (mass_kg * speed_mps) * (road - aircraft);
}

OperatingPoint operating_point(const rig::RigParameters& rig, double speed_mps, double slip) {
    if (!(speed_mps > 0.0)) throw std::invalid_argument("an operating point needs a speed above zero");
    if (!(slip > 0.0 && slip < 1.0)) throw std::invalid_argument("an operating point needs a slip between 0 and 1");
    OperatingPoint p;
    p.speed_mps = speed_mps;
    p.slip = slip;
    p.mass_kg = rig.wheel.mass_kg;
    p.inertia_kgm2 = rig.wheel.inertia_kgm2;
    p.load_N = rig.load.base_N - rig.load.lift_Ns2pm2 * speed_mps * speed_mps;
    p.radius_m = rig.wheel.free_radius_m - p.load_N / rig.wheel.stiffness_Npm;
    p.brake_gain_m3 = plant::BrakeTorque(rig.brake, rig.friction_curve, rig.mean_friction, rig.brake_on_mps).gain(speed_mps).k_b;
    const rig::Friction f = rig::friction(rig.surface, slip);
    p.mu = f.mu;
    p.mu_1 = f.mu_1;
    p.ring = rig.wheel.compliance.ring;
    if (const rig::RelaxationParameters& relaxation = rig.wheel.compliance.relaxation; relaxation.length_m > 0.0)
        p.relaxation_m = std::max(relaxation.length_m * f.mu_1 / rig::friction(rig.surface, 0.0).mu_1, relaxation.floor_m);
    p.deceleration_mps2 = p.load_N * f.mu / p.mass_kg;
    // At constant slip the wheel decelerates with the aircraft, eq. (3); the brake takes its kinetic energy, too.
    const double wheel_radps2 = (1.0 - slip) / p.radius_m * p.deceleration_mps2;
    p.pressure_Pa = (p.radius_m * p.load_N * f.mu + p.inertia_kgm2 * wheel_radps2) / p.brake_gain_m3;
    return p;
}

std::vector<double> speed_grid(double first_mps, double last_mps, int count) {
    if (count < 2 || !(last_mps > 0.0) || !(first_mps > last_mps))
        throw std::invalid_argument("a speed grid needs two speeds or more, falling, above zero");
    std::vector<double> speeds;
    speeds.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) speeds.push_back(first_mps * std::pow(last_mps / first_mps, static_cast<double>(i) / (count - 1)));
    return speeds;
}

}  // namespace study::margins
