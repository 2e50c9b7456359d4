/// The checks that every received frame passes, the same on both sides: identifier, length, CRC, counter.
/// Freestanding.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/can/layout.hpp"
#include "firmware/can/message_stats.hpp"

namespace antiskid::can {

class FrameGate {
  public:
    /// Frames of the bound `roles` may pass. `layout` must outlive the gate.
    FrameGate(const Layout& layout, std::span<const Role> roles);

    struct Result {
        std::optional<Role> role;  ///< none: no identifier of ours
        bool ok = false;           ///< every check passed; not counted as accepted yet, the value is still to be judged
    };
    [[nodiscard]] Result check(const Frame& frame, const Payload& payload);

    void count_accepted(Role role) { ++stats_[static_cast<std::size_t>(role)].accepted; }
    void count_wrong_value(Role role) { ++stats_[static_cast<std::size_t>(role)].wrong_value; }
    [[nodiscard]] const MessageStats& stats(Role role) const { return stats_[static_cast<std::size_t>(role)]; }
    [[nodiscard]] std::uint32_t unknown_ids() const { return unknown_ids_; }

  private:
    static constexpr std::uint8_t kNobody = 0xFF;

    const Layout& layout_;
    std::array<std::uint8_t, 2048> role_of_{};
    std::array<E2eChecker, kRoleCount> checkers_{};
    std::array<MessageStats, kRoleCount> stats_{};
    std::uint32_t unknown_ids_ = 0;
};

}  // namespace antiskid::can
