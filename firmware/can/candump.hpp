/// One line of a bus log in candump format (`candump -l`): (1436509053.650713) vcan0 123#DEADBEEF
///
/// Pure functions; format() does not allocate.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <variant>

#include "firmware/can/frame.hpp"

namespace antiskid::can {

struct CandumpLine {
    Time time{};                 ///< as written; microseconds in candump's own files
    std::string_view interface;  ///< points into the parsed text
    Frame frame;                 ///< `received` is `time`; id without flags
    bool extended = false;       ///< 29-bit identifier (eight digits)
    bool remote = false;         ///< `123#R`, `123#R8`
    bool error = false;          ///< error frame: identifier 20000000 and up
};

struct CandumpFailure {
    std::size_t column = 0;  ///< from 1
    const char* what = "";   ///< what would be right
    bool fd = false;         ///< a CAN FD frame, `123##1...`
};

/// A trailing ` R` or ` T` (direction, candump -x) and line end are accepted. CAN FD frames (`##`) are
/// refused.
[[nodiscard]] std::variant<CandumpLine, CandumpFailure> parse_candump(std::string_view line);

/// Longest line that format() writes, without a line end.
inline constexpr std::size_t kCandumpLineMax = 80;

/// Writes `(sssssssssss.uuuuuu) interface 1A0#0011` to `out`; returns the number of characters, 0 if it does not fit (interface names have at most
/// 15) or `time`, truncated to microseconds, is none that parse_candump() takes: below 0 or above 9e9 s. Remote frames, error frames and 29-bit
/// identifiers are written as `candump -l` writes them.
[[nodiscard]] std::size_t format_candump(const CandumpLine& line, std::span<char> out);
/// The same for a data frame with an 11-bit identifier.
[[nodiscard]] std::size_t format_candump(Time time, std::string_view interface, const Frame& frame, std::span<char> out);

}  // namespace antiskid::can
