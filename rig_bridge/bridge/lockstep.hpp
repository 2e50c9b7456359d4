/// Whose turn it is in lockstep, and what time it is: rig time, SYNC number times control period. The bridge's turn is each step of SYNC
/// periods, as soon as the controller has answered that SYNC; the rig waits for it. Pure: frames in, turns out.
///
/// A controller that does not answer in time is waited for once; a rig that sends no SYNC once, too: then time goes on as the machine's
/// does, so that time-outs end as they must.
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
    /// `layout` must outlive it and have a SYNC with a number. `step`: between two turns; `patience`: with who does not answer.
    Lockstep(const antiskid::can::Layout& layout, Time period, Time step, Time patience)
        : layout_(layout),
          period_(period),
          step_(step),
          patience_(patience),
          every_(static_cast<std::uint32_t>(std::max<std::int64_t>(step / period, 1))) {}

    /// Plain frames in the order of the bus.
    void hear(const antiskid::can::Frame& frame) {
        using antiskid::can::Role;
        if (frame.id == layout_[Role::sync].id) count_sync(antiskid::can::Payload(frame.data));
        if (frame.id != layout_[Role::valve].id) return;
        controller_answers_ = true;
        due_ = due_ || asked_;
    }

    [[nodiscard]] bool due() const { return due_; }
    /// The turn that is now over, for `bridge_turn`.
    std::uint16_t taken() {
        asked_ = due_ = false;
        return syncs_ == 0 ? kJoined : turn_number(number_, every_);
    }

    /// How long to wait for a turn that is not due, by the machine's clock.
    [[nodiscard]] Time patience() const {
        constexpr Time kStart{30'000'000'000};
        if (syncs_ == 0 && !alone_) return kStart;
        return alone_ ? step_ : patience_;
    }
    /// It was waited for in vain, `passed` since the last turn.
    void gave_up(Time passed) {
        if (asked_) {
            controller_answers_ = false;
        } else {
            alone_ = true;
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
        if (passed == 0) return;            // a rig that is not sure to be heard repeats its first
        if (passed > mask / 2) passed = 1;  // the rig counts anew
        now_ += static_cast<std::int64_t>(passed) * period_;
        syncs_ += passed;
        number_ = number;
        alone_ = false;
        asked_ = number % every_ == 0;
        due_ = asked_ && !controller_answers_;
    }

    const antiskid::can::Layout& layout_;
    Time period_;
    Time step_;
    Time patience_;
    std::uint32_t every_;
    Time now_{};
    std::uint64_t syncs_ = 0;
    std::uint32_t number_ = 0;
    bool asked_ = false;  // the newest SYNC asks for a turn
    bool due_ = false;
    bool controller_answers_ = true;
    bool alone_ = false;  // no SYNC comes
};

}  // namespace rig::bridge
