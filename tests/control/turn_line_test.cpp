// The line of the wheel's turns against signals that have one, and signals that have none.
#include "firmware/control/turn_line.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/catch.hpp"

using antiskid::control::TurnLine;

namespace {

constexpr double kSampled_s = 1e-3;

/// The largest part of `signal(angle, time_s)` that is left after four of five seconds at this speed.
template <typename Signal>
double left_of(double omega_radps, const Signal& signal) {
    TurnLine line;
    double angle = 1.0, largest = 0.0;
    for (int i = 0; i < 5000; ++i) {
        angle += omega_radps * kSampled_s;
        const float rest = line.without(static_cast<float>(signal(angle, i * kSampled_s)), static_cast<float>(omega_radps * kSampled_s),
                                        static_cast<float>(kSampled_s));
        if (i >= 4000) largest = std::max(largest, std::abs(static_cast<double>(rest)));
    }
    return largest;
}

}  // namespace

TEST_CASE("what returns with every turn of the wheel is taken off, whatever its phase", "[CTL-302]") {
    for (const double omega : {16.0, 60.0, 190.0, 300.0})
        for (const double phase : {0.0, 1.0, 2.5, 4.0}) {
            INFO(omega << " rad/s, phase " << phase);
            CHECK(left_of(omega, [&](double angle, double) { return 0.7 * std::sin(angle + phase); }) < 0.7 * 0.02);
        }
}

TEST_CASE("what does not return with the wheel is left as it is", "[CTL-302]") {
    for (const double other : {0.5, 0.8, 1.25, 2.0})
        CHECK(left_of(100.0, [&](double, double time_s) { return 0.7 * std::sin(other * 100.0 * time_s); }) == Approx(0.7).epsilon(0.01));
}

TEST_CASE("of noise nothing is taken off, to the last bit", "[CTL-302]") {
    std::mt19937 generator(7);
    std::normal_distribution<float> normal(0.0F, 0.3F);
    TurnLine line;
    int changed = 0;
    for (int i = 0; i < 100'000; ++i) {
        const float signal = normal(generator);
        const float rest = line.without(signal, 0.1F, 1e-3F);
        if (i > 100) changed += rest != signal ? 1 : 0;
    }
    CHECK(changed == 0);
}

TEST_CASE("a line in noise is taken off, and the noise is left", "[CTL-302]") {
    std::mt19937 generator(8);
    std::normal_distribution<float> normal(0.0F, 0.3F);
    TurnLine line;
    double angle = 0.0, explained = 0.0, power = 0.0;
    for (int i = 0; i < 20'000; ++i) {
        angle += 0.1;
        const float noise = normal(generator);
        const float rest = line.without(noise + 0.5F * static_cast<float>(std::sin(angle)), 0.1F, 1e-3F);
        if (i < 5000) continue;
        const double wrong = static_cast<double>(rest - noise);
        explained += wrong * wrong;
        power += 0.5 * 0.5 * 0.5;
    }
    // The gain leaves a share of 0.2 * 0.09 / 0.25 of the amplitude.
    CHECK(explained / power < 0.02);
}

TEST_CASE("a line is followed while the wheel slows", "[CTL-302]") {
    TurnLine line;
    double angle = 0.0, largest = 0.0;
    for (int i = 0; i < 15'000; ++i) {
        const double omega = 180.0 - 0.01 * i;
        angle += omega * kSampled_s;
        const float rest = line.without(static_cast<float>(std::sin(angle)), static_cast<float>(omega * kSampled_s), 1e-3F);
        if (i > 3000) largest = std::max(largest, std::abs(static_cast<double>(rest)));
    }
    CHECK(largest < 0.02);
}

TEST_CASE("a gap in the readings loses the line, which is then learnt anew", "[CTL-302]") {
    TurnLine line;
    double angle = 0.0;
    const auto next = [&](double step) {
        angle += step;
        return line.without(static_cast<float>(std::sin(angle)), static_cast<float>(step), 1e-3F);
    };
    for (int i = 0; i < 3000; ++i) static_cast<void>(next(0.1));
    CHECK(std::abs(next(0.1)) < 0.02F);
    for (const double step : {1.5, 0.1}) {
        const float rest = next(step);
        CHECK(rest == static_cast<float>(std::sin(angle)));
    }
    for (int i = 0; i < 3000; ++i) static_cast<void>(next(0.1));
    CHECK(std::abs(next(0.1)) < 0.02F);
}
