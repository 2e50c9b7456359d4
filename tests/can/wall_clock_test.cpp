#include "firmware/can/wall_clock_offset.hpp"
#include "firmware/can/wall_minus_monotonic.hpp"
#include "tests/catch.hpp"

using antiskid::can::ClockReading;
using antiskid::can::Time;
using antiskid::can::WallClockOffset;
using antiskid::can::WallMinusMonotonic;

namespace {

constexpr Time kMillisecond{1'000'000};
constexpr Time kSecond{1'000'000'000};

/// Both clocks of a machine, and frames that are read a millisecond after they came.
struct Machine {
    Time offset{1'000'000 * kSecond};
    Time now = 10 * kSecond;
    WallClockOffset mapping{[this] { return ClockReading{.wall_minus_monotonic = offset, .monotonic = now}; }};

    /// A frame `after` the last one, stamped with this offset; by how much its time is wrong.
    [[nodiscard]] Time error(Time after, Time stamped_with) {
        now += after;
        const Time came = now - kMillisecond;
        mapping.next_batch();
        return mapping.monotonic(came + stamped_with) - came;
    }
};

/// Clocks of which each reading takes `cost`; the reading with the number `late` takes a millisecond more.
struct SlowClocks {
    static constexpr Time kOffset = 1'000'000 * kSecond;
    WallMinusMonotonic measure{};
    Time now = kSecond;
    int reads = 0;

    /// Number of readings that one measurement takes.
    int readings(Time cost, int late = -1) {
        reads = 0;
        const ClockReading out = measure.measured([&](clockid_t clock) {
            now += cost + (reads++ == late ? kMillisecond : Time{});
            return clock == CLOCK_REALTIME ? now + kOffset : now;
        });
        CHECK(out.monotonic <= now);
        CHECK(out.monotonic > now - 9 * (cost + kMillisecond));
        CHECK(out.wall_minus_monotonic >= kOffset - cost);
        CHECK(out.wall_minus_monotonic <= kOffset + cost);
        return reads;
    }
};

}  // namespace

TEST_CASE("where a reading of a clock is slow, the offset is not measured three times for it", "[CAN-081]") {
    constexpr Time kMicrosecond{1'000};
    SlowClocks clocks;
    CHECK(clocks.readings(25 * kMicrosecond) == 3);
    CHECK(clocks.readings(25 * kMicrosecond, 1) == 6);  // disturbed: once more
    CHECK(clocks.readings(60 * kMicrosecond) == 9);     // disturbed, or slow?
    CHECK(clocks.readings(60 * kMicrosecond) == 3);     // slow
    CHECK(clocks.readings(60 * kMicrosecond, 2) == 6);
    CHECK(clocks.readings(120 * kMicrosecond) == 3);
    CHECK(clocks.readings(60 * kMicrosecond) == 3);
    CHECK(clocks.readings(121 * kMicrosecond) == 9);
    CHECK(clocks.readings(10 * kMicrosecond) == 3);  // and fast again
    CHECK(clocks.readings(26 * kMicrosecond) == 9);
}

TEST_CASE("frames that wait while the wall clock is set keep their time, whichever way it is set", "[CAN-081]") {
    for (const Time set : {kSecond, -kSecond, 3600 * kSecond, -3600 * kSecond}) {
        // Close to each other, so that nobody asks the clocks; and with holes, so that somebody does before the new stamps come.
        for (const Time apart : {kMillisecond, 7 * kMillisecond}) {
            Machine m;
            for (int i = 0; i < 1500; ++i) CHECK(m.error(apart, m.offset) == Time{});
            const Time before = m.offset;
            m.offset += set;
            for (int i = 0; i < 1500; ++i) CHECK(m.error(i == 0 ? apart : Time{1}, before) == Time{});
            for (int i = 0; i < 1500; ++i) CHECK(m.error(apart, m.offset) == Time{});
        }
        // A silence that is longer than the step hides nothing.
        Machine m;
        CHECK(m.error(kSecond, m.offset) == Time{});
        m.offset += set;
        CHECK(m.error(2 * kSecond, m.offset) == Time{});
        CHECK(m.error(kMillisecond, m.offset) == Time{});
    }
}

TEST_CASE("a step that silence hides to the millisecond is found by the second comparison of the clocks", "[CAN-081]") {
    Machine m;
    CHECK(m.error(kSecond, m.offset) == Time{});
    m.offset -= kSecond;
    CHECK(m.error(kSecond + kMillisecond, m.offset) == -kSecond);
    for (int batch = 0; batch < 2 * 1024; ++batch) m.mapping.next_batch();
    CHECK(m.error(kMillisecond, m.offset) == Time{});
}

TEST_CASE("stamps of an offset that nobody saw are not taken for times still to come", "[CAN-081]") {
    for (const Time set : {kSecond, 20 * kMillisecond}) {
        Machine m;
        for (int i = 0; i < 5; ++i) CHECK(m.error(kMillisecond, m.offset) == Time{});
        // The reader is stopped for 100 ms, in which the clock is set and set back; the frames wait.
        const Time stopped = m.now;
        m.now += 100 * kMillisecond;
        for (int i = 1; i <= 100; ++i) {
            const bool meanwhile = i > 40 && i <= 60;
            const Time came = stopped + i * kMillisecond;
            const Time stamp = m.mapping.monotonic(came + m.offset + (meanwhile ? set : Time{}));
            CHECK(stamp <= m.now);
            if (!meanwhile) CHECK(stamp == came);
        }
    }
}
