// The wheel's observer behind an encoder whose edges are far apart, or missing.
#include <algorithm>
#include <cmath>

#include "firmware/control/wheel_observer.hpp"
#include "tests/catch.hpp"
#include "tests/control/fixed_config.hpp"
#include "tests/control/shaft.hpp"

using namespace antiskid::control;
using control_test::fixed_config;

namespace {

/// A wheel, its encoder and the observer of it.
struct EncodedWheel {
    static constexpr double kStep_s = 1e-3;

    explicit EncodedWheel(const ObserverConfig& config, int missing_teeth = 0)
        : shaft(60.0, missing_teeth), observer(config, fixed_config().wheel, 1e-3F) {}

    void turn(double radps, double brake_radps2) {
        shaft.turn_to(radps, kStep_s);
        now += Time{1'000'000};
        shaft.report(input, now);
        const auto brake = static_cast<float>(brake_radps2);
        observer.update(encoder.update(input), {.brake_radps2 = brake, .brake_now_radps2 = brake});
    }

    control_test::Shaft shaft;
    SpeedEstimator encoder{60.0F};
    WheelObserver observer;
    SpeedInput input;
    Time now{};
};

}  // namespace

TEST_CASE("an observer whose wheel fell faster than any can is led back by sparse edges and bounds", "[CTL-300]") {
    const double gains_radps2 = GENERATE(40.0, 75.0, 150.0);
    CAPTURE(gains_radps2);
    EncodedWheel b(fixed_config().observer);
    for (int i = 0; i < 300; ++i) b.turn(115.0, 0.0);
    double radps = 6.0;  // within one period
    for (int i = 0; i < 400; ++i) {
        radps += gains_radps2 * EncodedWheel::kStep_s;
        b.turn(radps, 0.0);
        CAPTURE(i);
        REQUIRE(b.observer.wheel_pole_radps() < 500.0F);
        if (i > 200) REQUIRE(static_cast<double>(b.observer.motion().omega_radps) == Approx(radps).epsilon(0.03));
    }
}

TEST_CASE("edges of a wheel that creeps, far apart, do not read as a wheel that turns with the aircraft", "[CTL-300]") {
    const double creeps_radps = GENERATE(2.0, 3.7, 6.0);
    const double pole_noise = GENERATE(3.4, 4.2, 8.0);
    CAPTURE(creeps_radps, pole_noise);
    ObserverConfig config = fixed_config().observer;
    config.pole_noise = static_cast<float>(pole_noise);
    EncodedWheel b(config);
    for (int i = 0; i < 300; ++i) b.turn(38.0, 0.0);
    for (int i = 0; i < 8; ++i) b.turn(std::max(38.0 - 5.0 * i, creeps_radps), 8000.0);
    const double after_two_edges = 2.0 * (2.0 * 3.14159265 / 60.0) / creeps_radps * 1e3;
    for (int i = 0; i < 400; ++i) {
        b.turn(creeps_radps, 8000.0 * std::exp(-i / 8.0));
        if (static_cast<double>(i) > after_two_edges) REQUIRE(static_cast<double>(b.observer.motion().omega_radps) <= 2.2 * creeps_radps);
    }
}

TEST_CASE("a gap where teeth are missing is no slip", "[CTL-300]") {
    // A gap lasts less than the 10 ms after which a reading is believed whatever it says.
    const int missing = GENERATE(1, 2, 3, 6);
    const double radps = GENERATE(145.0, 90.0);
    const double brake_radps2 = GENERATE(300.0, 2500.0);
    CAPTURE(missing, radps, brake_radps2);
    EncodedWheel b(fixed_config().observer, missing);
    for (int i = 0; i < 1000; ++i) {
        b.turn(radps, brake_radps2);
        if (i > 300) REQUIRE(static_cast<double>(b.observer.motion().omega_radps) == Approx(radps).epsilon(0.02));
    }
}

TEST_CASE("a wheel that falls as fast as its brake can make it is believed, one that grips twice as hard too", "[CTL-300]") {
    const double times = GENERATE(1.0, 1.5, 2.0);
    const double brake_radps2 = GENERATE(1000.0, 6000.0);
    CAPTURE(times, brake_radps2);
    EncodedWheel b(fixed_config().observer);
    for (int i = 0; i < 300; ++i) b.turn(140.0, 0.0);
    for (double radps = 140.0; radps > 20.0; radps -= times * brake_radps2 * EncodedWheel::kStep_s) {
        b.turn(radps, brake_radps2);
        // Late by the reading and the filter: three periods.
        REQUIRE(std::abs(static_cast<double>(b.observer.motion().omega_radps) - radps) < 3.0 * EncodedWheel::kStep_s * times * brake_radps2 + 3.0);
    }
}
