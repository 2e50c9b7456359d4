#include "rig_bridge/replay/measured_signals.hpp"

#include <algorithm>

namespace rig::replay {

using antiskid::can::Role;

MeasuredSignals::MeasuredSignals(LogReader& log, const antiskid::can::Layout& layout, double period_s) : log_(log), samples_(layout, period_s) {
    if (!layout[Role::sync].bound) return;
    constexpr std::size_t kAhead = 2000;  // number of frames in which SYNC is searched
    for (LogFrame f; ahead_.size() < kAhead && log_.next(f);) ahead_.push_back(f);
    lockstep_ = std::any_of(ahead_.begin(), ahead_.end(), [&](const LogFrame& f) { return f.frame.id == layout[Role::sync].id; });
    if (lockstep_) samples_.expect_sync();
}

bool MeasuredSignals::read(LogFrame& out) {
    if (ahead_.empty()) return log_.next(out);
    out = ahead_.front();
    ahead_.pop_front();
    return true;
}

bool MeasuredSignals::next() {
    for (LogFrame f; read(f);) {
        samples_.accept(f.frame);
        if (restarted()) return false;
        if (!samples_.ended() || (started_ && samples_.time() <= newest_)) continue;
        newest_ = samples_.time();
        if (!started_) first_ = newest_;
        started_ = true;
        line_ = f.line;
        return true;
    }
    return false;
}

std::uint64_t MeasuredSignals::rejected() const {
    std::uint64_t sum = 0;
    for (const Role role : {Role::wheel, Role::flywheel, Role::pressure, Role::maneuver}) sum += samples_.observer().stats(role).rejected();
    return sum;
}

}  // namespace rig::replay
