/// Which messages each side receives: the identifiers to filter for.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/can/layout.hpp"

namespace antiskid::can {

/// Roles that the controller receives; load cells are not among them.
inline constexpr std::array kToController{Role::wheel,    Role::flywheel,      Role::pressure,
                                          Role::maneuver, Role::rig_heartbeat, Role::emergency_stop,
                                          Role::sync};
inline constexpr std::array kToRig{Role::valve, Role::status, Role::faults, Role::controller_heartbeat};

/// A fixed list of identifiers.
class IdList {
  public:
    constexpr void add(std::uint16_t id) { ids_[count_++] = id; }
    [[nodiscard]] constexpr std::span<const std::uint16_t> span() const { return {ids_.data(), count_}; }

  private:
    std::array<std::uint16_t, kRoleCount> ids_{};
    std::size_t count_ = 0;
};

/// The bound identifiers of `roles`, e.g. kToController.
[[nodiscard]] constexpr IdList ids(const Layout& layout, std::span<const Role> roles) {
    IdList list;
    for (const Role role : roles) {
        if (layout[role].bound) list.add(layout[role].id);
    }
    return list;
}

}  // namespace antiskid::can
