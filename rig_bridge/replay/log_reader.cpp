#include "rig_bridge/replay/log_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <variant>

#include "firmware/can/candump.hpp"
#include "firmware/host/seconds.hpp"

namespace rig::replay {

using antiskid::host::seconds;

namespace {

using antiskid::can::CandumpFailure;
using antiskid::can::CandumpLine;

/// Whether the line has only characters of a candump line; a carriage return may end it.
bool is_text(std::string_view line) {
    return std::all_of(line.begin(), line.end(), [](char c) { return (c >= ' ' && c <= '~') || c == '\r' || c == '\t'; });
}

std::unique_ptr<ForeignLog> open_foreign(const std::filesystem::path& file) {
    reject_mdf(file);
    const LogFormat format = log_format(file);
    return format == LogFormat::candump ? nullptr : std::make_unique<ForeignLog>(file, format);
}

std::bitset<2048> bound_messages(const LogOptions& options) {
    std::bitset<2048> known;
    if (options.layout == nullptr) return known;
    for (const antiskid::can::Message& message : options.layout->messages)
        if (message.bound) known.set(message.id);
    return known;
}

}  // namespace

LogReader::LogReader(const std::filesystem::path& file, const LogOptions& options, LogWarnings& warnings)
    : foreign_(open_foreign(file)),
      source_(foreign_ ? LineSource(foreign_->lines()) : LineSource(file)),
      warnings_(warnings),
      interface_(options.interface.value_or("")),
      with_layout_(options.layout != nullptr),
      known_(bound_messages(options)) {}

LogReader::LogReader(LogText text, const LogOptions& options, LogWarnings& warnings)
    : source_(text),
      warnings_(warnings),
      interface_(options.interface.value_or("")),
      with_layout_(options.layout != nullptr),
      known_(bound_messages(options)) {}

bool LogReader::next(LogFrame& out) {
    LineSource::Line line;
    while (source_.next(line)) {
        if (!take(line, out)) continue;
        ++frames_;
        return true;
    }
    if (!end_said_) say_end();
    end_said_ = true;
    return false;
}

void LogReader::say_end() {
    if (!source_.damage().empty()) warnings_.add(LogTrouble::damaged_file, source_.lines(), source_.damage());
    if (!foreign_) return;
    const ForeignLog::End end = foreign_->finish();
    if (end.damaged || !end.text.empty())
        warnings_.add(end.damaged ? LogTrouble::damaged_file : LogTrouble::malformed_line, source_.lines(), end.text);
}

bool LogReader::take(const LineSource::Line& line, LogFrame& out) {
    if (line.too_long) {
        warnings_.add(LogTrouble::long_line, line.number, line.text.substr(0, 60));
        return false;
    }
    const auto parsed = antiskid::can::parse_candump(line.text);
    const auto* const content = std::get_if<CandumpLine>(&parsed);
    if (content == nullptr) {
        reject(line, std::get<CandumpFailure>(parsed));
        return false;
    }
    if (!line.ended) warnings_.add(LogTrouble::unfinished_line, line.number, "the file ends without a line end, the frame may be cut off");
    if (content->interface != interface_ && !is_ours(line, content->interface)) return false;
    if (content->time < newest_)
        warnings_.add(LogTrouble::time_backwards, line.number, [&] { return fmt::format("by {:.6f} s", seconds(newest_ - content->time)); });
    newest_ = content->time;
    out = {.line = line.number, .frame = content->frame, .extended = content->extended, .remote = content->remote, .error = content->error};
    const bool plain = !(out.extended || out.remote || out.error);
    if (plain && (!with_layout_ || known_[out.frame.id])) return true;
    return unusual(out);
}

void LogReader::reject(const LineSource::Line& line, const CandumpFailure& failure) {
    if (!is_text(line.text))
        warnings_.add(LogTrouble::not_text, line.number, line.text);
    else if (failure.fd)
        warnings_.add(LogTrouble::fd_frame, line.number, line.text);
    else
        warnings_.add(LogTrouble::malformed_line, line.number,
                      [&] { return fmt::format("column {}: {}: {}", failure.column, failure.what, line.text); });
}

bool LogReader::is_ours(const LineSource::Line& line, std::string_view interface) {
    constexpr std::size_t kLongestName = 15;  // of a network interface in Linux
    if (!is_text(interface) || interface.size() > kLongestName) {
        warnings_.add(LogTrouble::not_text, line.number, line.text);
        return false;
    }
    if (interface_.empty()) {
        interface_ = interface;
        return true;
    }
    warnings_.add(LogTrouble::other_interface, line.number, [&] { return fmt::format("{}; read is {}", interface, interface_); });
    return false;
}

bool LogReader::unusual(const LogFrame& f) {
    const auto say = [&](LogTrouble trouble) { warnings_.add(trouble, f.line, [&] { return fmt::format("identifier {:03X}", f.frame.id); }); };
    if (f.error)
        say(LogTrouble::error_frame);
    else if (f.extended)
        say(LogTrouble::extended_frame);
    else if (f.remote)
        say(LogTrouble::remote_frame);
    else if (said_[f.frame.id])
        warnings_.count_only(LogTrouble::foreign_id);
    else
        say(LogTrouble::foreign_id);
    if (!f.error && !f.extended) said_.set(f.frame.id);
    return !with_layout_;
}

}  // namespace rig::replay
