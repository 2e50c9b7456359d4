/// The part of a DBC file that a layout needs: messages, signals, units, value tables, cycle times, comments.
///
/// Read: BO_, SG_, VAL_, CM_, BA_ "GenMsgCycleTime", SIG_VALTYPE_. Everything else is skipped. A malformed statement of these kinds is refused with
/// file and line. Unusual content (29-bit identifiers, FD lengths, multiplexing, floats, fields that overlap or exceed the payload, references to
/// unknown messages) is read; the user of the signal must check it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace antiskid::can {

struct DbcSignal {
    std::string name;
    std::uint32_t line = 0;   ///< of its SG_ statement, from 1
    std::uint32_t start = 0;  ///< as written: least significant bit in Intel order, most significant in Motorola
    std::uint32_t bits = 0;   ///< 1 to 64
    bool big_endian = false;
    bool is_signed = false;
    bool floating = false;     ///< IEEE 754 by SIG_VALTYPE_
    std::string multiplexing;  ///< "M", "m3", "m3M"; empty for a plain signal
    double factor = 1.0;
    double offset = 0.0;
    double min = 0.0;  ///< min == max: no range given
    double max = 0.0;
    std::string unit;
    std::string comment;
    std::map<std::int64_t, std::string> values;
};

struct DbcMessage {
    std::string name;
    std::uint32_t line = 0;
    std::uint32_t id = 0;  ///< without the extended flag
    bool extended = false;
    std::uint32_t length = 0;  ///< bytes
    std::string sender;
    std::optional<double> cycle_time_ms;  ///< GenMsgCycleTime; none when absent or 0
    std::string comment;
    std::vector<DbcSignal> signals;
};

struct Dbc {
    std::string file;
    std::vector<DbcMessage> messages;
};

/// Throws settings::Error naming file and line.
[[nodiscard]] Dbc load_dbc(const std::filesystem::path& path);
/// The same from memory; `file` is the name used in error messages.
[[nodiscard]] Dbc parse_dbc(std::string_view text, std::string file);

}  // namespace antiskid::can
