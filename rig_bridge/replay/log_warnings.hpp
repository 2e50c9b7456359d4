/// What is wrong with a bus log, by name and line: everything is counted, the first of each kind is said.
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
    malformed_line,   ///< no candump line; not used
    unfinished_line,  ///< the last line has no line end: the writer may have been cut off in it
    long_line,        ///< longer than any candump line; not used
    not_text,         ///< bytes that are no UTF-8, or control characters; not used
    fd_frame,         ///< CAN FD; not used
    error_frame,      ///< reported by the CAN controller that recorded
    remote_frame,
    extended_frame,   ///< 29-bit identifier
    foreign_id,       ///< an identifier that the layout does not have
    other_interface,  ///< a line of another interface than the one that is read; not used
    time_backwards,   ///< older than the line before
    damaged_file,     ///< gzip data that are cut off or corrupt, or a read error; what came before is used
};
inline constexpr std::size_t kLogTroubleCount = 12;

/// As in the enumeration: "malformed_line".
[[nodiscard]] std::string_view name(LogTrouble trouble);

class LogWarnings {
  public:
    /// Takes one line of text without its end.
    using Sink = std::function<void(const std::string&)>;

    /// `said_of_each`: how many of a kind go to `sink`.
    LogWarnings(std::string file, Sink sink, std::uint64_t said_of_each = 3);

    /// "bus.log:12: malformed_line: column 3: expected the time ..."; `detail` may hold anything, it is made printable.
    void add(LogTrouble trouble, std::uint64_t line, std::string_view detail);
    /// `detail`: a function without arguments that gives the text, called only where it will be said.
    template <std::invocable Detail>
    void add(LogTrouble trouble, std::uint64_t line, Detail detail) {
        if (said(trouble) < said_of_each_)
            add(trouble, line, std::string_view(detail()));
        else
            count_only(trouble);
    }
    /// One that was said before.
    void count_only(LogTrouble trouble) { ++counts_[static_cast<std::size_t>(trouble)]; }

    [[nodiscard]] std::uint64_t count(LogTrouble trouble) const { return counts_[static_cast<std::size_t>(trouble)]; }
    [[nodiscard]] bool any() const;
    /// What says that the log is not as its recorder wrote it: "log_damaged: unfinished_line 1", one each. A sector of zeros is a long line.
    [[nodiscard]] std::vector<std::string> damage() const;
    /// "malformed_line 12, foreign_id 40000", empty when there is nothing.
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
