/// Format of the input and output files of a run on the microcontroller: records of 16 bytes, little-endian, no padding. A Head, then for each period
/// its frames in bus order, followed by a step record.
#pragma once

#include <array>
#include <cstdint>

namespace antiskid::cortex_m {

struct Head {
    static constexpr std::uint64_t kMagic = 0x31'4C'49'50'4B'53'41'31ULL;  // "1ASKPIL1"
    std::uint64_t magic = kMagic;
    std::int64_t period_ns = 0;  ///< control period: step i happens at i periods
};

struct Record {
    enum class Kind : std::uint8_t { frame, step };
    std::uint16_t id = 0;  ///< 11-bit identifier; 0 with a step
    std::uint8_t length = 0;
    Kind kind = Kind::frame;
    std::uint32_t unused = 0;
    std::array<std::uint8_t, 8> data{};
};

static_assert(sizeof(Head) == 16 && sizeof(Record) == 16);
static_assert(std::has_unique_object_representations_v<Head> && std::has_unique_object_representations_v<Record>);

}  // namespace antiskid::cortex_m
