/// Which messages each side sends and receives.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/can/layout.hpp"

namespace antiskid::can {

/// Roles that the controller receives; load cells and maneuver state are not among them.
inline constexpr std::array kToController{Role::wheel,         Role::flywheel,       Role::pressure, Role::maneuver,
                                          Role::rig_heartbeat, Role::emergency_stop, Role::sync};
inline constexpr std::array kToRig{Role::valve, Role::status, Role::faults, Role::road, Role::controller_heartbeat};

/// What a rig without a bridge sends; SYNC is sent separately.
inline constexpr std::array kFromRig{Role::wheel,         Role::flywheel,       Role::pressure,  Role::maneuver,
                                     Role::rig_heartbeat, Role::emergency_stop, Role::load_cells};
/// The same messages, divided between the rig's sensors and the rig bridge.
inline constexpr std::array kFromRigSensors{Role::wheel, Role::flywheel, Role::pressure};
inline constexpr std::array kFromBridge{Role::maneuver, Role::rig_heartbeat, Role::emergency_stop, Role::load_cells, Role::maneuver_state};

inline constexpr std::array<Role, kRoleCount> kEveryRole = [] {
    std::array<Role, kRoleCount> roles{};
    for (std::size_t i = 0; i < kRoleCount; ++i) roles[i] = static_cast<Role>(i);
    return roles;
}();

/// A fixed list of identifiers.
class IdList {
  public:
    constexpr void add(std::uint16_t id) { ids_[count_++] = id; }
    [[nodiscard]] constexpr std::span<const std::uint16_t> span() const { return {ids_.data(), count_}; }

  private:
    std::array<std::uint16_t, kRoleCount> ids_{};
    std::size_t count_ = 0;
};

/// Identifiers of those of `roles` that the layout binds.
[[nodiscard]] constexpr IdList ids(const Layout& layout, std::span<const Role> roles) {
    IdList list;
    for (const Role role : roles) {
        if (layout[role].bound) list.add(layout[role].id);
    }
    return list;
}

}  // namespace antiskid::can
