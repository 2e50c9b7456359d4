// The wheel's observer against wheels with a given pole, integrated by themselves.
#include "firmware/control/wheel_observer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/catch.hpp"
#include "tests/control/fixed_config.hpp"
#include "tests/control/shaft.hpp"

using namespace antiskid::control;
using control_test::fixed_config;

namespace {

constexpr double kOnce_s = 1e-3;
constexpr double kSteady_radps2 = -20.0;

/// omega_dot = tau - u, tau_dot = a (u + steady - tau) in double, a hundred steps of the trapezoidal kind a period.
struct Wheel {
    double wheel_pole_radps = 0.0;
    double omega_radps = 150.0, road_radps2 = 3000.0;

    /// Mean speed of the period.
    double turn(double brake_radps2) {
        constexpr int kParts = 1000;
        constexpr double h = kOnce_s / kParts;
        const double before = omega_radps;
        double angle = 0.0;
        for (int i = 0; i < kParts; ++i) {
            const double decays = std::exp(-wheel_pole_radps * h);
            const double excess = road_radps2 - brake_radps2 - kSteady_radps2;
            const double acts = wheel_pole_radps == 0.0 ? h : (1.0 - decays) / wheel_pole_radps;
            const double next = omega_radps + excess * acts + kSteady_radps2 * h;
            angle += 0.5 * (omega_radps + next) * h;
            omega_radps = next;
            road_radps2 = brake_radps2 + kSteady_radps2 + excess * decays;
        }
        static_cast<void>(before);
        return angle / kOnce_s;
    }
};

/// The brake swings about what the road gives: without that nothing tells the pole.
double brake_radps2(double mean, int i) {
    return mean + 400.0 * std::sin(0.11 * i) + 250.0 * std::sin(0.031 * i);
}

SpeedReading reading(double radps) {
    return {.speed_radps = static_cast<float>(radps), .interval_s = static_cast<float>(kOnce_s), .fresh = true, .valid = true};
}

WheelObserver::Drive drive(double brake) {
    return {.brake_radps2 = static_cast<float>(brake),
            .brake_now_radps2 = static_cast<float>(brake),
            .steady_radps2 = static_cast<float>(kSteady_radps2)};
}

WheelObserver started(double radps) {
    WheelObserver observer(fixed_config().observer, fixed_config().wheel, 1e-3F);
    observer.update(reading(radps), drive(0.0));
    return observer;
}

}  // namespace

TEST_CASE("speed, road torque and the wheel's pole are found", "[CTL-300]") {
    const double pole = GENERATE(1500.0, 300.0, 60.0, 0.0, -15.0);
    Wheel wheel{.wheel_pole_radps = pole};
    WheelObserver observer = started(wheel.omega_radps);
    double sum = 0.0;
    int counted = 0;
    for (int i = 0; i < 3000; ++i) {
        // A wheel that runs away is held where it is, as a law does.
        const double held = pole < 0.0 ? 30.0 * (wheel.omega_radps - 150.0) : 0.0;
        const double brake = brake_radps2(pole > 0.0 ? 3000.0 : wheel.road_radps2 - kSteady_radps2 + held, i);
        const double mean = wheel.turn(brake);
        observer.update(reading(mean), drive(brake));
        if (i < 1000) continue;
        sum += static_cast<double>(observer.wheel_pole_radps());
        ++counted;
        CHECK(std::abs(static_cast<double>(observer.motion().omega_radps) - wheel.omega_radps) < 1.5);
        CHECK(std::abs(static_cast<double>(observer.motion().road_radps2) - wheel.road_radps2) < 450.0);
    }
    INFO(pole << " 1/s, found " << sum / counted);
    CHECK(sum / counted == Approx(pole).epsilon(0.3).margin(12.0));
}

TEST_CASE("discs that are not true do not make a road look as if it were beyond its peak", "[CTL-302]") {
    // A torque of which the observer is not told: a sine of the wheel's angle, and a bump of an eighth of a turn, which is no sine.
    const bool bump = GENERATE(false, true);
    const double share = GENERATE(0.05, 0.10);
    const double pole = 300.0;
    Wheel wheel{.wheel_pole_radps = pole};
    WheelObserver observer = started(wheel.omega_radps);
    double angle = 0.0, sum = 0.0;
    int counted = 0;
    for (int i = 0; i < 6000; ++i) {
        angle += wheel.omega_radps * kOnce_s;
        const double of_turn = angle / 6.283185307179586 - std::floor(angle / 6.283185307179586);
        const double more = bump ? (of_turn < 0.125 ? 1.0 : 0.0) : std::sin(angle);
        const double brake = 3000.0 + 0.05 * (brake_radps2(3000.0, i) - 3000.0);  // small against the discs
        const double mean = wheel.turn(brake * (1.0 + share * more));
        observer.update(reading(mean), drive(brake));
        if (i < 3000) continue;
        sum += static_cast<double>(observer.wheel_pole_radps());
        ++counted;
    }
    INFO(pole << " 1/s, " << share << (bump ? " bump" : " sine") << ", found " << sum / counted);
    CHECK(sum / counted > 0.7 * pole);  // by the sine alone it would be 0.46 and 0.28 of it
    CHECK(sum / counted < 1.5 * pole);
}

TEST_CASE("a pole without noise is known, and stays what it is", "[CTL-300]") {
    ObserverConfig known = fixed_config().observer;
    known.pole_noise = 0.0F;
    known.pole_floor_radps = 600.0F;
    WheelObserver observer(known, fixed_config().wheel, 1e-3F);
    Wheel wheel{.wheel_pole_radps = 300.0};
    observer.update(reading(wheel.omega_radps), drive(0.0));
    float max = 0.0F, min = 1e6F;
    bool told = false;
    for (int i = 0; i < 1000; ++i) {
        if (i == 700) wheel.road_radps2 -= 6000.0;
        const double brake = brake_radps2(3000.0, i);
        observer.update(reading(wheel.turn(brake)), drive(brake));
        told = told || observer.another_road();
        max = std::max(max, observer.wheel_pole_radps());
        min = std::min(min, observer.wheel_pole_radps());
        if (i > 100 && (i < 700 || i > 800)) CHECK(std::abs(static_cast<double>(observer.motion().omega_radps) - wheel.omega_radps) < 1.5);
    }
    CHECK(told);
    CHECK(min == Approx(300.0).margin(1.0));
    CHECK(max == Approx(300.0).margin(1.0));
}

TEST_CASE("a step of the equations is the exact one for short steps, and stable for any", "[CTL-300]") {
    const WheelMotion from{.omega_radps = 100.0F, .road_radps2 = 4000.0F};
    for (const double a : {200.0, 20.0, 0.0, -20.0}) {
        constexpr double h = 1e-5;
        WheelMotion at = from;
        for (int i = 0; i < 1000; ++i) at = WheelStep(static_cast<float>(a), static_cast<float>(h)).from(at, 3000.0F, -20.0F);
        const double t = 1000 * h, excess = 1020.0;
        const double acts = a == 0.0 ? t : (1.0 - std::exp(-a * t)) / a;
        INFO(a << " 1/s");
        CHECK(static_cast<double>(at.omega_radps) == Approx(100.0 + excess * acts - 20.0 * t).epsilon(2e-4));
        CHECK(static_cast<double>(at.road_radps2) == Approx(2980.0 + excess * std::exp(-a * t)).epsilon(2e-3));
    }
    WheelMotion fast = from;
    for (int i = 0; i < 100; ++i) {
        const WheelMotion next = WheelStep(6000.0F, 5e-3F).from(fast, 3000.0F, -20.0F);
        CHECK(std::abs(next.road_radps2 - 2980.0F) <= std::abs(fast.road_radps2 - 2980.0F));
        fast = next;
    }
    CHECK(fast.road_radps2 == Approx(2980.0));
    CHECK(WheelStep(0.0F, 1e-3F).from({1.0F, 0.0F}, 1e5F, 0.0F).omega_radps == 0.0F);
}

TEST_CASE("the observer begins at the first reading, and anew with its validity", "[CTL-300]") {
    WheelObserver observer(fixed_config().observer, fixed_config().wheel, 1e-3F);
    CHECK(observer.motion().omega_radps == 0.0F);
    SpeedReading nothing = reading(150.0);
    nothing.fresh = false;
    observer.update(nothing, drive(0.0));
    CHECK(observer.motion().omega_radps == 0.0F);
    observer.update(reading(150.0), drive(0.0));
    CHECK(observer.motion().omega_radps == 150.0F);
    CHECK(observer.wheel_pole_radps() == 50.0F);
    for (int i = 0; i < 100; ++i) observer.update(reading(150.0), drive(0.0));
    CHECK(observer.motion().omega_radps == Approx(150.0).epsilon(1e-3));
    SpeedReading invalid = reading(150.0);
    invalid.valid = false;
    observer.update(invalid, drive(0.0));
    CHECK(observer.motion().omega_radps == 0.0F);
    CHECK(observer.motion().road_radps2 == 0.0F);
    CHECK(observer.wheel_pole_radps() == 50.0F);
    observer.update(reading(80.0), drive(0.0));
    CHECK(observer.motion().omega_radps == 80.0F);
}

TEST_CASE("a wheel that stands has no road torque; an upper bound counts where it says something", "[CTL-300]") {
    WheelObserver observer = started(150.0);
    for (int i = 0; i < 50; ++i) observer.update(reading(150.0 - 3.0 * i), drive(3000.0));
    observer.update(reading(0.0), drive(3000.0));
    CHECK(observer.motion().omega_radps == 0.0F);
    CHECK(observer.motion().road_radps2 == 0.0F);

    SpeedReading bound = reading(140.0);
    bound.fresh = false;
    bound.bounded = true;
    WheelObserver slow = started(50.0), fast = started(150.0);
    WheelObserver unheard = slow, also = fast;
    SpeedReading none = bound;
    none.bounded = false;
    slow.update(bound, drive(0.0));
    unheard.update(none, drive(0.0));
    CHECK(slow.motion().omega_radps == unheard.motion().omega_radps);
    fast.update(bound, drive(0.0));
    also.update(none, drive(0.0));
    CHECK(fast.motion().omega_radps < also.motion().omega_radps);
}

TEST_CASE("the observer does not believe for 10 ms what no wheel can have got to", "[CTL-300]") {
    WheelObserver observer = started(150.0);
    for (int i = 0; i < 200; ++i) observer.update(reading(150.0), drive(-kSteady_radps2));
    const float before = observer.motion().omega_radps;
    int believed_after = 0;
    for (int i = 1; i <= 20 && believed_after == 0; ++i) {
        observer.update(reading(380.0), drive(-kSteady_radps2));
        if (observer.motion().omega_radps > before + 5.0F) believed_after = i;
    }
    CHECK(believed_after >= 10);
    CHECK(believed_after <= 11);
}

TEST_CASE("no reading leaves an observer that the next ones do not lead back", "[CTL-300]") {
    WheelObserver observer = started(150.0);
    std::uint32_t random = 1;
    for (int i = 0; i < 20'000; ++i) {
        random = random * 1664525U + 1013904223U;
        const double radps = static_cast<double>(random >> 8U) / 16777216.0 * 400.0;
        const double brake = static_cast<double>(random & 0xFFU) * 60.0;
        observer.update(reading(radps), drive(brake));
        REQUIRE(std::isfinite(observer.motion().omega_radps));
        REQUIRE(observer.motion().omega_radps >= 0.0F);
        REQUIRE(std::abs(observer.motion().road_radps2) <= 40'000.0F);  // 30,000, and a period of running away
        REQUIRE(observer.wheel_pole_radps() >= -60.0F);
        REQUIRE(observer.wheel_pole_radps() <= 6000.0F);
    }
    for (int i = 0; i < 1000; ++i) observer.update(reading(120.0), {});
    CHECK(observer.motion().omega_radps == Approx(120.0).epsilon(1e-3));
}

TEST_CASE("a wheel that comes onto another road is found again within 25 ms", "[CTL-300]") {
    // On the steep side, then the grip is gone: nothing that was learnt of the road holds any more.
    Wheel wheel{.wheel_pole_radps = 800.0};
    WheelObserver observer = started(wheel.omega_radps);
    for (int i = 0; i < 1000; ++i) {
        const double brake = brake_radps2(3000.0, i);
        observer.update(reading(wheel.turn(brake)), drive(brake));
        if (i > 100) REQUIRE_FALSE(observer.another_road());
    }
    REQUIRE(observer.wheel_pole_radps() > 300.0F);
    const float known = observer.wheel_pole_variance_radps2();
    CHECK(known > 0.0F);
    wheel.wheel_pole_radps = 0.0;
    wheel.road_radps2 = 200.0;
    double worst = 0.0;
    int told = 0;
    for (int i = 0; i < 300; ++i) {
        const double brake = i < 30 ? 3000.0 - 100.0 * i : 0.0;  // let go, as a law does
        observer.update(reading(wheel.turn(brake)), drive(brake));
        told += observer.another_road() ? 1 : 0;
        if (i > 25) worst = std::max(worst, std::abs(static_cast<double>(observer.motion().omega_radps) - wheel.omega_radps));
    }
    CHECK(told >= 1);
    CHECK(told < 5);
    CHECK(worst < 5.0);
    CHECK(observer.wheel_pole_radps() < 60.0F);
}

TEST_CASE("a released wheel that gains speed between sparse edges is followed", "[CTL-300]") {
    // From a lock, at an edge in every 17 ms: most of what is heard are bounds, which are below the wheel that gains speed.
    const double gains_radps2 = GENERATE(40.0, 75.0, 150.0);
    CAPTURE(gains_radps2);
    control_test::Shaft shaft(60.0);
    SpeedEstimator encoder(60.0F);
    WheelObserver observer(fixed_config().observer, fixed_config().wheel, 1e-3F);
    SpeedInput input;
    Time now{};
    const auto turn = [&](const double radps, const double brake_radps2) {
        shaft.turn_to(radps, kOnce_s);
        now += Time{1'000'000};
        shaft.report(input, now);
        const auto brake = static_cast<float>(brake_radps2);
        observer.update(encoder.update(input), {.brake_radps2 = brake, .brake_now_radps2 = brake});
    };
    for (int i = 0; i < 300; ++i) turn(115.0, 0.0);
    double radps = 115.0;
    for (; radps > 6.0; radps -= 2.2) turn(radps, 2200.0);
    for (int i = 0; i < 400; ++i) {
        radps += gains_radps2 * kOnce_s;
        turn(radps, 0.0);
        CAPTURE(i, observer.wheel_pole_radps());
        REQUIRE(observer.wheel_pole_radps() < 500.0F);
        if (i > 150) REQUIRE(static_cast<double>(observer.motion().omega_radps) == Approx(radps).epsilon(0.03));
        if (i > 300) REQUIRE(static_cast<double>(observer.motion().road_radps2) == Approx(gains_radps2).epsilon(0.25));
    }
}

namespace {

using Vector = std::array<double, 3>;  // speed, road torque, pole
using Matrix = std::array<Vector, 3>;

/// The same filter by the textbook: full matrices in double, derivatives by differences.
struct Textbook {
    static Vector moved(const Vector& x, const double brake, const double steady) {
        const double acts = x[2] > 0.0 ? kOnce_s / (1.0 + x[2] * kOnce_s) : kOnce_s;
        const double change = acts * (x[1] - brake - steady);
        return {x[0] + change + steady * kOnce_s, x[1] - x[2] * change, x[2]};
    }
    void predict(const double brake, const double steady) {
        Matrix f{};
        for (std::size_t column = 0; column < 3; ++column) {
            const double step = 1e-4 * (1.0 + std::abs(x[column]));
            Vector more = x, less = x;
            more[column] += step;
            less[column] -= step;
            const Vector up = moved(more, brake, steady), down = moved(less, brake, steady);
            for (std::size_t row = 0; row < 3; ++row) f[row][column] = (up[row] - down[row]) / (2.0 * step);
        }
        const ObserverConfig c = fixed_config().observer;
        const double pole_noise = static_cast<double>(c.pole_noise) * (std::abs(x[2]) + static_cast<double>(c.pole_floor_radps));
        const Vector noise{1.0, static_cast<double>(c.road_noise_radps2), pole_noise};
        Matrix next{};
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                for (std::size_t k = 0; k < 3; ++k)
                    for (std::size_t l = 0; l < 3; ++l) next[i][j] += f[i][k] * p[k][l] * f[j][l];
        for (std::size_t i = 0; i < 3; ++i) next[i][i] += noise[i] * noise[i] * kOnce_s;
        x = moved(x, brake, steady);
        p = next;
    }
    /// A reading of the mean over the last period, which ended half a period ago on average.
    void correct(const double radps, const double brake) {
        const Vector h{1.0, -kOnce_s, 0.0};
        const double noise = static_cast<double>(fixed_config().observer.reading_noise) * 2.0 * 3.14159265358979 / 60.0 / kOnce_s;
        Vector ph{};
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 3; ++k) ph[i] += p[i][k] * h[k];
        const double variance = ph[0] * h[0] + ph[1] * h[1] + noise * noise + 0.02 * 0.02;
        const double innovation = radps - (x[0] - kOnce_s * (x[1] - brake));
        for (std::size_t i = 0; i < 3; ++i) x[i] += ph[i] / variance * innovation;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) p[i][j] -= ph[i] * ph[j] / variance;
    }

    Vector x{};
    Matrix p{};
};

}  // namespace

TEST_CASE("the observer is the textbook's extended Kalman filter", "[CTL-300]") {
    const double pole = GENERATE(800.0, 100.0, -15.0);
    CAPTURE(pole);
    ObserverConfig config = fixed_config().observer;
    config.max_mean_innovation = 1e6F;  // the textbook knows no other road
    WheelObserver observer(config, fixed_config().wheel, 1e-3F);
    // The brake swings far below the wheel's turns: the textbook knows no line either.
    constexpr double kTurns_radps = 300.0;
    Wheel wheel{.wheel_pole_radps = pole, .omega_radps = kTurns_radps};
    observer.update(reading(wheel.omega_radps), drive(0.0));
    Textbook textbook{.x = {wheel.omega_radps, 0.0, 50.0}, .p = {}};
    textbook.p[0][0] = 10.0 * 10.0;
    textbook.p[1][1] = 100.0 * 100.0;
    textbook.p[2][2] = 50.0 * 50.0;
    for (int i = 0; i < 400; ++i) {
        const double held = pole < 0.0 ? 30.0 * (wheel.omega_radps - kTurns_radps) : 0.0;
        const double brake = brake_radps2(pole > 0.0 ? 3000.0 : wheel.road_radps2 - kSteady_radps2 + held, i);
        const double mean = wheel.turn(brake);
        observer.update(reading(mean), drive(brake));
        textbook.predict(brake, kSteady_radps2);
        textbook.correct(mean, brake);
        CAPTURE(i);
        REQUIRE(static_cast<double>(observer.motion().omega_radps) == Approx(textbook.x[0]).epsilon(1e-4));
        REQUIRE(static_cast<double>(observer.motion().road_radps2) == Approx(textbook.x[1]).epsilon(2e-3).margin(2.0));
        REQUIRE(static_cast<double>(observer.wheel_pole_radps()) == Approx(textbook.x[2]).epsilon(5e-3).margin(0.3));
    }
}
