#include "firmware/host/clock.hpp"

#include <cerrno>
#include <ctime>

namespace antiskid::host {

namespace {
constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
}

Time MonotonicClock::now() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return Time{t.tv_sec * kNanosecondsPerSecond + t.tv_nsec};
}

void MonotonicClock::sleep_until(const Time deadline) {
    const timespec t{.tv_sec = deadline.count() / kNanosecondsPerSecond, .tv_nsec = deadline.count() % kNanosecondsPerSecond};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
    }
}

}  // namespace antiskid::host
