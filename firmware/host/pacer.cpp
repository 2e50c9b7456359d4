#include "firmware/host/pacer.hpp"

#include <algorithm>
#include <utility>

namespace antiskid::host {

std::optional<Wake> TimerPacer::next(const std::atomic<bool>& stop) {
    if (stop.load(std::memory_order_relaxed)) return std::nullopt;
    if (!timer_) timer_.emplace(clock_, period_);
    const PeriodicTimer::Tick tick = timer_->wait();
    return Wake{.now = tick.woke, .woke = tick.woke, .latency = tick.latency, .skipped = tick.skipped, .taken = intake_.drain(tick.woke)};
}

std::optional<can::Role> SensorPacer::message(const can::Layout& layout, const Time period) {
    std::optional<can::Role> last;
    for (const can::Role role : {can::Role::wheel, can::Role::flywheel, can::Role::pressure})
        if (layout[role].period == period && (!last || layout[role].id > layout[*last].id)) last = role;
    return last;
}

SensorPacer::SensorPacer(Clock& clock, const Time period, const can::Role message, can::Bus& bus, const can::ControllerPort& port,
                         FrameIntake& intake)
    : clock_(clock), period_(period), message_(message), bus_(bus), port_(port), intake_(intake) {}

std::optional<Wake> SensorPacer::next(const std::atomic<bool>& stop) {
    if (!started_) last_ = woke_ = clock_.now();
    started_ = true;
    const Time earliest = last_ + period_ / 2;
    const Time latest = last_ + period_ + (by_frame_ ? period_ / 2 : Time{0});
    const std::uint32_t before = arrived();
    std::size_t frames = 0;
    while (!stop.load(std::memory_order_relaxed)) {
        if (arrived() != before)
            clock_.sleep_until(earliest);
        else  // the first time without asking the clock: the step took too little to matter to a time-out
            (void)bus_.wait(latest - woke_);
        woke_ = clock_.now();
        FrameIntake::Taken taken = intake_.drain(woke_);
        frames += taken.frames;
        const bool by_frame = arrived() != before;
        if (woke_ < (by_frame ? earliest : latest)) continue;
        Wake wake = by_frame ? on_frame() : on_silence(latest);
        taken.frames = frames;
        wake.taken = taken;
        return wake;
    }
    return std::nullopt;
}

/// Damaged frames count too: they also show the rig's timing.
std::uint32_t SensorPacer::arrived() const {
    const can::MessageStats& stats = port_.stats(message_);
    return stats.accepted + stats.rejected();
}

Wake SensorPacer::on_frame() {
    const Time first_missed = last_ + period_;
    const std::int64_t skipped = std::max<std::int64_t>((woke_ - first_missed) / period_, 0);
    const Time received = reception();
    const Time came = received > last_ ? received : woke_;  // of a damaged one nobody knows
    last_ = std::max(came, woke_ - period_);
    by_frame_ = true;
    return Wake{.now = woke_, .woke = woke_, .latency = woke_ - (skipped > 0 ? first_missed : came), .skipped = static_cast<std::uint64_t>(skipped)};
}

Wake SensorPacer::on_silence(const Time deadline) {
    const std::int64_t skipped = (woke_ - deadline) / period_;
    last_ = deadline + skipped * period_;
    by_frame_ = false;
    return Wake{.now = woke_, .woke = woke_, .latency = woke_ - deadline, .skipped = static_cast<std::uint64_t>(skipped), .by_timer = true};
}

/// Of the newest accepted frame of the message.
Time SensorPacer::reception() const {
    const control::Sensors& sensors = port_.sensors();
    if (message_ == can::Role::wheel) return sensors.wheel.received;
    return message_ == can::Role::flywheel ? sensors.flywheel.received : sensors.pressure.received;
}

SyncPacer::SyncPacer(Clock& clock, const Time period, const Time timeout, const can::ControllerPort& port, const std::uint64_t sync_modulo,
                     FrameIntake& intake)
    : clock_(clock), period_(period), timeout_(timeout), port_(port), sync_modulo_(sync_modulo), intake_(intake) {}

std::optional<Wake> SyncPacer::next(const std::atomic<bool>& stop) {
    const Time patience = synchronised_ ? timeout_ : period_;
    Time left = patience;
    std::size_t frames = 0;
    constexpr int kTurnsPerReading = 16;
    for (int turn = 1; !stop.load(std::memory_order_relaxed); ++turn) {
        FrameIntake::Taken taken = intake_.take_until_sync(next_now_, std::clamp(left, Time{1}, kLongestWait));
        const bool more = taken.frames > 0;
        frames += taken.frames;
        taken.frames = frames;
        if (taken.sync && repeats_last()) continue;
        if (taken.sync) return on_sync(taken);
        if (!started_ || (more && turn % kTurnsPerReading != 0)) continue;
        const Time reading = clock_.now();
        if (!last_) last_ = reading;
        left = *last_ + patience - reading;
        if (left > Time{0}) continue;
        synchronised_ = false;
        last_ = reading;
        return Wake{.now = std::exchange(next_now_, next_now_ + period_), .woke = reading, .latency = -left, .synchronised = false, .taken = taken};
    }
    return std::nullopt;
}

Wake SyncPacer::on_sync(const FrameIntake::Taken& taken) {
    const bool follows = follows_last();
    last_.reset();
    started_ = true;
    synchronised_ = true;
    return Wake{.now = std::exchange(next_now_, next_now_ + period_), .woke = taken.sync_received, .skipped = follows ? 0U : 1U, .taken = taken};
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

}  // namespace antiskid::host
