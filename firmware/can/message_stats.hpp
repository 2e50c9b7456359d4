/// What became of the frames of one message. Every count is since start and rolls over.
#pragma once

#include <cstdint>

namespace antiskid::can {

struct MessageStats {
    std::uint32_t accepted = 0;
    std::uint32_t wrong_crc = 0;
    std::uint32_t wrong_counter = 0;  ///< repeated or out of order
    std::uint32_t wrong_length = 0;
    std::uint32_t wrong_value = 0;  ///< a code that has no meaning: an unknown law or state
    std::uint32_t lost = 0;         ///< missing before an accepted frame, as its counter says

    [[nodiscard]] constexpr std::uint32_t rejected() const { return wrong_crc + wrong_counter + wrong_length + wrong_value; }
};

}  // namespace antiskid::can
