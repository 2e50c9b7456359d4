/// The wheel of wheel.hpp on a tyre and a leg that give way (compliance.hpp), or on a runway whose friction depends on speed. Slower than
/// Wheel.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "plant_sim/model/wheel.hpp"

namespace plant {

/// The numbers of its equations; zero where a part does not give way.
struct CompliantLaw {
    bool ring = false, relaxes = false, leg = false;
    double aircraft_kg = 0.0, axle_kg = 0.0, leg_Npm = 0.0, leg_Nspm = 0.0;
    double rim_kgm2 = 0.0, belt_kgm2 = 0.0, twist_Nmprad = 0.0, twist_Nms = 0.0;
    double free_radius_m = 0.0, stiffness_Npm = 0.0;
    rig::RelaxationParameters relaxation;
    rig::FrictionLaw tyre;
    double slope_at_rest = 0.0;       ///< of its mu over slip
    std::optional<rig::WetGrip> wet;  ///< scales the curve `tyre` at every speed
    double per_peak = 1.0;            ///< 1 over the curve's own peak
    bool spun_up = true;
    BrakeTorque brake;
};

/// Integrates with RODAS (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.7: Rosenbrock, stiffly accurate,
/// L-stable, order four), its step controlled by the embedded method of order three. Quadratures by Simpson's rule on the cubic between
/// the ends of a step.
///
/// The rim does not turn backwards: the brake holds it as soon as it stands, until tyre or carcass turn it forwards.
class CompliantWheel {
  public:
    /// Of each part of the state, over its own scale, in one step or part of it.
    static constexpr double kTolerance = 1e-8;

    /// Throws std::invalid_argument where compliance is negative, a belt has all the inertia, or a leg all the mass.
    CompliantWheel(const rig::WheelParameters& parameters, const BrakeTorque& brake, const rig::FrictionLaw& tyre, double tolerance = kTolerance);

    /// Advances `state` by `h` seconds; belt, slip of the tread and leg stand in here. Speeds that were changed from outside since the
    /// last call (a drive, drag) are belt's and axle's change, too.
    void advance(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h);

    void set_brake(const BrakeTorque& brake) { law_.brake = brake; }
    /// `spun_up`: what a flooded one takes the wheel for, see WetGrip.
    void set_surface(const rig::Surface& surface, bool spun_up);
    /// Wheel, belt and leg move as one, the tyre without force.
    void settle(const WheelState& state);

    [[nodiscard]] Forces forces(const WheelState& state, double pressure_Pa, const LoadArc& load) const;
    /// Of all that moves, and what springs hold: m v^2 / 2 + J omega^2 / 2 + k x^2 / 2, part by part.
    [[nodiscard]] double energy_J(const WheelState& state) const;
    [[nodiscard]] double energy_leg_J() const { return energy_leg_J_; }  ///< that the leg's damper took
    [[nodiscard]] double belt_radps() const { return y_[5]; }
    /// Tried so far, those that were too long included.
    [[nodiscard]] std::uint64_t steps() const { return steps_; }

    /// Speeds of aircraft and axle, bend of the leg, speed of the rim, twist, speed of the belt, slip of the tread.
    static constexpr int kParts = 7;
    using Parts = std::array<double, kParts>;

  private:
    void set_tyre(const rig::FrictionLaw& tyre);

    CompliantLaw law_;
    double tolerance_;
    Parts y_{};
    double part_s_ = 1e-4;  // that the last step took
    double energy_leg_J_ = 0.0;
    std::uint64_t steps_ = 0;
};

}  // namespace plant
