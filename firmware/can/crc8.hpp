/// CRC-8/SAE-J1850: polynomial 1D, start FF, final exclusive or FF, no reflection. Freestanding.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace antiskid::can {

namespace detail {
inline constexpr std::array<std::uint8_t, 256> kCrc8Table = [] {
    std::array<std::uint8_t, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
        auto crc = static_cast<std::uint8_t>(i);
        for (int bit = 0; bit < 8; ++bit) {
            const unsigned shifted = static_cast<unsigned>(crc) << 1U;
            crc = static_cast<std::uint8_t>((crc & 0x80U) != 0U ? shifted ^ 0x1DU : shifted);
        }
        table[i] = crc;
    }
    return table;
}();
}  // namespace detail

/// A running CRC, for bytes that are not contiguous.
class Crc8 {
  public:
    constexpr void add(std::uint8_t byte) { register_ = detail::kCrc8Table[register_ ^ byte]; }
    [[nodiscard]] constexpr std::uint8_t value() const { return register_ ^ 0xFFU; }

  private:
    std::uint8_t register_ = 0xFF;
};

[[nodiscard]] constexpr std::uint8_t crc8(std::span<const std::uint8_t> bytes) {
    Crc8 crc;
    for (const std::uint8_t byte : bytes) crc.add(byte);
    return crc.value();
}

}  // namespace antiskid::can
