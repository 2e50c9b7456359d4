// The clock is a fake that the test sets: what the timer reports must follow from arithmetic on the grid
// alone.
#include "firmware/host/periodic_timer.hpp"

#include <chrono>
#include <vector>

#include "tests/catch.hpp"

using antiskid::host::Clock;
using antiskid::host::PeriodicTimer;
using antiskid::host::Time;
using namespace std::chrono_literals;

namespace {

class FakeClock final : public Clock {
  public:
    Time now() override { return now_; }
    void sleep_until(const Time deadline) override {
        slept_to.push_back(deadline);
        if (deadline > now_) now_ = deadline;
        now_ += wake_latency;
    }
    void advance(const Time by) { now_ += by; }

    std::vector<Time> slept_to;
    Time wake_latency{};

  private:
    Time now_ = 5s;
};

}  // namespace

TEST_CASE("deadlines lie on a fixed grid whatever the wake-up latency and the work", "[RT-001]") {
    FakeClock clock;
    PeriodicTimer timer(clock, 1ms);
    for (int period = 1; period <= 1000; ++period) {
        clock.wake_latency = Time{(period * 7919) % 300'000};
        const auto tick = timer.wait();
        REQUIRE(tick.deadline == 5s + period * 1ms);
        REQUIRE(tick.woke == tick.deadline + clock.wake_latency);
        REQUIRE(tick.skipped == 0);
        clock.advance(Time{(period * 104'729) % 600'000});
    }
    REQUIRE(clock.slept_to.back() == 5s + 1000ms);
}

TEST_CASE("work longer than a period: missed periods are counted once and left out, without a burst", "[RT-001]") {
    FakeClock clock;
    PeriodicTimer timer(clock, 1ms);
    REQUIRE(timer.wait().deadline == 5001ms);

    clock.advance(3400us);  // to 5004.4 ms; the points 5002 and 5003 are lost
    const auto late = timer.wait();
    CHECK(late.deadline == 5004ms);
    CHECK(late.woke == 5004400us);
    CHECK(late.latency == 2400us);
    CHECK(late.skipped == 2);

    const auto next = timer.wait();
    CHECK(next.deadline == 5005ms);
    CHECK(next.woke == 5005ms);
    CHECK(next.skipped == 0);
}

TEST_CASE("late by less than a period is latency, not a missed period", "[RT-001]") {
    FakeClock clock;
    PeriodicTimer timer(clock, 1ms);
    clock.advance(1999us);
    const auto tick = timer.wait();
    CHECK(tick.deadline == 5001ms);
    CHECK(tick.latency == 999us);
    CHECK(tick.skipped == 0);
    CHECK(timer.wait().deadline == 5002ms);
}

TEST_CASE("late by exactly one period skips exactly one point", "[RT-001]") {
    FakeClock clock;
    PeriodicTimer timer(clock, 1ms);
    clock.advance(2ms);
    const auto tick = timer.wait();
    CHECK(tick.deadline == 5002ms);
    CHECK(tick.skipped == 1);
}

TEST_CASE("a wake-up that comes periods late counts like late work", "[RT-001]") {
    FakeClock clock;
    PeriodicTimer timer(clock, 2ms);
    clock.wake_latency = 9ms;
    const auto tick = timer.wait();  // asked for 5002, woke at 5011: 5004, 5006, 5008 lost, 5010 is this one's
    CHECK(tick.deadline == 5010ms);
    CHECK(tick.latency == 9ms);
    CHECK(tick.skipped == 4);
    clock.wake_latency = 0ms;
    CHECK(timer.wait().deadline == 5012ms);
}

TEST_CASE("a clock that jumps ahead an hour gives one tick", "[RT-001]") {
    FakeClock clock;
    PeriodicTimer timer(clock, 1ms);
    clock.advance(1h);
    const auto tick = timer.wait();
    CHECK(tick.skipped == 3'599'999);
    CHECK(tick.woke - tick.deadline == 0ms);
    CHECK(timer.wait().skipped == 0);
}

TEST_CASE("the monotonic clock never wakes before its deadline and ignores deadlines gone by", "[RT-001]") {
    antiskid::host::MonotonicClock clock;
    const Time before = clock.now();
    clock.sleep_until(before - 1s);
    clock.sleep_until(before + 3ms);
    CHECK(clock.now() >= before + 3ms);
}
