#include "plant_sim/wear/degradation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace wear {

Degradation::Degradation(const Model& model, const ConditionalRule& rule, const BrakeState& state)
    : model_(model), rule_(rule), state_(state) {
    if (!(std::isfinite(state.c_e_J) && state.c_e_J >= 0.0))
        throw std::invalid_argument(
            fmt::format("cumulative brake energy {} J: must be finite, not negative", state.c_e_J));
}

double Degradation::next_friction() const {
    Generator generator = generator_of(state_.seed, state_.maneuvers);
    return std::max(kLeastFriction, friction_given_energy(model_, state_.c_e_J, rule_).sample(generator));
}

void Degradation::take(double brake_energy_J) {
    if (!(std::isfinite(brake_energy_J) && brake_energy_J >= 0.0))
        throw std::invalid_argument(
            fmt::format("brake energy {} J: must be finite, not negative", brake_energy_J));
    state_.c_e_J += brake_energy_J;
    ++state_.maneuvers;
}

}  // namespace wear
