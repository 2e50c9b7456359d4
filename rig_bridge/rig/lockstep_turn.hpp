/// Values of a virtual PLC's register `bridge_turn`: the SYNC up to which a bridge in lockstep has finished its step. The rig waits for that number
/// before it advances time, so that a run does not depend on execution speed.
#pragma once

#include <cstdint>

namespace rig {

inline constexpr std::uint16_t kNoTurns = 0;     ///< no bridge in lockstep: the rig does not wait
inline constexpr std::uint16_t kJoined = 65535;  ///< the bridge is connected, before its first turn

/// Turn number of this SYNC; `every`: periods between two turns, which are due at its multiples.
[[nodiscard]] constexpr std::uint16_t turn_number(std::uint32_t sync_number, std::uint32_t every) {
    constexpr std::uint32_t kTurns = 65534;
    return static_cast<std::uint16_t>(1 + sync_number / every % kTurns);
}

}  // namespace rig
