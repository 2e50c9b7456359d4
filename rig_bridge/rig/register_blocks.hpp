/// Groups fields into read and write requests.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rig_bridge/rig/register_map.hpp"

namespace rig {

inline constexpr std::uint16_t kMaxRead = 125;   ///< registers in one read request, Modbus V1.1b3 6.3, 6.4
inline constexpr std::uint16_t kMaxWrite = 123;  ///< in one write request, 6.12

struct Block {
    std::uint16_t address = 0;
    std::uint16_t count = 0;
    friend bool operator==(const Block&, const Block&) = default;
};

/// The fewest blocks, by address, that cover exactly the fields' registers. No block exceeds `max` registers, no field is split.
[[nodiscard]] std::vector<Block> blocks_of(std::span<const Field> fields, std::uint16_t max);

}  // namespace rig
