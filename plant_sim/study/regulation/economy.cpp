#include "plant_sim/study/regulation/economy.hpp"

#include <algorithm>

namespace regulation {

double Economy::landings_left(const Pair& left, const Choice& choice) const {
    return std::min(left.brake_J / (1.0 - choice.mean_share), left.tyre_J / choice.mean_share) / landing_J_;
}

const Choice& Economy::together(const Pair& left, const Choice& preferred) const {
    double tyres_J = left.tyre_J;
    double before = 0.0;
    double share = tyres_J / (tyres_J + left.brake_J);
    while (share < preferred.mean_share) {
        before = share;
        tyres_J += costs_.planned.tyre_J;
        share = tyres_J / (tyres_J + left.brake_J);
    }
    return choices_->at(preferred.mean_share - before < share - preferred.mean_share ? before : share);
}

const Choice& Economy::lasting(const Pair& left, const Choice& choice, double landings) const {
    const double energy_J = landings * landing_J_;
    const double least = 1.0 - left.brake_J / energy_J, greatest = left.tyre_J / energy_J;
    if (least > greatest) return choices_->at(left.tyre_J / (left.tyre_J + left.brake_J));
    return choices_->at(std::clamp(choice.mean_share, least, greatest));
}

bool Economy::brake_worth_changing(double left_J) const {
    return left_J * costs_.brake_per_J < costs_.visit * (1.0 - left_J / costs_.planned.brake_J);
}

bool Economy::tyre_worth_changing(double left_J) const {
    return left_J * costs_.tyre_per_J < costs_.visit * (1.0 - left_J / costs_.planned.tyre_J);
}

}  // namespace regulation
