#include "firmware/host/periodic_timer.hpp"

namespace antiskid::host {

PeriodicTimer::Tick PeriodicTimer::wait() {
    // The clock is read once only, after the sleep: in a virtual machine each reading costs as much as the
    // control step.
    clock_.sleep_until(next_);
    const Time woke = clock_.now();
    const Time latency = woke - next_;
    const std::int64_t skipped = latency > Time{0} ? latency / period_ : 0;
    const Time deadline = next_ + skipped * period_;
    next_ = deadline + period_;
    return {deadline, woke, latency, static_cast<std::uint64_t>(skipped)};
}

}  // namespace antiskid::host
