// Speed by the M/T method against shafts whose motion is known exactly.
#include "firmware/control/speed_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/control/arithmetic.hpp"
#include "tests/catch.hpp"
#include "tests/control/shaft.hpp"
#include "tests/control/speed_line.hpp"

using namespace antiskid::control;
using speed_test::kMillisecond;
using speed_test::kTooth_rad;
using speed_test::Line;

TEST_CASE("constant speed is exact at every speed and period", "[CTL-010]") {
    const double period_s = GENERATE(1e-3, 2e-3, 5e-3);
    for (double radps = 1.2; radps < 400.0; radps *= 1.07) {
        Line line(period_s);
        int fresh = 0;
        SpeedReading reading = line.turn_to(radps);
        const int steps = static_cast<int>(std::ceil(1.5 / period_s));
        for (int i = 0; i < steps; ++i) {
            reading = line.turn_to(radps);
            if (!reading.fresh || i < 3) continue;
            ++fresh;
            // The stamp's nanosecond, the shaft's start from rest over the first period is behind; single precision.
            const double tolerance =
                radps * (1e-9 / static_cast<double>(reading.interval_s) + 4.0 * static_cast<double>(std::numeric_limits<float>::epsilon()));
            CAPTURE(radps, period_s, i);
            REQUIRE(std::abs(static_cast<double>(reading.speed_radps) - radps) <= tolerance);
            REQUIRE(reading.valid);
            REQUIRE_FALSE(reading.bounded);
        }
        CAPTURE(radps, period_s);
        REQUIRE(fresh >= 10);
        // Between edges the last reading stands: the bound never falls below the true speed.
        REQUIRE(static_cast<double>(reading.speed_radps) >= radps * (1.0 - 1e-5));
    }
}

TEST_CASE("the reading is the mean speed over its interval", "[CTL-010]") {
    const double acceleration = GENERATE(-900.0, -50.0, 50.0, 900.0, 10'000.0);
    Line line;
    double radps = acceleration > 0.0 ? 20.0 : 350.0;
    const double min = 20.0, max = 390.0;
    double before_edge = 0.0;  // speed at the last edge of the frame before
    int checked = 0;
    int edges = 0;
    while (radps >= min && radps <= max) {
        radps += acceleration * 1e-3;
        const SpeedReading reading = line.turn_to(radps);
        // Speed at the newest edge, from the motion: v(t) is linear.
        const Time since = line.now - Time{5'000'000'000} - line.input.edge_time;
        const double at_edge = radps - acceleration * static_cast<double>(since.count()) * 1e-9;
        if (!reading.fresh) continue;
        // The first two intervals reach back into the jerk from rest.
        if (++edges > 2) {
            ++checked;
            CHECK(static_cast<double>(reading.speed_radps) == Approx(0.5 * (before_edge + at_edge)).epsilon(1e-5));
        }
        before_edge = at_edge;
    }
    CHECK(checked >= 30);
}

TEST_CASE("the first edge after a standstill only starts the clock", "[CTL-010]") {
    Line line;
    for (int i = 0; i < 150; ++i) CHECK(line.turn_to(0.0).speed_radps == 0.0F);
    // Half a tooth in a jerk, then steady: were the time since the last edge used, the speed would come out near zero.
    SpeedReading reading;
    int before_first = 0;
    do {
        reading = line.turn_to(50.0);
        ++before_first;
    } while (line.input.edge_count == 0);
    CHECK(before_first <= 4);
    CHECK_FALSE(reading.fresh);
    CHECK(reading.speed_radps == 0.0F);
    CHECK(reading.valid);
    do reading = line.turn_to(50.0);
    while (!reading.fresh);
    CHECK(reading.speed_radps == Approx(50.0).epsilon(1e-5));
}

TEST_CASE("nothing is valid before two edges or a standstill", "[CTL-010]") {
    SpeedEstimator never(60.0F);
    CHECK_FALSE(never.update({}).valid);

    Line line;
    for (int i = 0; i < 99; ++i) {
        CAPTURE(i);
        REQUIRE_FALSE(line.turn_to(0.0).valid);
    }
    line.turn_to(0.0);
    const SpeedReading standing = line.turn_to(0.0);
    CHECK(standing.valid);
    CHECK(standing.fresh);
    CHECK(standing.speed_radps == 0.0F);

    // A controller that starts in the middle of a landing: the first frame's edge is of unknown age.
    Line late;
    for (int i = 0; i < 300; ++i) late.shaft.turn_to(30.0, 1e-3);
    const SpeedReading first = late.turn_to(30.0);
    CHECK_FALSE(first.valid);
    SpeedReading reading = first;
    while (!reading.fresh) reading = late.turn_to(30.0);
    CHECK(reading.speed_radps == Approx(30.0).epsilon(1e-5));
}

TEST_CASE("count and time roll over", "[CTL-010]") {
    Line line;
    line.shaft.first_count = std::numeric_limits<std::uint32_t>::max() - 40U;
    line.shaft.first_time = Time{-1'000'000'000};  // through zero
    bool rolled = false;
    for (int i = 0; i < 2000; ++i) {
        const SpeedReading reading = line.turn_to(120.0);
        rolled = rolled || line.input.edge_count < 40U;
        if (i > 5 && reading.fresh) {
            REQUIRE(reading.speed_radps == Approx(120.0).epsilon(1e-5));
        }
    }
    CHECK(rolled);
}

TEST_CASE("frames without an edge bound the speed and end in a standstill", "[CTL-010]") {
    const double radps = GENERATE(5.0, 40.0, 300.0);
    Line line;
    for (int i = 0; i < 500; ++i) line.turn_to(radps);
    while (!line.turn_to(radps).fresh) {
    }
    const Time last_edge_frame = line.now;
    int bounded = 0;
    for (int i = 1; i <= 130; ++i) {
        line.now += line.period;
        line.input.received = line.now;  // a new frame with the old count
        const SpeedReading reading = line.estimator.update(line.input);
        const double idle = static_cast<double>((line.now - last_edge_frame).count()) * 1e-9;
        CAPTURE(i, radps);
        REQUIRE(reading.valid);
        if (i < 100) {
            REQUIRE_FALSE(reading.fresh);
            const double bound = std::min(radps, kTooth_rad / idle);
            REQUIRE(static_cast<double>(reading.speed_radps) == Approx(bound).epsilon(1e-5));
            REQUIRE(reading.bounded == (kTooth_rad / idle < radps * (1.0 - 1e-6)));
            bounded += reading.bounded ? 1 : 0;
        } else {
            REQUIRE(reading.fresh);
            REQUIRE(reading.speed_radps == 0.0F);
        }
    }
    CHECK(bounded > 70);
}

TEST_CASE("frames that do not come say nothing about the shaft", "[CTL-010]") {
    Line line;
    for (int i = 0; i < 200; ++i) line.turn_to(150.0);
    const float before = line.again().speed_radps;
    for (int i = 0; i < 300; ++i) {
        const SpeedReading reading = line.again();
        CHECK_FALSE(reading.fresh);
        CHECK_FALSE(reading.bounded);
        CHECK(reading.valid);
        REQUIRE(reading.speed_radps == before);
    }
    // The next frame spans the gap: still the exact mean.
    for (int i = 0; i < 301; ++i) line.shaft.turn_to(150.0, 1e-3);
    const SpeedReading reading = line.turn_to(150.0);
    CHECK(reading.fresh);
    CHECK(reading.speed_radps == Approx(150.0).epsilon(1e-5));
    CHECK(reading.interval_s == Approx(0.3).margin(0.005));
}

TEST_CASE("an encoder whose clock starts anew costs one reading", "[CTL-010]") {
    Line line;
    for (int i = 0; i < 200; ++i) line.turn_to(150.0);
    line.shaft.first_time = Time{-10'000'000'000};
    line.shaft.first_count = 77;
    int stale = 0;
    SpeedReading reading = line.turn_to(150.0);
    while (!reading.fresh) {
        CHECK_FALSE(reading.bounded);
        CHECK(reading.speed_radps == Approx(150.0).epsilon(1e-5));
        ++stale;
        reading = line.turn_to(150.0);
    }
    CHECK(stale <= 2);
    CHECK(reading.speed_radps == Approx(150.0).epsilon(1e-5));
}

TEST_CASE("edges whose clock stands still are not a speed", "[CTL-010]") {
    Line line;
    for (int i = 0; i < 200; ++i) line.turn_to(150.0);
    const Time stamp = line.input.edge_time;
    SpeedReading reading;
    for (int i = 0; i < 120; ++i) {
        line.now += line.period;
        line.shaft.turn_to(150.0, 1e-3);
        line.shaft.report(line.input, line.now);
        line.input.edge_time = stamp;
        reading = line.estimator.update(line.input);
    }
    // No time, no speed: it ends as a standstill, which the plausibility checks judge.
    CHECK(reading.speed_radps == 0.0F);
    CHECK(reading.valid);
}

TEST_CASE("a sensor that reports speed is taken at its word", "[CTL-010]") {
    SpeedEstimator estimator(60.0F);
    SpeedInput input;
    input.source = SpeedSource::speed;
    input.speed_radps = 12.5F;
    CHECK_FALSE(estimator.update(input).valid);  // never received
    input.received = kMillisecond;
    SpeedReading reading = estimator.update(input);
    CHECK(reading.valid);
    CHECK(reading.fresh);
    CHECK(reading.interval_s == 0.0F);
    CHECK(reading.speed_radps == 12.5F);
    reading = estimator.update(input);
    CHECK(reading.valid);
    CHECK_FALSE(reading.fresh);
}

TEST_CASE("a clock that jumps, or an old frame, is no edge interval", "[CTL-010]") {
    Line line;
    for (int i = 0; i < 100; ++i) static_cast<void>(line.turn_to(100.0));
    const Time jump = GENERATE(Time{30'000'000}, Time{429'000'000'000});
    const std::uint32_t count = GENERATE(0U, 65'536U);
    int fresh = 0;
    for (int i = 0; i < 20; ++i) {
        line.now += line.period;
        line.shaft.turn_to(100.0, line.h);
        line.shaft.report(line.input, line.now);
        line.input.edge_time += jump;
        line.input.edge_count += count;
        const SpeedReading reading = line.estimator.update(line.input);
        if (!reading.fresh) continue;
        ++fresh;
        CHECK(reading.speed_radps == Approx(100.0).epsilon(1e-3));
    }
    CHECK(fresh > 10);
}

TEST_CASE(
    "a frame is late by what it comes later after its edge than the quickest, by clocks without a common "
    "zero",
    "[CTL-081]") {
    Line line;
    line.shaft.first_time = Time{GENERATE(0LL, 7'000'000'000LL, -3'000'000'000LL)};
    const auto late = [&line](const Time by) {
        line.now += line.period;
        line.shaft.turn_to(209.4395, line.h);  // two edges in a period
        line.shaft.report(line.input, line.now + by);
        return line.estimator.update(line.input).late_s > 0.025F;
    };
    const auto settles = [&late] {
        static_cast<void>(late(Time{}));
        for (int i = 0; i < 200; ++i) {
            if (late(Time{})) return false;
        }
        return true;
    };
    REQUIRE(settles());
    CHECK_FALSE(late(Time{23'000'000}));
    CHECK(late(Time{27'000'000}));
    CHECK(late(Time{27'000'000}));
    CHECK_FALSE(late(Time{}));
    SECTION("a sensor's clock that starts anew is known anew") {
        line.shaft.first_time -= Time{50'000'000};
        CHECK(settles());
    }
    SECTION("a clock that was set is not late for ever") {
        CHECK(settles());
        int readings = 1;
        while (late(Time{50'000'000})) REQUIRE(++readings < 2000);
        CHECK(readings > 500);
    }
    SECTION("and so is one that jumped ahead") {
        line.shaft.first_time += Time{900'000'000};
        CHECK(settles());
        CHECK(late(Time{27'000'000}));
    }
    SECTION("over a standstill the clocks may drift apart") {
        for (int i = 0; i < 300; ++i) static_cast<void>(line.turn_to(0.0));
        line.shaft.first_time -= Time{40'000'000};
        CHECK(settles());
    }
}

TEST_CASE("how late a frame is, is measured", "[CTL-081]") {
    const Time later{GENERATE(0, 1, 3'000'000, 25'000'001)};
    SpeedEstimator estimator(60.0F);
    SpeedInput input{.source = SpeedSource::edges};
    SpeedReading reading;
    for (int k = 1; k <= 10; ++k) {
        input.edge_count += 1;
        input.edge_time = k * kMillisecond;
        input.received = input.edge_time + (k == 10 ? later : Time{});
        reading = estimator.update(input);
    }
    CHECK(reading.late_s == Approx(seconds(later)));
}
