#include "plant_sim/study/validation/measured_signals.hpp"

#include <algorithm>

namespace rig {

using antiskid::can::Role;

MeasuredSignals::MeasuredSignals(LogReader& log, const antiskid::can::Layout& layout, Time period)
    : log_(log), layout_(layout), period_(period), port_(layout, period) {
    if (!layout[Role::sync].bound) return;
    for (LogFrame f; ahead_.size() < kAhead && log_.next(f);) ahead_.push_back(f);
    lockstep_ = std::any_of(ahead_.begin(), ahead_.end(),
                            [&](const LogFrame& f) { return f.frame.id == layout[Role::sync].id; });
}

bool MeasuredSignals::read(LogFrame& out) {
    if (ahead_.empty()) return log_.next(out);
    out = ahead_.front();
    ahead_.pop_front();
    return true;
}

bool MeasuredSignals::next() {
    for (LogFrame f; !restarted_ && read(f);) {
        const Role ends = lockstep_ ? Role::sync : Role::pressure;
        const std::uint32_t before = port_.stats(ends).accepted;
        port_.accept(f.frame);
        if (port_.stats(ends).accepted == before) continue;
        line_ = f.line;
        if (lockstep_) {
            if (sync(f.frame.received)) return true;
            continue;
        }
        if (started_ && f.frame.received <= time_) continue;
        if (!started_) first_ = f.frame.received;
        started_ = true;
        time_ = f.frame.received;
        return true;
    }
    return false;
}

bool MeasuredSignals::sync(Time stamp) {
    if (!layout_.sync_counter.bound()) {
        time_ = started_ ? time_ + period_ : stamp;
        if (!started_) first_ = time_;
        started_ = true;
        return true;
    }
    const std::uint64_t mask = layout_.sync_counter.mask();
    const std::uint64_t moved = (port_.sync_number() - number_) & mask;
    if (started_ && moved == 0) return false;  // a rig that was not sure to be heard
    if (started_ && moved > mask / 2) {
        restarted_ = true;
        return false;
    }
    number_ = port_.sync_number();
    if (started_) time_ += period_ * static_cast<std::int64_t>(moved);
    started_ = true;
    return true;
}

std::uint64_t MeasuredSignals::rejected() const {
    std::uint64_t sum = 0;
    for (const Role role : {Role::wheel, Role::flywheel, Role::pressure, Role::maneuver})
        sum += port_.stats(role).rejected();
    return sum;
}

}  // namespace rig
