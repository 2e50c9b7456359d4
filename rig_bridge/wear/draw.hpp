/// Random draws of the wear model. The caller owns the generator; a seed gives the same draws with every standard library.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace wear {

using Generator = std::mt19937_64;  // its sequence is fixed by the C++ standard; that of std::normal_distribution is not

/// Uniform in (0, 1), neither end included.
[[nodiscard]] inline double uniform(Generator& generator) {
    constexpr double kStep = 0x1.0p-53;
    return (static_cast<double>(generator() >> 11U) + 0.5) * kStep;
}

/// Mean 0, standard deviation 1 (Box and Muller, 1958; the sine's half is not kept).
[[nodiscard]] inline double normal(Generator& generator) {
    const double radius = std::sqrt(-2.0 * std::log(uniform(generator)));
    return radius * std::cos(2.0 * std::numbers::pi * uniform(generator));
}

/// A separate generator for part `stream` of a computation with `seed`, so that parts may run in any order and on any thread.
[[nodiscard]] inline Generator generator_of(std::uint64_t seed, std::uint64_t stream) {
    std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U), static_cast<std::uint32_t>(stream),
                        static_cast<std::uint32_t>(stream >> 32U)};
    return Generator(words);
}

}  // namespace wear
