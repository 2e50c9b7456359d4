#include "plant_sim/model/clamp.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace plant {

Clamp::Clamp(const rig::Clamping& parameters) : parameters_(parameters) {
    const auto share = [](double x) { return x >= 0.0 && x < 1.0; };
    if (!(parameters.contact_Pa >= 0.0) || !share(parameters.piston_friction) || !share(parameters.run_out + parameters.warp))
        throw std::invalid_argument("a brake's contact pressure is below 0, or its piston friction or its run-out and warp not in [0, 1)");
}

void Clamp::follow(double pressure_Pa) {
    const double net_Pa = parameters_.net_Pa(pressure_Pa);
    clamped_Pa_ = std::clamp(clamped_Pa_, net_Pa * (1.0 - parameters_.piston_friction), net_Pa * (1.0 + parameters_.piston_friction));
}

PressureArc Clamp::follow(const PressureArc& pressure, double from_rad, double to_rad) {
    const double before_Pa = pressure_Pa(from_rad);
    follow(pressure.at(1.0));
    return PressureArc::linear(before_Pa, pressure_Pa(to_rad));
}

double Clamp::pressure_Pa(double angle_rad) const {
    return clamped_Pa_ * (1.0 + parameters_.run_out * std::sin(angle_rad) + parameters_.warp * std::sin(2.0 * angle_rad));
}

}  // namespace plant
