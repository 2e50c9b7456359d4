/// The pressure that clamps the discs, from the brake's pressure and the wheel's angle (rig::Clamping). Multiplied with k_b it is the torque.
#pragma once

#include "plant_sim/model/wheel_arcs.hpp"
#include "rig_bridge/rig/clamping.hpp"

namespace plant {

class Clamp {
  public:
    /// Throws std::invalid_argument for a contact pressure below 0, or a share that is not in [0, 1).
    explicit Clamp(const rig::Clamping& parameters);

    /// Follows `pressure` over a step in which the wheel turns from one angle to the other. Linear over the step, which is of second order in its
    /// length, where a brake without clamping takes the valve's cubic.
    PressureArc follow(const PressureArc& pressure, double from_rad, double to_rad);

    /// At the end of the last step.
    [[nodiscard]] double pressure_Pa(double angle_rad) const;

  private:
    void follow(double pressure_Pa);

    rig::Clamping parameters_;
    double clamped_Pa_ = 0.0;  // without run-out
};

}  // namespace plant
