/// The plant as one object: valve, brake, wheel, load and sensors on one fixed time step. A landing gear or a
/// flywheel rig, by parameters.
///
/// In the air the wheel carries no load and the speed stays; `touch_down` puts the wheel on the runway or the
/// flywheel, at rest, and the spin-up follows from the same equations. Everything random is drawn from the
/// seed given at construction.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "plant_sim/model/brake.hpp"
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

/// What acts on the rig beside brake and tyre.
struct OutsideForces {
    double drive_N = 0.0;        ///< of the flywheel's drive, at the rim, >= 0
    double drag_N = 0.0;         ///< of the flywheel's bearings and windage, at the rim, >= 0
    double wheel_drag_Nm = 0.0;  ///< of the wheel's bearing and the discs of its released brake, >= 0
};

class Rig {
  public:
    /// `step_s`: 1e-4 to 5e-3.
    Rig(const rig::RigParameters& parameters, double step_s, std::uint64_t seed);

    void touch_down() {
        contact_ = true;
        begin_runway();
    }
    /// The wheel is on the ground, loaded and rolling freely: the state in which a recorded braking maneuver begins.
    void start_rolling();
    /// Wheel at rest off the rim; the flywheel too, the state before a first spin-up, or turning already.
    void start_at_rest(double rim_mps = 0.0);
    /// The pressure at the start of a prescribed profile.
    void start_pressure(double pressure_Pa) { pressure_Pa_ = pressure_Pa; }
    /// Takes the load off again: a bounce, or the sledge retracting.
    void lift_off() { contact_ = false; }

    /// Acts over every step from here on, as uniform acceleration ahead of it: exact for a wheel off the rim. With the wheel on the rim the
    /// splitting is of first order in the step, so keep them small against the brake there.
    void set_outside_forces(const OutsideForces& forces) {
        outside_ = forces;
        pushed_ = forces.drive_N != 0.0 || forces.drag_N != 0.0 || forces.wheel_drag_Nm != 0.0;
    }
    /// Another law of the load; the lag stays, and so does the force that the device holds now.
    void set_load(double base_N, double lift_Ns2pm2);
    /// Another state of the brake for the next maneuver. Throws std::invalid_argument where the friction curve would fall to zero.
    void set_brake(double mean_friction, double brake_on_mps);

    /// Whether nothing but the flywheel moves: wheel off the rim and at rest, no pressure, no drive.
    [[nodiscard]] bool idle() const;
    /// Where idle(): that much time at once, a whole number of steps; the flywheel coasts down in closed form.
    void pass_idle(double seconds, const Drag& drag);

    /// One step with a valve current that is held.
    void advance_current(double current_mA) { advance_current(current_mA, current_mA); }
    /// One step with a valve current that is linear in time.
    void advance_current(double start_mA, double end_mA);
    /// One step with a prescribed brake pressure, linear in time: the valve is bypassed (feed-forward
    /// validation, Section III.C).
    void advance_pressure(double start_Pa, double end_Pa) {
        const PressurePart whole{1.0, start_Pa, end_Pa};
        advance_pressure({&whole, 1});
    }
    /// The same with a pressure that is linear piece by piece.
    struct PressurePart {
        double share;  ///< of the step, above 0; all add up to 1
        double start_Pa, end_Pa;
    };
    void advance_pressure(std::span<const PressurePart> parts);

    [[nodiscard]] double time_s() const { return static_cast<double>(steps_) * step_s_; }
    [[nodiscard]] const WheelState& wheel() const { return state_; }
    [[nodiscard]] double pressure_Pa() const { return pressure_Pa_; }  ///< true pressure at the brake
    [[nodiscard]] Forces forces() const;
    [[nodiscard]] bool standstill() const { return state_.v_mps <= Wheel::kSlowest_mps; }
    /// Of aircraft or flywheel and of the wheel, and what the springs of tyre and leg hold.
    [[nodiscard]] double kinetic_energy_J() const { return compliant_ ? compliant_->energy_J(state_) : dynamics_.kinetic_energy_J(state_); }
    /// What the gear leg's damper has taken since the start.
    [[nodiscard]] double energy_leg_J() const { return compliant_ ? compliant_->energy_leg_J() : 0.0; }
    /// Along the runway, from where its patches count.
    [[nodiscard]] double runway_m() const { return state_.distance_m - runway_began_m_; }
    /// Under the wheel now.
    [[nodiscard]] const rig::Surface& surface() const { return patch_ == 0 ? parameters_.surface : parameters_.runway.patches[patch_ - 1].surface; }
    /// What drive and drag have done since the start; kinetic energy + brake + tyre + leg + drag - drive stays what it was.
    [[nodiscard]] double energy_drive_J() const { return energy_drive_J_; }
    [[nodiscard]] double energy_drag_J() const { return energy_drag_J_; }
    [[nodiscard]] const rig::RigParameters& parameters() const { return parameters_; }

    // What the sensors say now.
    [[nodiscard]] const Encoder& wheel_encoder() const { return wheel_encoder_; }
    [[nodiscard]] const Encoder& flywheel_encoder() const { return flywheel_encoder_; }
    [[nodiscard]] double measured_pressure_Pa() const { return measured_pressure_Pa_; }

  private:
    friend class RigLanes;
    /// Whether the wheel can be computed beside others.
    [[nodiscard]] bool plain() const { return !compliant_ && parameters_.runway.patches.empty(); }

    /// A step under way: valve and load have moved, the wheel has not yet.
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
    void look_at_runway();
    void sense(double wheel_before, double flywheel_before, double since_s);

    rig::RigParameters parameters_;
    Wheel dynamics_;
    std::optional<CompliantWheel> compliant_;  // instead of dynamics_, also where friction depends on speed
    Play play_;
    Valve valve_;
    Encoder wheel_encoder_;
    Encoder flywheel_encoder_;
    rig::Random random_;
    double step_s_;
    std::uint64_t steps_ = 0;
    WheelState state_;
    std::size_t patch_ = 0;  // of the runway, counted from 1; 0: before the first
    bool spun_up_ = true;
    double runway_began_m_ = 0.0;
    bool contact_ = false;
    double device_load_N_ = 0.0;  // of a lagged loading device
    struct Decay {
        double h_s, factor;
    };
    std::array<Decay, 2> decays_{};  // of the device over the lengths that a step is cut into
    std::size_t oldest_decay_ = 0;
    OutsideForces outside_;
    bool pushed_ = false;  // any of them
    double energy_drive_J_ = 0.0;
    double energy_drag_J_ = 0.0;
    double pressure_Pa_ = 0.0;
    double measured_pressure_Pa_ = 0.0;
};

}  // namespace plant
