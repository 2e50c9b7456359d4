/// The bridge's turns and the time in lockstep: rig time, SYNC number times control period. The bridge's turn comes once per `step`, as soon as the
/// controller has answered that SYNC; the rig waits for the bridge. Pure: frames in, turns out.
///
/// A controller that does not answer in time is waited for only once, and so is a rig that sends no SYNC: time then follows the machine's clock, so
/// that time-outs still expire.
#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/can/layout.hpp"
#include "firmware/can/roles.hpp"
#include "rig_bridge/rig/lockstep_turn.hpp"

namespace rig::bridge {

class Lockstep {
  public:
    using Time = antiskid::can::Time;
    /// `layout` must outlive it and have a SYNC with a number. `step`: time between two turns; `answer_timeout`: longest wait for an answer, also
    /// that of the rig.
    Lockstep(const antiskid::can::Layout& layout, Time period, Time step, Time answer_timeout)
        : layout_(layout),
          period_(period),
          step_(step),
          answer_timeout_(answer_timeout),
          every_(static_cast<std::uint32_t>(std::max<std::int64_t>(step / period, 1))) {}

    /// Takes plain data frames in bus order.
    void accept(const antiskid::can::Frame& frame) {
        using antiskid::can::Role;
        if (frame.id == layout_[Role::sync].id) count_sync(antiskid::can::Payload(frame.data));
        if (frame.id != layout_[Role::valve].id) return;
        controller_answers_ = true;
        due_ = due_ || turn_requested_;
    }

    [[nodiscard]] bool due() const { return due_; }
    /// Ends the turn; returns its number for the register `bridge_turn`.
    std::uint16_t end_turn() {
        turn_requested_ = due_ = false;
        return syncs_ == 0 ? kJoined : turn_number(number_, every_);
    }

    /// Time in which the next turn certainly does not come, as the rig is not faster than real time; 0 if that is unknown.
    [[nodiscard]] Time quiet() const {
        if (syncs_ == 0 || sync_missing_ || turn_requested_ || due_) return Time{};
        return static_cast<std::int64_t>(every_ - number_ % every_ - 1) * period_;
    }
    /// Longest wait for the next turn, by the machine's clock.
    [[nodiscard]] Time max_wait() const {
        constexpr Time kStart{30'000'000'000};
        if (syncs_ == 0 && !sync_missing_) return kStart;
        if (sync_missing_) return step_;
        return turn_requested_ ? answer_timeout_ : 2 * answer_timeout_;  // a rig that waits for the controller sends no SYNC and is not silent
    }
    /// Call if the wait timed out, `passed` after the last turn.
    void timed_out(Time passed) {
        if (turn_requested_) {
            controller_answers_ = false;
        } else {
            sync_missing_ = true;
            now_ += passed;
        }
        due_ = true;
    }

    [[nodiscard]] Time now() const { return now_; }
    [[nodiscard]] std::uint64_t syncs() const { return syncs_; }

  private:
    void count_sync(const antiskid::can::Payload& payload) {
        const auto number = static_cast<std::uint32_t>(payload.read(layout_.sync_counter));
        const auto mask = static_cast<std::uint32_t>(layout_.sync_counter.mask());
        std::uint32_t passed = syncs_ == 0 ? 1 : (number - number_) & mask;
        if (passed == 0) return;            // the rig repeats its first SYNC until it is answered
        if (passed > mask / 2) passed = 1;  // the rig has restarted its count
        // A rig that has given this bridge up does not wait: a turn that it missed is due at once, or it would miss each of them.
        due_ = due_ || (syncs_ > 0 && (turn_requested_ || number / every_ != number_ / every_) && number % every_ != 0);
        now_ += static_cast<std::int64_t>(passed) * period_;
        syncs_ += passed;
        number_ = number;
        sync_missing_ = false;
        turn_requested_ = number % every_ == 0;
        due_ = due_ || (turn_requested_ && !controller_answers_);
    }

    const antiskid::can::Layout& layout_;
    Time period_;
    Time step_;
    Time answer_timeout_;
    std::uint32_t every_;
    Time now_{};
    std::uint64_t syncs_ = 0;
    std::uint32_t number_ = 0;
    bool turn_requested_ = false;  // the newest SYNC asks for a turn
    bool due_ = false;
    bool controller_answers_ = true;
    bool sync_missing_ = false;  // no SYNC arrives
};

}  // namespace rig::bridge
