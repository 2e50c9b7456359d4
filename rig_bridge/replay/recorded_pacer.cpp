#include "rig_bridge/replay/recorded_pacer.hpp"

#include <algorithm>
#include <utility>

#include "firmware/can/roles.hpp"
#include "firmware/can/schedule.hpp"
#include "firmware/host/control_loop.hpp"
#include "firmware/host/frame_intake.hpp"

namespace rig::replay {

using antiskid::can::Payload;
using antiskid::can::Role;
using antiskid::host::Wake;

namespace {

constexpr std::size_t kMaxSamples = 64;  // unanswered; if a controller hangs longer, its steps are not reproduced
constexpr std::size_t kMaxLoose = antiskid::host::FrameIntake::kMax;
constexpr std::size_t kLookAhead = 16384;  // lines
constexpr std::size_t kJoining = 256;      // steps: more than two periods of the slowest message

std::optional<Role> role_of(const antiskid::can::Layout& layout, std::uint32_t id) {
    for (std::size_t i = 0; i < antiskid::can::kRoleCount; ++i)
        if (layout.messages[i].bound && layout.messages[i].id == id) return static_cast<Role>(i);
    return std::nullopt;
}

template <typename Roles>
bool contains(const Roles& roles, Role role) {
    return std::find(roles.begin(), roles.end(), role) != roles.end();
}

constexpr std::uint64_t kMax = 100'000;

/// Number of times a message was due before each step.
class Timetable {
  public:
    Timetable(const antiskid::can::Layout& layout, const antiskid::can::Schedule& schedule, Role role, std::uint64_t steps)
        : modulo_(layout[role].protection.counter_modulo), counted_(layout[role].protection.protection != antiskid::can::Protection::none) {
        before_.reserve(steps + 1);
        before_.push_back(0);
        for (std::uint64_t i = 0; i < steps; ++i) before_.push_back(before_.back() + (schedule.due(role, static_cast<std::uint32_t>(i)) ? 1U : 0U));
    }

    [[nodiscard]] bool agrees(std::uint64_t step, int sent) const {
        if (sent == SentAtStep::kUnknown) return true;
        const bool due = before_[step + 1] != before_[step];
        if (sent == SentAtStep::kNotSent) return !due;
        return due && (!counted_ || before_[step] % modulo_ == static_cast<std::uint32_t>(sent));
    }

  private:
    std::uint32_t modulo_;
    bool counted_;
    std::vector<std::uint32_t> before_;
};

}  // namespace

RecordedPacer::RecordedPacer(const PacerSettings& settings, const antiskid::can::Layout& layout, LogReader& log, antiskid::can::ControllerPort& port,
                             FrameComparison& comparison)
    : settings_(settings), layout_(layout), log_(log), port_(port), comparison_(comparison), lockstep_(settings.clock == ReplayClock::sync) {}

std::optional<Wake> RecordedPacer::next(const std::atomic<bool>& stop) {
    LogFrame frame;
    while (!ended_ && !stop.load(std::memory_order_relaxed) && read(frame)) {
        const auto role = role_of(layout_, frame.frame.id);
        if (!role) continue;
        if (contains(antiskid::can::kToController, *role)) {
            rig_frame(frame.frame, *role == Role::sync);
            continue;
        }
        if (!contains(antiskid::can::kToRig, *role)) continue;
        comparison_.recorded(*role, frame);
        if (*role != Role::valve) continue;
        if (!started_ && settings_.clock == ReplayClock::automatic) lockstep_ = !samples_.empty();
        if (!started_) join_session(frame.frame);
        if (samples_.empty() && is_closing(frame)) {
            for (const LogFrame& rest : ahead_) {
                if (const auto other = role_of(layout_, rest.frame.id); other && contains(antiskid::can::kToRig, *other))
                    comparison_.recorded(*other, rest);
            }
            ended_ = true;
            break;
        }
        return step(frame.frame.received);
    }
    // The answers to the last samples may be among the recorded ones whose older partners are missing.
    if (!samples_.empty() && comparison_.waiting(Role::valve) > 0) return step(last_now_);
    return std::nullopt;
}

bool RecordedPacer::read(LogFrame& out) {
    if (ahead_.empty()) return log_.next(out);
    out = ahead_.front();
    ahead_.pop_front();
    return true;
}

void RecordedPacer::rig_frame(const Frame& frame, bool sync) {
    const bool ends_sample = sync && settings_.clock != ReplayClock::timer && (!started_ || lockstep_);
    frames_.push_back(frame);
    ++loose_;
    if (!ends_sample) {
        if (loose_ <= kMaxLoose) return;
        frames_.erase(frames_.end() - static_cast<std::ptrdiff_t>(loose_));
        --loose_;
        return;
    }
    const auto number = layout_.sync_counter.bound() ? static_cast<std::uint32_t>(Payload(frame.data).read(layout_.sync_counter)) : 0U;
    if (!samples_.empty() && (!started_ || samples_.size() == kMaxSamples)) drop_oldest_sample();
    samples_.push_back({.frames = loose_, .number = number});
    loose_ = 0;
}

void RecordedPacer::drop_oldest_sample() {
    frames_.erase(frames_.begin(), frames_.begin() + static_cast<std::ptrdiff_t>(samples_.front().frames));
    samples_.pop_front();
    ++unanswered_;
}

void RecordedPacer::look_ahead() {
    std::size_t valves = 0;
    for (LogFrame f; valves < kJoining && ahead_.size() < kLookAhead && log_.next(f);) {
        ahead_.push_back(f);
        if (f.frame.id == layout_[Role::valve].id) ++valves;
    }
}

std::vector<SentAtStep> RecordedPacer::sent_ahead(const Frame& first_valve, bool valve_last) const {
    const auto counter = [&](Role role, const Frame& frame) {
        const antiskid::can::E2e& protection = layout_[role].protection;
        return protection.protection == antiskid::can::Protection::none ? 0 : static_cast<int>(Payload(frame.data).read(protection.counter));
    };
    SentAtStep nothing;
    nothing.counter.fill(SentAtStep::kNotSent);
    // If the valve command is last, frames before the first command may be missing.
    std::vector<SentAtStep> steps{valve_last ? SentAtStep() : nothing};
    steps.back()[Role::valve] = counter(Role::valve, first_valve);
    SentAtStep next = nothing;
    for (const LogFrame& f : ahead_) {
        const auto role = role_of(layout_, f.frame.id);
        if (!role || !contains(antiskid::can::kToRig, *role)) continue;
        SentAtStep& step = *role == Role::valve || valve_last ? next : steps.back();
        step[*role] = counter(*role, f.frame);
        if (*role == Role::valve) steps.push_back(std::exchange(next, nothing));
    }
    if (!valve_last) steps.pop_back();  // frames after the last command have not been read
    return steps;
}

void RecordedPacer::join_session(const Frame& first_valve) {
    look_ahead();
    // The valve command is last in lockstep, first with the timer.
    before_log_ = steps_before(layout_, settings_.period, sent_ahead(first_valve, lockstep_));
    if (!before_log_) before_log_ = steps_before(layout_, settings_.period, sent_ahead(first_valve, !lockstep_));
    if (before_log_.value_or(1) != 0) comparison_.expect_self_test();
    std::array<Frame, antiskid::can::ControllerPort::kMaxFrames> sent_before{};
    for (std::uint64_t i = 0; i < before_log_.value_or(0); ++i) (void)port_.due_frames({}, sent_before);
}

bool RecordedPacer::carries_safe_current(const Frame& valve) const {
    return Payload(valve.data).read(layout_.valve_current_mA) == layout_.valve_current_mA.raw(static_cast<double>(settings_.safe_current_mA));
}

bool RecordedPacer::is_closing(const LogFrame& valve) {
    if (!carries_safe_current(valve.frame)) return false;
    std::size_t more = 0;
    const auto harmless = [&](const LogFrame& f) {
        if (f.frame.id != layout_[Role::valve].id) return true;
        return ++more < antiskid::host::ControlLoop::kSafeCommands && carries_safe_current(f.frame);
    };
    if (!std::all_of(ahead_.begin(), ahead_.end(), harmless)) return false;
    for (LogFrame f; ahead_.size() < kLookAhead;) {
        if (!log_.next(f)) return true;
        ahead_.push_back(f);
        if (!harmless(f)) return false;
    }
    return false;
}

Wake RecordedPacer::step(Time stamp) {
    Wake wake;
    const bool sampled = !samples_.empty();
    wake.synchronised = sampled || !lockstep_;
    if (!wake.synchronised) ++unsynchronised_;
    if (lockstep_) {
        wake.now = settings_.period * static_cast<std::int64_t>(steps_);
        if (sampled && !follows_last(samples_.front().number)) wake.skipped = 1;
    } else {
        wake.now = started_ ? std::max(stamp, last_now_) : stamp;
        const auto periods = (wake.now - last_now_ + settings_.period / 2) / settings_.period;
        if (started_ && periods > 1) wake.skipped = static_cast<std::uint64_t>(periods - 1);
    }
    wake.taken.frames = feed(sampled ? samples_.front().frames : loose_, wake.now);
    if (sampled)
        samples_.pop_front();
    else
        loose_ = 0;
    if (!started_) first_now_ = wake.now;
    started_ = true;
    last_now_ = wake.now;
    wake.woke = wake.now;
    ++steps_;
    return wake;
}

bool RecordedPacer::follows_last(std::uint32_t number) {
    const bool numbered = layout_.sync_counter.bound();
    const bool follows = !any_number_ || !numbered || number == ((last_number_ + 1) & layout_.sync_counter.mask());
    any_number_ = true;
    last_number_ = number;
    return follows;
}

std::size_t RecordedPacer::feed(std::size_t count, Time now) {
    for (std::size_t i = 0; i < count; ++i) {
        Frame& frame = frames_[i];
        frame.received = lockstep_ ? now : std::min(frame.received, now);
        port_.accept(frame);
    }
    frames_.erase(frames_.begin(), frames_.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
}

std::optional<std::uint64_t> steps_before(const antiskid::can::Layout& layout, antiskid::control::Time period, const std::vector<SentAtStep>& steps) {
    const antiskid::can::Schedule schedule(layout, period);
    std::vector<std::pair<Role, Timetable>> tables;
    tables.reserve(antiskid::can::kToRig.size());
    for (const Role role : antiskid::can::kToRig)
        if (layout[role].bound) tables.emplace_back(role, Timetable(layout, schedule, role, kMax + steps.size()));
    for (std::uint64_t start = 0; start < kMax; ++start) {
        const auto fits = [&](const auto& table) {
            for (std::size_t i = 0; i < steps.size(); ++i)
                if (!table.second.agrees(start + i, steps[i][table.first])) return false;
            return true;
        };
        if (std::all_of(tables.begin(), tables.end(), fits)) return start;
    }
    return std::nullopt;
}

}  // namespace rig::replay
