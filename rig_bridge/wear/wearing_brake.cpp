#include "rig_bridge/wear/wearing_brake.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace wear {

namespace {

void check_energy(const char* what, double energy_J) {
    if (!(std::isfinite(energy_J) && energy_J >= 0.0))
        throw std::invalid_argument(fmt::format("{} {} J: must be finite, not negative", what, energy_J));
}

Conditional conditional_at(const Model& model, const BrakeScale& scale, const ConditionalRule& rule, double c_e_J) {
    return friction_given_energy(model, c_e_J / scale.energy, rule);
}

}  // namespace

double friction_at(const Model& model, const BrakeScale& scale, const ConditionalRule& rule, double c_e_J, Generator& generator) {
    return std::max(kMinFriction, scale.friction * conditional_at(model, scale, rule, c_e_J).sample(generator));
}

double expected_friction_at(const Model& model, const BrakeScale& scale, const ConditionalRule& rule, double c_e_J) {
    return std::max(kMinFriction, scale.friction * conditional_at(model, scale, rule, c_e_J).mean());
}

WearingBrake::WearingBrake(BrakeWear wear, const ConditionalRule& rule, const BrakeState& state)
    : wear_(std::move(wear)), rule_(rule), state_(state) {
    if (!wear_.model) throw std::invalid_argument("a wearing brake needs a model");
    if (!(wear_.scale.energy > 0.0 && wear_.scale.friction > 0.0 && wear_.life_J > 0.0))
        throw std::invalid_argument("scales and life of a wearing brake must be positive");
    check_energy("cumulative brake energy", state.c_e_J);
    if (wear_.law) scatter_.emplace(state_.seed, state_.maneuvers);
}

double WearingBrake::next_friction() const {
    if (wear_.law) return std::max(kMinFriction, wear_.scale.friction * scatter_->friction(*wear_.law, state_.c_e_J / wear_.scale.energy));
    Generator generator = generator_of(state_.seed, state_.maneuvers);
    return friction_at(*wear_.model, wear_.scale, rule_, state_.c_e_J, generator);
}

bool WearingBrake::extrapolates() const {
    return !wear_.law && wear_.model->extrapolates(state_.c_e_J / wear_.scale.energy);
}

void WearingBrake::take(double brake_energy_J) {
    check_energy("brake energy", brake_energy_J);
    state_.c_e_J += brake_energy_J;
    ++state_.maneuvers;
    if (scatter_) scatter_->next();
}

}  // namespace wear
