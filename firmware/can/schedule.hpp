/// Which cyclic messages are due at which step; shared by the ports and RoundedLink. Freestanding.
///
/// A message of period T is sent every floor(T / step) steps, at least every step. Slow messages start at different steps, which spreads them over
/// control periods; the maneuver command starts at step 0.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/can/layout.hpp"

namespace antiskid::can {

class Schedule {
  public:
    /// `step` > 0: the period of the calling program.
    Schedule(const Layout& layout, control::Time step);

    /// Whether the message is cyclic, bound and due at step `index`, counted from 0; when the count rolls over, slow messages shift once.
    [[nodiscard]] bool due(Role role, std::uint32_t index) const {
        const Slot& slot = slots_[static_cast<std::size_t>(role)];
        return slot.every == 1 || (slot.every != 0 && index % slot.every == slot.phase);
    }

  private:
    struct Slot {
        std::uint32_t every = 0;  ///< 0: never
        std::uint32_t phase = 0;
    };
    std::array<Slot, kRoleCount> slots_{};
};

}  // namespace antiskid::can
