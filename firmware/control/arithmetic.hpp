/// Arithmetic that the controller needs beyond + - * /, without libm.
#pragma once

#include "firmware/control/types.hpp"

namespace antiskid::control {

/// Times up to 2 s are converted from 32 bits, with the same result: a Cortex-M7 has an instruction for that, but none for 64 bits.
[[nodiscard]] constexpr float seconds(Time time) {
    const auto low = static_cast<std::int32_t>(time.count());
    return (low == time.count() ? static_cast<float>(low) : static_cast<float>(time.count())) * 1e-9F;
}

[[nodiscard]] constexpr float smaller(float a, float b) {
    return a < b ? a : b;
}
[[nodiscard]] constexpr float larger(float a, float b) {
    return a > b ? a : b;
}
[[nodiscard]] constexpr float magnitude(float a) {
    return a < 0.0F ? -a : a;
}

/// `a` limited to [low, high]; NaN becomes low, so that no output is ever NaN.
[[nodiscard]] constexpr float limited(float a, float low, float high) {
    return a >= low ? (a <= high ? a : high) : low;
}

/// `from` moved towards `to` by at most `step` >= 0.
[[nodiscard]] constexpr float towards(float from, float to, float step) {
    return from + limited(to - from, -step, step);
}

}  // namespace antiskid::control
