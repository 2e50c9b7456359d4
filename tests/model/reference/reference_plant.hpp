/// The braked wheel of eq. (1) to (6), (8) and (9) once more, on SUNDIALS CVODES, written from the paper. It shares the plant's parameter
/// structures and no code. Every event is located by root finding: lock, release, pressure reaching zero; the integrator starts anew at
/// every knot of the input.
#pragma once

#include <functional>
#include <vector>

#include "plant_sim/model/rig.hpp"

namespace reference {

/// The input over time: linear between points, a jump where two points have the same time, held after the last.
struct Knot {
    double time_s;
    double value;
};
using Profile = std::vector<Knot>;

/// Limits from the left and from the right, which differ at a jump.
[[nodiscard]] double value_before(const Profile& profile, double time_s);
[[nodiscard]] double value_after(const Profile& profile, double time_s);

struct Motion {
    double time_s = 0.0;
    double v_mps = 0.0;
    double omega_radps = 0.0;
    double pressure_Pa = 0.0;
    double distance_m = 0.0;
    double angle_rad = 0.0;
    double energy_brake_J = 0.0;
    double energy_tyre_J = 0.0;
    double friction_distance_m = 0.0;
    bool held = false;
};

struct Options {
    double relative_tolerance = 1e-10;
    double until_mps = 5.0;        ///< the run ends when the speed has fallen to this
    double longest_s = 60.0;       ///< or here
    double output_s = 1e-3;        ///< spacing of the outputs
    bool from_rest = false;        ///< the wheel stands at the start (touchdown) instead of rolling freely
    bool integrals_decide = true;  ///< the error of distance and energies decides the step too
};

/// What drives the brake: pressure itself, or the static pressure that eq. (6) delays and filters.
enum class Input { pressure, valve };

/// Calls `output` at the start and at every multiple of `output_s`; returns the last state.
Motion integrate(const rig::RigParameters& parameters, Input input, const Profile& profile, const Options& options,
                 const std::function<void(const Motion&)>& output);

/// m v^2 / 2 + J omega^2 / 2.
[[nodiscard]] double kinetic_energy_J(const rig::RigParameters& parameters, const Motion& motion);

}  // namespace reference
