/// Bus load, computed from the layout alone.
#pragma once

#include <cstdint>

#include "firmware/can/layout.hpp"

namespace antiskid::can {

/// Longest classic frame with an 11-bit identifier and `length` data bytes, in bit times: 44 + 8 n of frame,
/// one stuff bit after every four bits of the 34 + 8 n that are stuffed, the first needing five, and 3 of
/// interframe space (ISO 11898-1; Davis, Burns, Bril and Lukkien, 2007, eq. 1: 55 + 10 n).
[[nodiscard]] constexpr std::uint32_t worst_case_bits(std::uint32_t length) {
    const std::uint32_t stuffed = 34U + 8U * length;
    return 44U + 8U * length + (stuffed - 1U) / 4U + 3U;
}

struct BusLoad {
    double mean = 0.0;  ///< long-term share of the bit rate, 0 to 1, with worst-case bit stuffing
    double peak = 0.0;  ///< the same within the busiest control period, if rig and controller step together
};

/// Counts every cyclic message of `layout` at the control period `step`, and one SYNC per step if `with_sync`.
[[nodiscard]] BusLoad bus_load(const Layout& layout, control::Time step, std::uint32_t bitrate_bps, bool with_sync);

}  // namespace antiskid::can
