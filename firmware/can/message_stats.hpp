/// Counts of the received frames of one message, from start; they roll over at 2^32.
#pragma once

#include <cstdint>

namespace antiskid::can {

struct MessageStats {
    std::uint32_t accepted = 0;
    std::uint32_t wrong_crc = 0;
    std::uint32_t wrong_counter = 0;  ///< repeated or out of order
    std::uint32_t wrong_length = 0;
    std::uint32_t wrong_value = 0;  ///< an undefined code, e.g. of law or state
    std::uint32_t lost = 0;         ///< missing before accepted frames, by the alive counter

    [[nodiscard]] constexpr std::uint32_t rejected() const { return wrong_crc + wrong_counter + wrong_length + wrong_value; }
};

}  // namespace antiskid::can
