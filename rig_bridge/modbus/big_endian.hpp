#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace rig::modbus {

/// The 16-bit word that begins at byte `at`, high byte first, as Modbus sends every address, count and register. Needs at + 1 < bytes.size().
[[nodiscard]] inline unsigned word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
    return static_cast<unsigned>(bytes[at]) << 8U | bytes[at + 1];
}

}  // namespace rig::modbus
