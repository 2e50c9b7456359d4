/// What an owner computes for one aircraft from estimates of what is left of its brake and tyre: how long they last, which mean tyre share makes them
/// last otherwise, and what is worth changing. Wear is taken as linear in energy. Pure.
#pragma once

#include "plant_sim/study/regulation/bound.hpp"
#include "plant_sim/study/regulation/mean_share.hpp"

namespace regulation {

class Economy {
  public:
    /// `costs.visit` includes the days on the ground; `costs.planned` has the expected lives; `landing_J` > 0 is a landing's mean energy. `choices`
    /// must outlive it.
    Economy(const Choices& choices, const Costs& costs, double landing_J) : choices_(&choices), costs_(costs), landing_J_(landing_J) {}

    /// Landings until the first of the parts is used up.
    [[nodiscard]] double landings_left(const Pair& left, const Choice& choice) const;
    /// The share at which the brake and this tyre, or one of the next, last equally long: that of them for which it is nearest to `preferred`.
    [[nodiscard]] const Choice& together(const Pair& left, const Choice& preferred) const;
    /// The share nearest to `choice` at which both parts last for `landings` > 0; if they cannot, the one at which they last equally long.
    [[nodiscard]] const Choice& lasting(const Pair& left, const Choice& choice, double landings) const;
    /// Whether a part with so much left is better changed in a visit of the other part than in one of its own later, as in Costs::at_limit().
    [[nodiscard]] bool brake_worth_changing(double left_J) const;
    [[nodiscard]] bool tyre_worth_changing(double left_J) const;

  private:
    const Choices* choices_;
    Costs costs_;
    double landing_J_;
};

}  // namespace regulation
