/// exp for arguments that are not positive, without branch or table, so that compilers turn a loop over it into vector code.
#pragma once

#include <bit>
#include <cstdint>

namespace wear {

/// e^x for x <= 0; below -708 it is e^-708 (3.3e-308), which is nothing beside the 1 that every sum here has. Relative error below
/// 4.5e-16 (2 units in the last place), proven by test against long double.
/// Method: x = k ln 2 + r, |r| <= ln 2 / 2, Taylor series of e^r to r^13 (remainder 4.2e-18), and k into the exponent.
[[gnu::always_inline]] inline double exp_not_positive(double x) {
    constexpr double kMin = -708.0;
    constexpr double kLog2e = 1.4426950408889634;
    constexpr double kLn2High = 6.93147180369123816490e-01;  // fdlibm's split: k times the high part is exact
    constexpr double kLn2Low = 1.90821492927058770002e-10;
    constexpr double kRound = 0x1.8p52;  // adding it leaves the nearest integer in the low bits
    x = x < kMin ? kMin : x;
    const double shifted = x * kLog2e + kRound;
    const double k = shifted - kRound;
    const double r = (x - k * kLn2High) - k * kLn2Low;
    double p = 1.0 / 6227020800.0;
    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    p = p * (r * r) + r;  // the small part alone, so that 1 + it rounds once
    const std::uint64_t exponent = (std::bit_cast<std::uint64_t>(shifted) + 1023U) << 52U;
    return (p + 1.0) * std::bit_cast<double>(exponent);
}

}  // namespace wear
