#include "rig_bridge/wear/lining_law.hpp"

#include <algorithm>
#include <cmath>

namespace wear {

void LiningTemperature::step(const LiningLaw& law, double draw) {
    temperature_ = law.memory * temperature_ + std::sqrt(1.0 - law.memory * law.memory) * draw;
    following_ = std::clamp(following_, temperature_ - law.play, temperature_ + law.play);
}

double expected_friction(const LiningLaw& law, double worn_J) {
    const double life = worn_J / law.lining_J;
    const double core = std::max(0.0, (life - 1.0 + law.core_share) / law.core_share);
    return law.plateau + law.run_in / (1.0 + std::pow(worn_J / law.run_in_J, 1.5)) - law.loss * life - law.core_loss * core * core;
}

LiningScatter::LiningScatter(std::uint64_t seed, std::uint64_t number) : seed_(seed), number_(number) {
    for (std::uint64_t k = 0; k <= kRemembered; ++k) draw(number + k);
}

void LiningScatter::next() {
    ++number_;
    draw(number_ + kRemembered);
}

void LiningScatter::draw(std::uint64_t stream) {
    Generator generator = generator_of(seed_, stream);
    temperatures_.at(stream % temperatures_.size()) = normal(generator);
    measurement_ = normal(generator);
}

double LiningScatter::friction(const LiningLaw& law, double worn_J) const {
    const auto drawn = [this](std::uint64_t k) { return temperatures_.at((number_ + k) % temperatures_.size()); };
    LiningTemperature temperature(drawn(0));
    for (std::uint64_t k = 1; k <= kRemembered; ++k) temperature.step(law, drawn(k));
    return expected_friction(law, worn_J) + law.per_temperature * temperature.following() + law.measurement * measurement_;
}

}  // namespace wear
