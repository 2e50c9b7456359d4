// The tracker against motions known in closed form.
#include "firmware/control/speed_tracker.hpp"

#include <cmath>
#include <initializer_list>
#include <limits>

#include "tests/catch.hpp"
#include "tests/control/fixed_config.hpp"

using antiskid::control::EncoderConfig;
using antiskid::control::SpeedReading;
using antiskid::control::SpeedTracker;
using control_test::kExact_s;
using control_test::kPeriod_s;

namespace {

constexpr float kMax = 30'000.0F;  // of acceleration
constexpr EncoderConfig kEncoder{.max_speed_radps = 1e6F, .max_acceleration_radps2 = kMax, .reject_timeout_s = 0.01F};

/// A reading over one whole period that ended, on average, half a period ago.
SpeedReading reading_of(const double speed, const float interval_s = kPeriod_s) {
    return {.speed_radps = static_cast<float>(speed), .interval_s = interval_s, .fresh = true, .bounded = false, .valid = true};
}

}  // namespace

TEST_CASE("constant acceleration is tracked without error", "[CTL-010]") {
    const double bandwidth = GENERATE(50.0, 450.0);
    const double acceleration = GENERATE(-300.0, 0.0, 40.0, 2000.0);
    SpeedTracker tracker(static_cast<float>(bandwidth), kEncoder);
    double speed = acceleration < 0.0 ? 390.0 : 20.0;
    for (int i = 0; i < 600; ++i) {
        speed += acceleration * 1e-3;
        // The reading is the speed one period ago: half for its interval, half for the age of its edge.
        tracker.update(reading_of(speed - acceleration * 1e-3), kPeriod_s);
    }
    CHECK(tracker.acceleration() == Approx(acceleration).epsilon(2e-3).margin(0.5));
    CHECK(tracker.speed() == Approx(speed).epsilon(1e-4));
}

TEST_CASE("sparse readings are weighed by the time they stand for", "[CTL-010]") {
    // 20 m/s2 at 8 ms between edges: the tracker must find the same motion as with dense ones.
    SpeedTracker tracker(450.0F, kEncoder);
    const double acceleration = -60.0;
    double speed = 60.0;
    int since = 0;
    for (int i = 0; i < 700; ++i) {
        speed += acceleration * 1e-3;
        if (++since < 8) {
            tracker.update({.speed_radps = 0.0F, .interval_s = 0.0F, .fresh = false, .bounded = false, .valid = true}, kPeriod_s);
            continue;
        }
        since = 0;
        tracker.update(reading_of(speed - acceleration * 4.5e-3, 8e-3F), kPeriod_s);
    }
    CHECK(tracker.acceleration() == Approx(acceleration).epsilon(0.01));
    CHECK(tracker.speed() == Approx(speed).margin(0.3));
}

TEST_CASE("the tracker starts at the first reading and forgets with its validity", "[CTL-010]") {
    SpeedTracker tracker(450.0F, kEncoder);
    SpeedReading stale = reading_of(99.0);
    stale.fresh = false;
    tracker.update(stale, kPeriod_s);
    CHECK(tracker.speed() == 0.0F);
    tracker.update(reading_of(123.0), kPeriod_s);
    CHECK(tracker.speed() == 123.0F);
    CHECK(tracker.acceleration() == 0.0F);
    tracker.update({}, kPeriod_s);
    CHECK(tracker.speed() == 0.0F);
    tracker.update(reading_of(50.0), kPeriod_s);
    CHECK(tracker.speed() == 50.0F);
}

TEST_CASE("a bound is used only where it says something", "[CTL-010]") {
    SpeedTracker tracker(450.0F, kEncoder);
    tracker.update(reading_of(50.0), kPeriod_s);
    const SpeedReading above{.speed_radps = 80.0F, .interval_s = 0.0F, .fresh = false, .bounded = true, .valid = true};
    tracker.update(above, kPeriod_s);
    CHECK(tracker.speed() == 50.0F);
    const SpeedReading below{.speed_radps = 30.0F, .interval_s = 0.0F, .fresh = false, .bounded = true, .valid = true};
    tracker.update(below, kPeriod_s);
    CHECK(tracker.speed() < 50.0F);
    CHECK(tracker.speed() > 30.0F);
}

TEST_CASE("a wheel that stands has no acceleration, and no speed is negative", "[CTL-010]") {
    SpeedTracker tracker(450.0F, kEncoder);
    for (int i = 0; i < 20; ++i) tracker.update(reading_of(50.0 - 2.0 * i), kPeriod_s);
    CHECK(tracker.acceleration() < -500.0F);
    tracker.update(reading_of(0.0), kPeriod_s);
    CHECK(tracker.speed() == 0.0F);
    CHECK(tracker.acceleration() == 0.0F);

    // 2 rad/s less in every period, and then no edge any more.
    for (int i = 0; i < 24; ++i) tracker.update(reading_of(50.0 - 2.0 * i), kPeriod_s);
    REQUIRE(tracker.speed() > 0.0F);
    SpeedReading none = reading_of(1.0);
    none.fresh = false;
    for (int i = 0; i < 5; ++i) tracker.update(none, kPeriod_s);
    CHECK(tracker.speed() == 0.0F);
    REQUIRE(tracker.acceleration() < -500.0F);
    // What is left of the fall takes more than this reading gives.
    tracker.update(reading_of(1e-3), kPeriod_s);
    CHECK(tracker.speed() >= 0.0F);
}

TEST_CASE("a wheel that nearly stopped is found again, however fast it slowed down", "[CTL-010]") {
    // 15 rad/s is an edge every 7 ms. A prediction that has run into zero must not explain the reading away.
    const double slows_by = GENERATE(135.0, 15.0, 4.0);  // rad/s a period
    SpeedTracker tracker(450.0F, kEncoder);
    for (int i = 0; i < 50; ++i) tracker.update(reading_of(150.0), kPeriod_s);
    for (double speed = 150.0; speed > 15.0; speed -= slows_by) tracker.update(reading_of(speed), kPeriod_s);
    int ms = 0;
    for (; ms < 300 && !(ms > 7 && std::abs(tracker.speed() - 15.0F) < 1.5F); ++ms) {
        const bool edge = ms % 7 == 6;
        SpeedReading reading = reading_of(15.0, edge ? 7e-3F : 0.0F);
        reading.fresh = edge;
        tracker.update(reading, kPeriod_s);
    }
    CHECK(ms < 200);
}

TEST_CASE("no reading leaves a tracker that the next ones do not lead back", "[CTL-010]") {
    // An interval of minutes, as an encoder shows it whose clock jumps, and a speed that no wheel has.
    const double wrong = GENERATE(0.0, 1.0, 1e6);
    const float interval_s = GENERATE(1e-6F, 20.0F, 429.0F);
    SpeedTracker tracker(450.0F, kEncoder);
    for (int i = 0; i < 50; ++i) tracker.update(reading_of(33.0), kPeriod_s);
    tracker.update(reading_of(wrong, interval_s), kPeriod_s);
    for (int ms = 0; ms < 300; ++ms) {
        SpeedReading reading = reading_of(33.0, 3e-3F);
        reading.fresh = ms % 3 == 2;
        tracker.update(reading, kPeriod_s);
    }
    CHECK(tracker.speed() == Approx(33.0).epsilon(0.02));
    CHECK(std::abs(tracker.acceleration()) < 500.0F);
}

TEST_CASE("what is not known is zero, before the first reading and after the last", "[CTL-010]") {
    SpeedTracker tracker(450.0F, kEncoder);
    CHECK(tracker.speed() == 0.0F);
    CHECK(tracker.acceleration() == 0.0F);
    for (int i = 0; i < 20; ++i) tracker.update(reading_of(100.0 + i), kPeriod_s);
    REQUIRE(tracker.acceleration() > 1.0F);
    tracker.update({}, kPeriod_s);
    CHECK(tracker.speed() == 0.0F);
    CHECK(tracker.acceleration() == 0.0F);
}

TEST_CASE("an upper bound that is just met says nothing", "[CTL-010]") {
    SpeedTracker tracker(450.0F, kEncoder);
    for (int i = 0; i < 20; ++i) tracker.update(reading_of(100.0 - 0.5 * i), kPeriod_s);
    REQUIRE(tracker.acceleration() < -100.0F);
    SpeedTracker unheard = tracker;
    SpeedReading bound = reading_of(100.0);
    bound.fresh = false;
    unheard.update(bound, kPeriod_s);
    bound.bounded = true;
    bound.speed_radps = unheard.speed();
    SpeedTracker met = tracker;
    met.update(bound, kPeriod_s);
    CHECK(met.speed() == unheard.speed());
    CHECK(met.acceleration() == unheard.acceleration());
    bound.speed_radps = std::nextafter(unheard.speed(), 0.0F);
    tracker.update(bound, kPeriod_s);
    CHECK(tracker.speed() != unheard.speed());
}

TEST_CASE("a prediction that ends at zero is not looked back along", "[CTL-010]") {
    // With half of its memory lost in a period every number is exact: 22.5 rad/s, and as much less in a period.
    SpeedTracker tracker(1024.0F, kEncoder);
    for (const double radps : {100.0, 60.0, 20.0}) tracker.update(reading_of(radps, kExact_s), kExact_s);
    REQUIRE(tracker.speed() == 22.5F);
    REQUIRE(tracker.acceleration() == -22.5F * 1024.0F);
    tracker.update(reading_of(10.0, kExact_s), kExact_s);  // predicted: exactly none
    CHECK(tracker.speed() == 7.5F);
}

TEST_CASE("a reading that no wheel can have got to is not believed for 10 ms", "[CTL-300]") {
    SpeedTracker tracker(450.0F, kEncoder);
    for (int i = 0; i < 50; ++i) tracker.update(reading_of(33.0), kPeriod_s);
    const auto max = 0.99 * static_cast<double>(kMax * kPeriod_s);
    SECTION("wild ones leave nothing behind") {
        for (int i = 0; i < 5; ++i) tracker.update(reading_of(33.0 + 16.0 * max), kPeriod_s);
        CHECK(tracker.speed() == Approx(33.0).epsilon(1e-4));
        CHECK(std::abs(tracker.acceleration()) < 1.0F);
    }
    SECTION("the fastest change is believed at once") {
        tracker.update(reading_of(33.0 + 2.0 * max), kPeriod_s);
        CHECK(tracker.speed() > 33.0F + static_cast<float>(max));
    }
    SECTION("what stays is believed in the end") {
        for (int i = 0; i < 9; ++i) tracker.update(reading_of(33.0 + 16.0 * max), kPeriod_s);
        CHECK(tracker.speed() == Approx(33.0).epsilon(1e-4));
        tracker.update(reading_of(33.0 + 16.0 * max), kPeriod_s);
        CHECK(tracker.speed() > 100.0F);
        for (int i = 0; i < 100; ++i) tracker.update(reading_of(33.0 + 16.0 * max), kPeriod_s);
        CHECK(tracker.speed() == Approx(33.0 + 16.0 * max).epsilon(1e-2));
    }
}

TEST_CASE("a reading exactly at the limit is believed", "[CTL-300]") {
    SpeedTracker tracker(450.0F, {.max_speed_radps = 400.0F, .max_acceleration_radps2 = 16.0F, .reject_timeout_s = 0.01F});
    tracker.update(reading_of(32.0, kExact_s), kExact_s);
    tracker.update(reading_of(32.0 + 2.0 * 16.0 / 1024.0, kExact_s), kExact_s);
    CHECK(tracker.speed() > 32.0F);
}

TEST_CASE("a reading that cannot be does not reach the tracker", "[CTL-010]") {
    SpeedTracker tracker(450.0F, {.max_speed_radps = 400.0F, .max_acceleration_radps2 = 1e9F, .reject_timeout_s = 0.01F});
    tracker.update({.speed_radps = 100.0F, .interval_s = 1e-3F, .fresh = true, .valid = true}, 1e-3F);
    for (const float radps : {-1.0F, 401.0F, std::numeric_limits<float>::quiet_NaN()}) {
        for (int i = 0; i < 30; ++i) tracker.update({.speed_radps = radps, .interval_s = 1e-3F, .fresh = true, .valid = true}, 1e-3F);
        CHECK(tracker.speed() == 100.0F);
        CHECK(tracker.acceleration() == 0.0F);
    }
}
