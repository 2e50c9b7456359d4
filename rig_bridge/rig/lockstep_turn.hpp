/// What a bridge in lockstep writes into `bridge_turn` of a virtual PLC: up to which SYNC it has read, decided, written and sent. The rig
/// waits for that number before its time goes on, so that a run does not depend on how fast anybody is.
#pragma once

#include <cstdint>

namespace rig {

inline constexpr std::uint16_t kNoTurns = 0;     ///< no bridge in lockstep: nobody waits
inline constexpr std::uint16_t kJoined = 65535;  ///< there, before its first turn

/// Of the SYNC with this number; `every`: periods between two turns, which come where the number is a multiple of it.
[[nodiscard]] constexpr std::uint16_t turn_number(std::uint32_t sync_number, std::uint32_t every) {
    constexpr std::uint32_t kTurns = 65534;
    return static_cast<std::uint16_t>(1 + sync_number / every % kTurns);
}

}  // namespace rig
