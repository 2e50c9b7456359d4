#include "rig_bridge/modbus/command_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace rig::modbus {
namespace {

bool is_the_clients_own(Commanded q) {
    return q == Commanded::bridge_watchdog || q == Commanded::commit;
}

std::string complaint(const Field& field, double value) {
    std::array<char, 160> text{};
    if (std::isnan(value)) {
        std::snprintf(text.data(), text.size(), "%s: not a number", field.name.c_str());
    } else {
        std::snprintf(text.data(), text.size(), "%s: %g%s%s is out of range %g to %g", field.name.c_str(), value, field.unit.empty() ? "" : " ",
                      field.unit.c_str(), field.min, field.max);
    }
    return text.data();
}

}  // namespace

std::string_view name(CommandState state) {
    constexpr std::array<std::string_view, 5> kNames{"none", "pending", "applied", "rejected", "unsendable"};
    return kNames[static_cast<std::size_t>(state)];
}

CommandTracker::CommandTracker(const RegisterMap& map) : map_(map), wanted_(map.commanded, map.word_order), last_(wanted_) {}

void CommandTracker::want(const CommandedValues& wanted, ClockTime now) {
    RegisterImage image(wanted_);
    error_.clear();
    for (std::size_t i = 0; i < kCommandedCount && error_.empty(); ++i) {
        if (is_the_clients_own(static_cast<Commanded>(i))) continue;
        const Field& field = map_.commanded[i];
        const bool sendable = wanted[i] >= field.min && wanted[i] <= field.max && image.write(field, wanted[i]);
        if (!sendable) error_ = complaint(field, wanted[i]);
    }
    if (!error_.empty()) return;
    const bool was_due = any_ && (resend_ || wanted_ != last_);
    if (!any_) resend_ = true;
    any_ = true;
    if (wanted_ != image) newest_at_ = now;
    wanted_ = image;
    if (!was_due) wished_at_ = now;
}

void CommandTracker::reconnected(std::uint16_t commit, ClockTime now) {
    // Skip our own last number, too: the PLC may have been restarted and lost its answer to that one.
    next_ = static_cast<std::uint16_t>(std::max(commit, commit_) + 1);
    standing_ = commit;
    looked_ = false;
    if (!any_) return;
    if (!resend_ && wanted_ == last_) wished_at_ = now;
    resend_ = true;
}

std::optional<RegisterImage> CommandTracker::due() {
    if (!any_ || !error_.empty() || (!resend_ && wanted_ == last_)) return std::nullopt;
    // An answer from before the numbers wrapped around must not be mistaken for the answer to this command.
    while (next_ == 0 || next_ == applied_ || next_ == rejected_) ++next_;
    RegisterImage image(wanted_);
    static_cast<void>(image.write(map_.field(Commanded::commit), next_));
    return image;
}

void CommandTracker::sending(const RegisterImage& image) {
    const Field& number = map_.field(Commanded::commit);
    commit_ = static_cast<std::uint16_t>(image.read(number).value);
    next_ = static_cast<std::uint16_t>(commit_ + 1);
    standing_ = commit_;
    expect(commit_);
    last_ = image;
    static_cast<void>(last_.write(number, 0.0));
    resend_ = false;
    // For a command that replaces an unanswered one, the waiting time counts from the earlier one.
    if (answer_ != CommandState::pending) unanswered_at_ = wished_at_;
    answer_ = CommandState::pending;
    wished_at_ = newest_at_;
}

bool CommandTracker::foreign(std::uint16_t number, std::uint16_t before) const {
    return looked_ && number != before && number != 0 && std::find(unanswered_.begin(), unanswered_.end(), number) == unanswered_.end();
}

void CommandTracker::expect(std::uint16_t number) {
    // More than a PLC can lag behind and still confirm in time.
    constexpr std::size_t kMaxUnanswered = 64;
    unanswered_.push_back(number);
    if (unanswered_.size() > kMaxUnanswered) unanswered_.pop_front();
}

/// Takes a number that is ours: earlier ones can no longer be answered, because a PLC handles only the newest; if they appear later, they are
/// foreign.
void CommandTracker::answered(std::uint16_t number) {
    const auto found = std::find(unanswered_.begin(), unanswered_.end(), number);
    if (found != unanswered_.end()) unanswered_.erase(unanswered_.begin(), found + 1);
}

void CommandTracker::count_foreign(std::uint16_t number) {
    ++foreign_;
    foreign_commit_ = number;
    standing_ = number;
}

void CommandTracker::register_holds(std::uint16_t commit) {
    if (commit == standing_ || commit == commit_ || commit == 0) return;
    count_foreign(commit);
    expect(commit);  // the PLC's answer to it must not count as a second command
}

void CommandTracker::seen(std::uint16_t applied, std::uint16_t rejected, ClockTime now) {
    const bool applies = foreign(applied, applied_), rejects = foreign(rejected, rejected_);
    if (applies || rejects) {
        count_foreign(applies ? applied : rejected);
        if (any_ && !resend_ && wanted_ == last_) wished_at_ = now;
        resend_ = any_;
    }
    looked_ = true;
    answered(applied);
    answered(rejected);
    applied_ = applied;
    rejected_ = rejected;
    if (answer_ != CommandState::pending) return;
    if (applied == commit_) answer_ = CommandState::applied;
    if (rejected == commit_) answer_ = CommandState::rejected;
}

CommandState CommandTracker::state() const {
    if (!error_.empty()) return CommandState::unsendable;
    if (!any_) return CommandState::none;
    return resend_ || wanted_ != last_ ? CommandState::pending : answer_;
}

double CommandTracker::pending_s(ClockTime now) const {
    if (state() != CommandState::pending) return 0.0;
    const ClockTime since = answer_ == CommandState::pending ? unanswered_at_ : wished_at_;
    return std::chrono::duration<double>(now - since).count();
}

}  // namespace rig::modbus
