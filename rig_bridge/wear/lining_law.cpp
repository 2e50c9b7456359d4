#include "rig_bridge/wear/lining_law.hpp"

#include <algorithm>
#include <cmath>

namespace wear {

void LiningTemperature::step(const LiningLaw& law, Generator& generator) {
    temperature_ = law.memory * temperature_ + std::sqrt(1.0 - law.memory * law.memory) * normal(generator);
    following_ = std::clamp(following_, temperature_ - law.play, temperature_ + law.play);
}

double expected_friction(const LiningLaw& law, double worn_J) {
    const double life = worn_J / law.lining_J;
    const double core = std::max(0.0, (life - 1.0 + law.core_share) / law.core_share);
    return law.plateau + law.run_in / (1.0 + std::pow(worn_J / law.run_in_J, 1.5)) - law.loss * life - law.core_loss * core * core;
}

double friction(const LiningLaw& law, std::uint64_t seed, std::uint64_t number, double worn_J) {
    constexpr std::uint64_t kRemembered = 24;  // 0.75^24 = 0.1 %
    Generator generator = generator_of(seed, number);
    LiningTemperature temperature(generator);
    for (std::uint64_t k = 1; k <= kRemembered; ++k) {
        generator = generator_of(seed, number + k);
        temperature.step(law, generator);
    }
    return expected_friction(law, worn_J) + law.per_temperature * temperature.following() + law.measurement * normal(generator);
}

}  // namespace wear
