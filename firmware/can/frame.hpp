/// One classic CAN data frame with the time it was received.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/control/types.hpp"

namespace antiskid::can {

using control::Time;

struct Frame {
    std::uint32_t id = 0;     ///< 11-bit identifier
    std::uint8_t length = 0;  ///< 0 to 8
    std::array<std::uint8_t, 8> data{};
    Time received{};  ///< receiver's monotonic clock; not part of the frame on the wire

    [[nodiscard]] std::span<const std::uint8_t> payload() const { return {data.data(), length}; }
};

}  // namespace antiskid::can
