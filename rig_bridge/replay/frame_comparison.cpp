#include "rig_bridge/replay/frame_comparison.hpp"

#include <cmath>

#include "firmware/can/roles.hpp"

namespace rig::replay {

using antiskid::can::Payload;
using antiskid::can::Role;

double current_difference_mA(const FrameDifference& d, const antiskid::can::Layout& layout) {
    const antiskid::can::Signal& current = layout.valve_current_mA;
    const auto value = [&](const Frame& frame) { return current.value(Payload(frame.data).read(current)); };
    return value(d.replayed) - value(d.recorded);
}

FrameComparison::FrameComparison(const antiskid::can::Layout& layout) : layout_(layout) {}

void FrameComparison::recorded(Role role, const LogFrame& frame) {
    sides_[static_cast<std::size_t>(role)].recorded.push_back(frame);
    match(role);
}

void FrameComparison::replayed(const Frame& frame) {
    for (const Role role : antiskid::can::kToRig) {
        if (!layout_[role].bound || layout_[role].id != frame.id) continue;
        sides_[static_cast<std::size_t>(role)].replayed.push_back(frame);
        match(role);
        return;
    }
}

void FrameComparison::finish() {
    for (Sides& sides : sides_) {
        sides.count.only_recorded += sides.recorded.size();
        sides.recorded.clear();
        sides.replayed.clear();
    }
}

int FrameComparison::behind(Role role, const Frame& recorded, const Frame& replayed) const {
    const antiskid::can::E2e& protection = layout_[role].protection;
    if (protection.protection == antiskid::can::Protection::none) return 0;
    const auto counter = [&](const Frame& frame) { return static_cast<int>(Payload(frame.data).read(protection.counter)); };
    const int modulo = protection.counter_modulo;
    const int distance = ((counter(recorded) - counter(replayed)) % modulo + modulo) % modulo;
    return distance <= modulo / 2 ? distance : distance - modulo;
}

bool FrameComparison::past_self_test(const Frame& status) const {
    return Payload(status.data).read(layout_.status.state) != static_cast<std::int64_t>(antiskid::control::State::self_test);
}

void FrameComparison::note(Role role, const LogFrame& recorded, const Frame& replayed) {
    ++sides_[static_cast<std::size_t>(role)].count.different;
    const FrameDifference difference{
        .role = role, .line = recorded.line, .time = recorded.frame.received, .recorded = recorded.frame, .replayed = replayed};
    if (!first_ || recorded.line < first_->line) first_ = difference;
    const auto size = [&](const FrameDifference& d) { return std::abs(current_difference_mA(d, layout_)); };
    if (role == Role::valve && (!largest_ || size(difference) > size(*largest_))) largest_ = difference;
}

void FrameComparison::match(Role role) {
    Sides& s = sides_[static_cast<std::size_t>(role)];
    while (!s.recorded.empty() && !s.replayed.empty()) {
        const LogFrame& ours = s.recorded.front();
        const Frame& theirs = s.replayed.front();
        const int lag = behind(role, ours.frame, theirs);
        if (lag > 0) {
            ++s.count.only_replayed;
            s.replayed.pop_front();
            continue;
        }
        if (lag < 0) {
            ++s.count.only_recorded;
            s.recorded.pop_front();
            continue;
        }
        const bool same = ours.frame.length == theirs.length && ours.frame.data == theirs.data;
        if (same && role == Role::status && past_self_test(theirs)) settling_ = false;
        if (!same && settling_ && role != Role::valve) {
            ++s.count.settling;
        } else {
            ++s.count.compared;
            if (!same) note(role, ours, theirs);
        }
        s.recorded.pop_front();
        s.replayed.pop_front();
    }
    if (s.recorded.size() > kAhead) {
        ++s.count.only_recorded;
        s.recorded.pop_front();
    }
    if (s.replayed.size() > kAhead) {
        ++s.count.only_replayed;
        s.replayed.pop_front();
    }
}

}  // namespace rig::replay
