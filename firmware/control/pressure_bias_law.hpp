/// Pressure-bias modulation, as in fielded aircraft anti-skid systems: acts on the velocity error against a reference speed that follows the wheel
/// down no faster than an aircraft decelerates. The second baseline for the slip law. Has no slip reference.
///
/// Sources: S. M. Stubbs and J. A. Tanner, Behavior of aircraft antiskid braking systems on dry and wet runway surfaces: a
/// velocity-rate-controlled, pressure-bias-modulated system, NASA TN D-8332 (1976), and a slip-velocity-controlled one, NASA TN D-8455
/// (1977); the bias set before the first skid: Salamat and Cook, US 6132016 (Hydro-Aire).
///
/// As in those systems the reference speed comes from the braked wheel alone: the law uses neither the aircraft's speed nor slip, road torque or
/// prediction, and the pressure only at its start. Its wheel speed and deceleration are better than theirs, from the controller's observer instead of
/// a tachometer and a differentiator.
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/estimate.hpp"

namespace antiskid::control {

class PressureBiasLaw {
  public:
    PressureBiasLaw(const PressureBiasConfig& config, float period_s);

    /// Sets the bias that keeps the present pressure.
    void start(const Estimate& estimate);
    /// Restarts after a locked wheel, for which the supervisor dumped the pressure: keeps the bias, if one was set.
    void resume(const Estimate& estimate);
    /// Call in the air or when disarmed: the next resume() starts without a bias.
    void forget_runway() { laid_up_ = false; }
    /// The metered pressure `ceiling_Pa` as reduced by the law.
    [[nodiscard]] float pressure_Pa(const Estimate& estimate, float ceiling_Pa);
    [[nodiscard]] float reference_mps() const { return reference_mps_; }
    [[nodiscard]] float bias_Pa() const { return bias_Pa_; }

  private:
    PressureBiasConfig config_;
    float period_s_;
    bool skidded_ = false;
    bool laid_up_ = false;        // the bias that keeps the initial pressure is set
    float start_Pa_ = 0.0F;       // initial pressure
    float reference_mps_ = 0.0F;  // lowest rim speed that the aircraft can have
    float bias_Pa_ = 0.0F;
};

}  // namespace antiskid::control
