#include "firmware/linux/pacer.hpp"

#include <algorithm>
#include <utility>

namespace antiskid::rt {

std::optional<Wake> TimerPacer::next(const std::atomic<bool>& stop) {
    if (stop.load(std::memory_order_relaxed)) return std::nullopt;
    if (!timer_) timer_.emplace(clock_, period_);
    const PeriodicTimer::Tick tick = timer_->wait();
    return Wake{.now = tick.woke,
                .woke = tick.woke,
                .latency = tick.latency,
                .skipped = tick.skipped,
                .synchronised = true,
                .taken = intake_.drain(tick.woke)};
}

SyncPacer::SyncPacer(Clock& clock, const Time period, const Time timeout, can::Bus& bus,
                     const can::ControllerPort& port, const std::uint64_t sync_modulo, FrameIntake& intake)
    : clock_(clock),
      period_(period),
      timeout_(timeout),
      bus_(bus),
      port_(port),
      sync_modulo_(sync_modulo),
      intake_(intake) {}

std::optional<Wake> SyncPacer::next(const std::atomic<bool>& stop) {
    const Time patience = synchronised_ ? timeout_ : period_;
    Time left = patience;
    FrameIntake::Taken total;
    // A clock reading costs as much as a step in a virtual machine: it is left out while SYNC comes promptly.
    constexpr int kTurnsPerReading = 16;
    for (int turn = 1; !stop.load(std::memory_order_relaxed); ++turn) {
        FrameIntake::Taken taken = intake_.take_until_sync(next_now_);
        total.frames += taken.frames;
        if (taken.sync && repeats_last()) continue;
        if (taken.sync) {
            taken.frames = total.frames;
            return on_sync(taken);
        }
        const bool more = bus_.wait(std::clamp(left, Time{0}, kLongestWait));
        if (!started_ || (more && turn % kTurnsPerReading != 0)) continue;
        const Time reading = clock_.now();
        left = last_woke_ + patience - reading;
        if (left > Time{0}) continue;
        synchronised_ = false;
        last_woke_ = reading;
        return Wake{.now = std::exchange(next_now_, next_now_ + period_),
                    .woke = reading,
                    .latency = -left,
                    .synchronised = false,
                    .taken = total};
    }
    return std::nullopt;
}

Wake SyncPacer::on_sync(const FrameIntake::Taken& taken) {
    const bool follows = follows_last();
    last_woke_ = clock_.now();
    started_ = true;
    synchronised_ = true;
    return Wake{.now = std::exchange(next_now_, next_now_ + period_),
                .woke = last_woke_,
                .latency = std::max(last_woke_ - taken.sync_received, Time{0}),
                .skipped = follows ? 0U : 1U,
                .synchronised = true,
                .taken = taken};
}

bool SyncPacer::repeats_last() const {
    return started_ && synchronised_ && sync_modulo_ != 0 && port_.sync_number() == last_number_;
}

bool SyncPacer::follows_last() {
    const std::uint32_t number = port_.sync_number();
    const bool follows = !started_ || sync_modulo_ == 0 || number == (last_number_ + 1) % sync_modulo_;
    last_number_ = number;
    return follows;
}

}  // namespace antiskid::rt
