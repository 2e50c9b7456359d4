/// The plant: valve, brake, wheel, load and sensors with one fixed time step. The parameters make it a landing gear or a flywheel rig.
///
/// Without contact the wheel carries no load and the speed v stays constant. touch_down() puts the wheel, at rest, on the runway or the flywheel; its
/// spin-up follows from the same equations. All noise and scatter are drawn from the seed given to the constructor: the same seed and calls give the
/// same bits.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "plant_sim/model/brake.hpp"
#include "plant_sim/model/clamp.hpp"
#include "plant_sim/model/compliant_wheel.hpp"
#include "plant_sim/model/drag.hpp"
#include "plant_sim/model/encoder.hpp"
#include "plant_sim/model/valve.hpp"
#include "plant_sim/model/wheel.hpp"
#include "rig_bridge/rig/random.hpp"
#include "rig_bridge/rig/rig_parameters.hpp"

namespace plant {

inline double reading_Pa(const rig::TransducerParameters& transducer, double pressure_Pa, rig::Random& random) {
    double reading = pressure_Pa + transducer.noise_Pa * random.noise();
    if (transducer.resolution_Pa > 0.0) reading = transducer.resolution_Pa * std::nearbyint(reading / transducer.resolution_Pa);
    return std::clamp(reading, 0.0, transducer.range_Pa);
}

/// External forces beside brake and tyre.
struct OutsideForces {
    double drive_N = 0.0;        ///< of the flywheel's drive, at the rim, >= 0; accelerates
    double drag_N = 0.0;         ///< of the flywheel's bearings and windage, at the rim, >= 0
    double wheel_drag_Nm = 0.0;  ///< of the wheel's bearing and the discs of its released brake, >= 0
};

class Rig {
  public:
    /// `step_s`: length of every step, 1e-4 to 5e-3. Throws std::invalid_argument for a valve, brake, tyre or leg that cannot be.
    Rig(const rig::RigParameters& parameters, double step_s, std::uint64_t seed);

    void touch_down() {
        contact_ = true;
        begin_runway();
    }
    /// Puts the wheel on the ground, loaded and rolling freely: the initial state of a recorded braking maneuver.
    void start_rolling();
    /// Puts the wheel at rest off the rim; the flywheel turns with `rim_mps`, 0 before a first spin-up.
    void start_at_rest(double rim_mps = 0.0);
    /// Sets the initial pressure of a prescribed profile.
    void start_pressure(double pressure_Pa) { pressure_Pa_ = pressure_Pa; }
    /// Removes the load: a bounce, or the sledge retracts.
    void lift_off() { contact_ = false; }

    /// Sets the external forces for all following steps. Each step applies them first, as uniform acceleration: exact for a wheel off the rim. With
    /// the wheel on the rim the splitting is of first order in the step, so the forces should be small against the brake's.
    void set_outside_forces(const OutsideForces& forces) {
        outside_ = forces;
        pushed_ = forces.drive_N != 0.0 || forces.drag_N != 0.0 || forces.wheel_drag_Nm != 0.0;
    }
    /// Replaces the load's dependence on speed, base_N - lift v^2. The loading device keeps its lag and its present force.
    void set_load(double base_N, double lift_Ns2pm2);
    /// Replaces the brake's friction for the next maneuver. Throws std::invalid_argument if its friction curve would fall to zero.
    void set_brake(double mean_friction, double brake_on_mps);

    /// Whether only the flywheel can move: wheel off the rim and at rest, no pressure, no drive.
    [[nodiscard]] bool idle() const;
    /// Only if idle(): advances by `seconds`, a whole number of steps, at once. The flywheel coasts down in closed form.
    void pass_idle(double seconds, const Drag& drag);

    /// Advances by one step with a constant valve current.
    void advance_current(double current_mA) { advance_current(current_mA, current_mA); }
    /// Advances by one step with a valve current that is linear in time.
    void advance_current(double start_mA, double end_mA);
    /// Advances by one step with a prescribed brake pressure that is linear in time; the valve is bypassed (feed-forward validation, Section III.C).
    void advance_pressure(double start_Pa, double end_Pa) {
        const PressurePart whole{1.0, start_Pa, end_Pa};
        advance_pressure({&whole, 1});
    }
    /// One piece of a pressure that is piecewise linear in time.
    struct PressurePart {
        double share;  ///< of the step, > 0; the shares of all pieces add up to 1
        double start_Pa, end_Pa;
    };
    void advance_pressure(std::span<const PressurePart> parts);

    [[nodiscard]] double time_s() const { return static_cast<double>(steps_) * step_s_; }
    [[nodiscard]] const WheelState& wheel() const { return state_; }
    [[nodiscard]] double pressure_Pa() const { return pressure_Pa_; }  ///< true pressure at the brake
    [[nodiscard]] Forces forces() const;
    [[nodiscard]] bool standstill() const { return state_.v_mps <= Wheel::kSlowest_mps; }
    /// m v^2 / 2 + J omega^2 / 2, and the energy in the springs of tyre and leg.
    [[nodiscard]] double kinetic_energy_J() const { return compliant_ ? compliant_->energy_J(state_) : dynamics_.kinetic_energy_J(state_); }
    /// Energy taken by the damper of the gear leg since the start.
    [[nodiscard]] double energy_leg_J() const { return compliant_ ? compliant_->energy_leg_J() : 0.0; }
    /// Distance along the runway, from the origin of its patches.
    [[nodiscard]] double runway_m() const { return state_.distance_m - runway_began_m_; }
    /// The surface under the wheel.
    [[nodiscard]] const rig::Surface& surface() const { return patch_ == 0 ? parameters_.surface : parameters_.runway.patches[patch_ - 1].surface; }
    /// Work of drive and drag since the start. Kinetic energy + brake + tyre + leg + drag - drive is constant.
    [[nodiscard]] double energy_drive_J() const { return energy_drive_J_; }
    [[nodiscard]] double energy_drag_J() const { return energy_drag_J_; }
    [[nodiscard]] const rig::RigParameters& parameters() const { return parameters_; }

    // Sensor readings of the newest step.
    [[nodiscard]] const Encoder& wheel_encoder() const { return wheel_encoder_; }
    [[nodiscard]] const Encoder& flywheel_encoder() const { return flywheel_encoder_; }
    [[nodiscard]] double measured_pressure_Pa() const { return measured_pressure_Pa_; }

  private:
    friend class RigLanes;
    /// Whether RigLanes can compute this wheel beside others.
    [[nodiscard]] bool plain() const { return !compliant_ && !clamp_ && parameters_.runway.patches.empty(); }

    /// An unfinished step: valve and load are advanced, the wheel is not.
    struct Step {
        double wheel_before_radps = 0.0, flywheel_before_mps = 0.0;
        PressureArc pressure;
        LoadArc load;
        double h = 0.0;
    };
    [[nodiscard]] Step begin(double start_mA, double end_mA);
    void end(const Step& step);
    [[nodiscard]] LoadArc load_arc(double h);
    [[nodiscard]] double load_decay(double h);
    void push();
    void move(const PressureArc& pressure, const LoadArc& load, double h);
    void begin_runway() {
        if (parameters_.runway.from_touchdown) runway_began_m_ = state_.distance_m;
    }
    void update_surface();
    void sense(double wheel_before, double flywheel_before, double since_s);

    rig::RigParameters parameters_;
    Wheel dynamics_;
    std::optional<CompliantWheel> compliant_;  // used instead of dynamics_ for compliant parts, and where friction is not eq. (4)
    std::optional<Clamp> clamp_;               // used for a brake whose torque is not in proportion to its pressure
    Play play_;
    Valve valve_;
    Encoder wheel_encoder_;
    Encoder flywheel_encoder_;
    rig::Random random_;
    double step_s_;
    std::uint64_t steps_ = 0;
    WheelState state_;
    std::size_t patch_ = 0;  // of the runway, counted from 1; 0: not yet on the first
    bool spun_up_ = true;
    double runway_began_m_ = 0.0;
    bool contact_ = false;
    double device_load_N_ = 0.0;  // of a lagged loading device
    struct Decay {
        double h_s, factor;
    };
    std::array<Decay, 2> decays_{};  // of the device, for the lengths of partial steps
    std::size_t oldest_decay_ = 0;
    OutsideForces outside_;
    bool pushed_ = false;  // some outside force is not 0
    double energy_drive_J_ = 0.0;
    double energy_drag_J_ = 0.0;
    double pressure_Pa_ = 0.0;
    double measured_pressure_Pa_ = 0.0;
};

}  // namespace plant
