/// Pressure-bias modulation, what fielded aircraft anti-skid systems do: velocity error against a reference speed that follows the wheel
/// down no faster than an aircraft slows. The second baseline that the slip law is compared with. No slip reference.
///
/// Sources: S. M. Stubbs and J. A. Tanner, Behavior of aircraft antiskid braking systems on dry and wet runway surfaces: a
/// velocity-rate-controlled, pressure-bias-modulated system, NASA TN D-8332 (1976), and a slip-velocity-controlled one, NASA TN D-8455
/// (1977); the bias that is laid up before the first skid: Salamat and Cook, US 6132016 (Hydro-Aire).
///
/// As in those systems the reference speed comes from the braked wheel alone: the law knows neither the aircraft's speed nor slip, road
/// torque or prediction, and the pressure only at its start. Its wheel speed and deceleration are better than theirs: the controller's
/// observer, not a tachometer and a differentiator.
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/estimate.hpp"

namespace antiskid::control {

class PressureBiasLaw {
  public:
    PressureBiasLaw(const PressureBiasConfig& config, float period_s);

    /// Lays up the bias that keeps the present pressure.
    void start(const Estimate& estimate);
    /// The same after a lock, which dumps the pressure beside the law: the bias is what it was, if there was one.
    void resume(const Estimate& estimate);
    /// In the air, or disarmed: `resume` finds no bias.
    void forget_runway() { laid_up_ = false; }
    /// What the anti-skid valve leaves of the metered pressure `ceiling_Pa`.
    [[nodiscard]] float pressure_Pa(const Estimate& estimate, float ceiling_Pa);
    [[nodiscard]] float reference_mps() const { return reference_mps_; }
    [[nodiscard]] float bias_Pa() const { return bias_Pa_; }

  private:
    PressureBiasConfig config_;
    float period_s_;
    bool skidded_ = false;
    bool laid_up_ = false;        // the bias that keeps the pressure of the start
    float start_Pa_ = 0.0F;       // that pressure
    float reference_mps_ = 0.0F;  // rim speed that an aircraft on this wheel could have at least
    float bias_Pa_ = 0.0F;
};

}  // namespace antiskid::control
