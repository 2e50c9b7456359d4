#include "firmware/linux/periodic_timer.hpp"

namespace antiskid::rt {

PeriodicTimer::Tick PeriodicTimer::wait() {
    // The clock is read once only, after the sleep: in a virtual machine each reading costs as much as the
    // control step.
    clock_.sleep_until(next_);
    const Time woke = clock_.now();
    const std::int64_t late_periods = woke > next_ ? (woke - next_) / period_ : 0;
    const Time deadline = next_ + late_periods * period_;
    next_ = deadline + period_;
    return {deadline, woke, static_cast<std::uint64_t>(late_periods)};
}

}  // namespace antiskid::rt
