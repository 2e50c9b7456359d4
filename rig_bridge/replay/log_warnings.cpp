#include "rig_bridge/replay/log_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace rig::replay {

namespace {

/// A message must not carry control characters or broken UTF-8 from a file to the terminal.
std::string printable(std::string_view text) {
    constexpr std::size_t kMax = 160;
    std::string out;
    for (const char c : text.substr(0, kMax)) {
        if (c >= ' ' && c <= '~')
            out.push_back(c);
        else
            fmt::format_to(std::back_inserter(out), "\\x{:02X}", static_cast<unsigned char>(c));
    }
    if (text.size() > kMax) out += "...";
    return out;
}

}  // namespace

std::string_view name(LogTrouble trouble) {
    constexpr std::array<std::string_view, kLogTroubleCount> kNames{"malformed_line", "unfinished_line", "long_line",      "not_text",
                                                                    "fd_frame",       "error_frame",     "remote_frame",   "extended_frame",
                                                                    "foreign_id",     "other_interface", "time_backwards", "damaged_file"};
    return kNames[static_cast<std::size_t>(trouble)];
}

LogWarnings::LogWarnings(std::string file, Sink sink, std::uint64_t said_of_each)
    : file_(std::move(file)), sink_(std::move(sink)), said_of_each_(said_of_each) {}

void LogWarnings::add(LogTrouble trouble, std::uint64_t line, std::string_view detail) {
    if (said(trouble) < said_of_each_ && sink_) {
        const bool last = ++said_[static_cast<std::size_t>(trouble)] == said_of_each_;
        sink_(fmt::format("{}:{}: {}: {}{}", file_, line, name(trouble), printable(detail), last ? " (more of this kind are only counted)" : ""));
    }
    count_only(trouble);
}

bool LogWarnings::any() const {
    return std::any_of(counts_.begin(), counts_.end(), [](std::uint64_t n) { return n != 0; });
}

std::vector<std::string> LogWarnings::damage() const {
    std::vector<std::string> all;
    constexpr std::array kDamage{LogTrouble::unfinished_line, LogTrouble::malformed_line, LogTrouble::not_text, LogTrouble::long_line,
                                 LogTrouble::damaged_file};
    for (const LogTrouble trouble : kDamage)
        if (const std::uint64_t n = count(trouble); n != 0) all.push_back(fmt::format("log_damaged: {} {}", name(trouble), n));
    return all;
}

std::string LogWarnings::summary() const {
    std::string text;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        if (counts_[i] == 0) continue;
        fmt::format_to(std::back_inserter(text), "{}{} {}", text.empty() ? "" : ", ", name(static_cast<LogTrouble>(i)), counts_[i]);
    }
    return text;
}

}  // namespace rig::replay
