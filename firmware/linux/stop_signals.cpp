#include "firmware/linux/stop_signals.hpp"

#include <ctime>

namespace antiskid::rt {

StopSignals::StopSignals() {
    sigemptyset(&set_);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set_, number);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
}

std::optional<int> StopSignals::wait(const control::Time timeout) const {
    constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
    const timespec t{.tv_sec = timeout.count() / kNanosecondsPerSecond,
                     .tv_nsec = timeout.count() % kNanosecondsPerSecond};
    const int number = sigtimedwait(&set_, nullptr, &t);
    if (number < 0) return std::nullopt;
    return number;
}

}  // namespace antiskid::rt
