// Speed by the M/T method, from frames written by hand.
#include "firmware/control/speed_estimator.hpp"

#include "tests/catch.hpp"
#include "tests/control/speed_line.hpp"

using namespace antiskid::control;
using speed_test::kMillisecond;
using speed_test::kTeeth;
using speed_test::kTooth_rad;

namespace {

/// Frames written by hand.
struct ByHand {
    SpeedReading frame(const Time at, const std::uint32_t edges, const Time edge_time) {
        input.received = at;
        input.edge_count = edges;
        input.edge_time = edge_time;
        return estimator.update(input);
    }
    /// Edges 10 ms apart up to `kStart`, one in each frame: a speed is known.
    void run() {
        for (int i = -3; i <= 0; ++i) frame(kStart + 10 * i * kMillisecond, static_cast<std::uint32_t>(1000 + i), kClock + 10 * i * kMillisecond);
    }

    static constexpr Time kStart{10'000'000'000};
    static constexpr Time kClock{-7'000'000'000};  // the sensor's own, which may count from anywhere
    SpeedInput input;
    SpeedEstimator estimator{static_cast<float>(kTeeth)};
};

}  // namespace

TEST_CASE("a sensor that never reports has no reading", "[CTL-010]") {
    SpeedEstimator estimator(60.0F);
    const SpeedReading reading = estimator.update({});
    CHECK(reading.speed_radps == 0.0F);
    CHECK_FALSE(reading.fresh);
    CHECK_FALSE(reading.bounded);
    CHECK_FALSE(reading.valid);
}

TEST_CASE("wherever count and clock start, two edges make a speed, one does not", "[CTL-010]") {
    const Time clock = GENERATE(Time{9'990'000'000}, Time{-5'000'000'000});
    ByHand h;
    CHECK_FALSE(h.frame(h.kStart, 4'000'000'000U, clock).valid);
    CHECK_FALSE(h.frame(h.kStart + 10 * kMillisecond, 4'000'000'001U, clock + 10 * kMillisecond).valid);
    const SpeedReading reading = h.frame(h.kStart + 20 * kMillisecond, 4'000'000'002U, clock + 20 * kMillisecond);
    CHECK(reading.fresh);
    CHECK(static_cast<double>(reading.speed_radps) == Approx(kTooth_rad / 10e-3));
}

TEST_CASE("edges may take 25 ms longer than their frames, not a nanosecond more", "[CTL-010]") {
    const std::uint32_t edges = GENERATE(1U, 5U);
    for (const bool more : {false, true}) {
        ByHand h;
        h.run();
        const SpeedReading reading = h.frame(h.kStart + 10 * kMillisecond, 1000U + edges, h.kClock + 35 * kMillisecond + Time{more ? 1 : 0});
        CHECK(reading.fresh != more);
        CHECK(reading.valid);
    }
}

TEST_CASE("a clock that jumps over a standstill costs one edge, as any standstill does", "[CTL-010]") {
    ByHand h;
    h.run();
    for (int ms = 10; ms <= 200; ms += 10) h.frame(h.kStart + ms * kMillisecond, 1000U, h.kClock);
    const Time jumped = h.kClock + Time{1'000'000'000'000};
    h.frame(h.kStart + 210 * kMillisecond, 1001U, jumped);
    const SpeedReading reading = h.frame(h.kStart + 220 * kMillisecond, 1002U, jumped + 10 * kMillisecond);
    CHECK(reading.fresh);
    CHECK(static_cast<double>(reading.speed_radps) == Approx(kTooth_rad / 10e-3));
}

TEST_CASE("after a jump of the clock the wait for a standstill starts anew", "[CTL-010]") {
    ByHand h;
    h.run();
    h.frame(h.kStart + 60 * kMillisecond, 1000U, h.kClock);
    const Time jumped = h.kClock + Time{1'000'000'000'000};
    h.frame(h.kStart + 61 * kMillisecond, 1001U, jumped);
    CHECK(h.frame(h.kStart + 160 * kMillisecond, 1001U, jumped).speed_radps > 0.0F);
    CHECK(h.frame(h.kStart + 161 * kMillisecond, 1001U, jumped).speed_radps == 0.0F);
}

TEST_CASE("no edge for as long as the last one took is no news, for longer it is", "[CTL-010]") {
    ByHand h;
    h.run();
    CHECK_FALSE(h.frame(h.kStart + 10 * kMillisecond, 1000U, h.kClock).bounded);
    CHECK(h.frame(h.kStart + 10 * kMillisecond + Time{1'000}, 1000U, h.kClock).bounded);
}

TEST_CASE("edges a nanosecond apart are a reading like any other", "[CTL-010]") {
    ByHand h;
    h.run();
    const SpeedReading reading = h.frame(h.kStart + kMillisecond, 1001U, h.kClock + Time{1});
    CHECK(reading.fresh);
    CHECK(static_cast<double>(reading.speed_radps) == Approx(kTooth_rad / 1e-9));
}

TEST_CASE("count and clock of an encoder may begin anywhere, also just before they roll over", "[CTL-010]") {
    struct Row {
        std::uint32_t first_count;
        Time first_time;
    };
    const Row row = GENERATE(values<Row>({{0, Time{0}}, {0xFFFF'FFFFU, Time{0}}, {7, Time{-1'500'000}}, {0xFFFF'FFFFU, Time{-1'500'000}}}));
    SpeedEstimator estimator(static_cast<float>(kTeeth));
    SpeedInput input;
    SpeedReading reading;
    for (std::uint32_t k = 0; k < 3; ++k) {  // an edge and a frame every millisecond
        input.received = Time{5'000'000'000} + k * kMillisecond;
        input.edge_count = row.first_count + k;
        input.edge_time = row.first_time + k * kMillisecond;
        reading = estimator.update(input);
        CHECK(reading.valid == (k == 2));
    }
    CHECK(reading.speed_radps == Approx(kTooth_rad / 1e-3));
}

TEST_CASE("an edge whose clock went back starts nothing, the next one does", "[CTL-010]") {
    SpeedEstimator estimator(static_cast<float>(kTeeth));
    SpeedInput input;
    std::uint32_t frame = 0;
    for (const Time edge_time : {Time{9'000'000}, Time{3'000'000}, Time{4'000'000}, Time{5'000'000}}) {
        input.received = Time{5'000'000'000} + frame * kMillisecond;
        input.edge_count = frame;
        input.edge_time = edge_time;
        const SpeedReading reading = estimator.update(input);
        CHECK(reading.valid == (frame == 3));
        if (reading.valid) CHECK(reading.speed_radps == Approx(kTooth_rad / 1e-3));
        ++frame;
    }
}
