/// Problems of a bus log, by kind and line: all are counted, the first few of each kind are reported.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace rig::replay {

enum class LogTrouble : std::uint8_t {
    malformed_line,   ///< not a candump line; not used
    unfinished_line,  ///< the last line has no line end: the writer may have been interrupted
    long_line,        ///< longer than any candump line; not used
    not_text,         ///< bytes that are no UTF-8, or control characters; not used
    fd_frame,         ///< CAN FD; not used
    error_frame,      ///< reported by the CAN controller that recorded
    remote_frame,
    extended_frame,   ///< 29-bit identifier
    foreign_id,       ///< an identifier that the layout does not have
    other_interface,  ///< a line of another interface than the one that is read; not used
    time_backwards,   ///< older than the line before
    damaged_file,     ///< gzip data truncated or corrupt, or a read error; what came before is used
};
inline constexpr std::size_t kLogTroubleCount = 12;

/// The name in the enumeration: "malformed_line".
[[nodiscard]] std::string_view name(LogTrouble trouble);

class LogWarnings {
  public:
    /// Takes one line of text without its end.
    using Sink = std::function<void(const std::string&)>;

    /// `said_of_each`: number of reports to `sink` for each kind.
    LogWarnings(std::string file, Sink sink, std::uint64_t said_of_each = 3);

    /// "bus.log:12: malformed_line: column 3: expected the time ..."; `detail` may contain any bytes and is made printable.
    void add(LogTrouble trouble, std::uint64_t line, std::string_view detail);
    /// `detail`: a function returning the text, called only if it will be reported.
    template <std::invocable Detail>
    void add(LogTrouble trouble, std::uint64_t line, Detail detail) {
        if (said(trouble) < said_of_each_)
            add(trouble, line, std::string_view(detail()));
        else
            count_only(trouble);
    }
    /// Counts without reporting.
    void count_only(LogTrouble trouble) { ++counts_[static_cast<std::size_t>(trouble)]; }

    [[nodiscard]] std::uint64_t count(LogTrouble trouble) const { return counts_[static_cast<std::size_t>(trouble)]; }
    [[nodiscard]] bool any() const;
    /// Warnings that show a damaged log, one per kind: "log_damaged: unfinished_line 1". A sector of zeros shows as a long line.
    [[nodiscard]] std::vector<std::string> damage() const;
    /// "malformed_line 12, foreign_id 40000", empty without warnings.
    [[nodiscard]] std::string summary() const;

  private:
    [[nodiscard]] std::uint64_t said(LogTrouble trouble) const { return said_[static_cast<std::size_t>(trouble)]; }

    std::string file_;
    Sink sink_;
    std::uint64_t said_of_each_;
    std::array<std::uint64_t, kLogTroubleCount> counts_{};
    std::array<std::uint64_t, kLogTroubleCount> said_{};
};

}  // namespace rig::replay
