/// The source of random numbers: seeded, passed in, same sequence on every machine.
#pragma once

#include <cstdint>

namespace rig {

/// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014).
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t bits() {
        std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
        z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
        z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
        return z ^ (z >> 31U);
    }

    /// In [0, 1).
    double uniform() { return static_cast<double>(bits() >> 11U) * 0x1.0p-53; }

    /// Mean 0, standard deviation 1, bounded at 3.46: the sum of four uniform draws, good enough for sensor noise; the bound keeps edge times in
    /// order. The error of its distribution function against the normal is below 0.01.
    double noise() {
        const std::uint64_t b = bits();
        const auto sum = static_cast<double>((b & 0xFFFFU) + ((b >> 16U) & 0xFFFFU) + ((b >> 32U) & 0xFFFFU) + (b >> 48U));
        constexpr double kMean = 2.0 * 65535.0;
        constexpr double kScale = 1.0 / 37837.2268;  // sqrt(4 * (65536^2 - 1) / 12)
        return (sum - kMean) * kScale;
    }

  private:
    std::uint64_t state_;
};

}  // namespace rig
