#include "rig_bridge/wear/lining_likelihood.hpp"

#include <algorithm>
#include <cmath>

namespace wear {

LiningLikelihood::LiningLikelihood(const LifeCurves& curves, double more)
    : log_life_(curves.log_life),
      log_life_deviation_(curves.log_life_deviation),
      slope_(curves.lining.slope),
      slope_by_life_(curves.lining.by_life),
      slope_variance_(curves.lining.variance + more * more * slope_ * slope_),
      variance_(curves.lining.error * curves.lining.error) {}

void LiningLikelihood::read(const LiningReading& reading) {
    squares_J2_ += reading.c_e_J * reading.c_e_J;
    products_J_ += reading.c_e_J * reading.worn;
}

double LiningLikelihood::log_likelihood(double life_J) const {
    constexpr double kMaxDeviations = 3.0;  // of lives that were learnt from
    const double deviations = std::clamp((std::log(life_J) - log_life_) / log_life_deviation_, -kMaxDeviations, kMaxDeviations);
    const double slope = slope_ + deviations * slope_by_life_;
    // The slope integrated out: precision and mean times precision of its posterior.
    const double precision = squares_J2_ / (life_J * life_J * variance_) + 1.0 / slope_variance_;
    const double pull = products_J_ / (life_J * variance_) + slope / slope_variance_;
    return 0.5 * (pull * pull / precision - slope * slope / slope_variance_ - std::log(precision));
}

std::vector<double> LiningLikelihood::given(const std::vector<double>& lives_J, std::size_t count) const {
    std::vector<double> weights(lives_J.size());
    std::transform(lives_J.begin(), lives_J.end(), weights.begin(), [&](double life_J) { return log_likelihood(life_J); });
    const double greatest = *std::max_element(weights.begin(), weights.end());
    double sum = 0.0;
    for (double& w : weights) sum += w = std::exp(w - greatest);
    std::vector<double> out(count, lives_J.back());
    double below = 0.0;
    std::size_t i = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double share = (static_cast<double>(k) + 0.5) / static_cast<double>(count) * sum;
        while (i + 1 < lives_J.size() && below + weights[i] <= share) below += weights[i++];
        out[k] = lives_J[i];
    }
    return out;
}

}  // namespace wear
