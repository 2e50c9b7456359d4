/// The brake from maneuver to maneuver: c_e grows by what each takes, and the mean friction of the next is drawn from eq. (14).
#pragma once

#include <cstdint>

#include "plant_sim/wear/model.hpp"

namespace wear {

/// All that one brake remembers; enough to go on later, elsewhere, as if nothing had been between.
struct BrakeState {
    std::uint64_t seed = 1;
    std::uint64_t maneuvers = 0;  ///< since the brake was new, or since it was taken up
    double c_e_J = 0.0;
    bool operator==(const BrakeState&) const = default;
};

class Degradation {
  public:
    /// No friction is drawn below this: a brake with less would not be one, and no plant could stop.
    static constexpr double kLeastFriction = 0.01;

    /// `model` must outlive this. Throws std::invalid_argument for an energy that is negative or not finite.
    Degradation(const Model& model, const ConditionalRule& rule, const BrakeState& state);

    /// Mean mu_b of the maneuver that comes next, at the c_e recorded so far (the paper's procedure). The same until take() is called: the draw
    /// belongs to seed and number of the maneuver. At least kLeastFriction.
    [[nodiscard]] double next_friction() const;
    /// Whether next_friction() is beyond the model's data; kHowItExtrapolates says how it is found then.
    [[nodiscard]] bool extrapolates() const { return model_.extrapolates(state_.c_e_J); }
    /// The maneuver took `brake_energy_J` >= 0, eq. (9). Throws std::invalid_argument for anything else.
    void take(double brake_energy_J);
    [[nodiscard]] const BrakeState& state() const { return state_; }

  private:
    const Model& model_;
    ConditionalRule rule_;
    BrakeState state_;
};

}  // namespace wear
