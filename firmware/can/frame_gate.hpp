/// Checks of a received frame, the same for rig and controller: identifier, length, CRC, counter. Freestanding.
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
    /// Accepts frames of those `roles` that the layout binds. `layout` must outlive the gate.
    FrameGate(const Layout& layout, std::span<const Role> roles);

    struct Result {
        std::optional<Role> role;  ///< none: the identifier is not one of `roles`
        bool ok = false;           ///< every check passed; the caller decodes the value and then calls one of the count_ functions
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
