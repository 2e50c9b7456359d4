/// The wheel of wheel.hpp on a compliant tyre and leg (compliance.hpp), or on a runway whose friction depends on speed or is not that of eq. (4).
/// Slower than Wheel.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "plant_sim/model/wheel.hpp"

namespace plant {

/// Coefficients of the equations of motion; those of a rigid part are 0.
struct CompliantLaw {
    bool ring = false, relaxes = false, leg = false;
    double aircraft_kg = 0.0, axle_kg = 0.0, leg_Npm = 0.0, leg_Nspm = 0.0;
    double rim_kgm2 = 0.0, belt_kgm2 = 0.0, twist_Nmprad = 0.0, twist_Nms = 0.0;
    double free_radius_m = 0.0, stiffness_Npm = 0.0;
    rig::RelaxationParameters relaxation;
    rig::TyreCurve tyre;
    double slope_at_rest = 0.0;       ///< d mu / d slip of `tyre` at slip 0
    std::optional<rig::WetGrip> wet;  ///< scales the curve `tyre` at every speed
    double per_peak = 1.0;            ///< 1 over the peak of `tyre`
    bool spun_up = true;
    BrakeTorque brake;
};

/// Integrates with RODAS (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.7: Rosenbrock method of order four, stiffly
/// accurate, L-stable). The embedded method of order three controls the step. Energies and distances are integrated with Simpson's rule on the cubic
/// between the ends of a step.
///
/// The rim does not turn backwards: as soon as it stands the brake holds it, until tyre or carcass turn it forwards.
class CompliantWheel {
  public:
    /// Largest error of each part of the state in one step, relative to the part's scale.
    static constexpr double kTolerance = 1e-8;

    /// Throws std::invalid_argument for negative compliance, a belt with all of the inertia, or a leg with all of the mass.
    CompliantWheel(const rig::WheelParameters& parameters, const BrakeTorque& brake, const rig::TyreCurve& tyre, double tolerance = kTolerance);

    /// Advances `state` by `h` seconds. Speeds of belt and axle, bend of the leg and slip of the tread are kept in this object. If speeds in `state`
    /// were changed since the last call (drive, drag), the belt and the axle get the same change.
    void advance(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h);

    void set_brake(const BrakeTorque& brake) { law_.brake = brake; }
    /// `spun_up`: whether the wheel has spun up, which decides the friction of a flooded surface, see WetGrip.
    void set_surface(const rig::Surface& surface, bool spun_up);
    /// Sets wheel, belt and leg to move as one, with no force of the tyre.
    void settle(const WheelState& state);

    [[nodiscard]] Forces forces(const WheelState& state, double pressure_Pa, const LoadArc& load) const;
    /// Energy of all moving parts and springs: m v^2 / 2 + J omega^2 / 2 + k x^2 / 2.
    [[nodiscard]] double energy_J(const WheelState& state) const;
    [[nodiscard]] double energy_leg_J() const { return energy_leg_J_; }  ///< taken by the leg's damper
    [[nodiscard]] double belt_radps() const { return y_[5]; }
    /// Number of attempted steps, rejected ones included.
    [[nodiscard]] std::uint64_t steps() const { return steps_; }

    /// The state: speeds of aircraft and axle, bend of the leg, speed of the rim, twist of the carcass, speed of the belt, slip of the tread.
    static constexpr int kParts = 7;
    using Parts = std::array<double, kParts>;

  private:
    void set_tyre(const rig::TyreCurve& tyre);

    CompliantLaw law_;
    double tolerance_;
    Parts y_{};
    double part_s_ = 1e-4;  // length of the last step
    double energy_leg_J_ = 0.0;
    std::uint64_t steps_ = 0;
};

}  // namespace plant
