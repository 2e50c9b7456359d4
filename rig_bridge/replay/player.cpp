#include "rig_bridge/replay/player.hpp"
#include "firmware/host/seconds.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/number_in.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>
#include <optional>
#include <stdexcept>

namespace rig::replay {

using antiskid::host::seconds;

namespace {

constexpr Time kSlice = std::chrono::milliseconds{50};  // longest sleep before the next check for a stop

class Player {
  public:
    Player(const PlayOptions& options, FrameSender& sender, antiskid::host::Clock& clock, const std::atomic<bool>& stop, PlayReport& report)
        : options_(options), sender_(sender), clock_(clock), stop_(stop), report_(report) {}

    /// False: stopped.
    bool loop(LogReader& log) {
        anchored_ = false;
        for (LogFrame frame; log.next(frame);) {
            if (frame.error) {
                ++report_.error_frames;
                continue;
            }
            if (!options_.filter.passes(frame)) {
                ++report_.filtered;
                continue;
            }
            if (!send_at(deadline(frame.frame.received), frame)) return false;
        }
        ++report_.loops;
        return true;
    }

  private:
    [[nodiscard]] Time deadline(Time in_log) {
        if (!started_) {
            started_ = true;
            first_ = deadline_ = clock_.now();
        }
        if (!anchored_ || in_log < newest_) {
            anchored_ = true;
            log_base_ = in_log;
            clock_base_ = deadline_;
        }
        newest_ = in_log;
        const double since_ns = static_cast<double>((in_log - log_base_).count()) / options_.speed;
        deadline_ = clock_base_ + Time{static_cast<std::int64_t>(since_ns)};
        return deadline_;
    }

    bool send_at(Time deadline, const LogFrame& frame) {
        Time now = clock_.now();
        while (now < deadline && !stop_) {
            clock_.sleep_until(std::min(deadline, now + kSlice));
            now = clock_.now();
        }
        if (stop_) return false;
        report_.late.add(now - deadline);
        ++(sender_.send(frame) ? report_.sent : report_.unsent);
        report_.duration = now - first_;
        return true;
    }

    const PlayOptions& options_;
    FrameSender& sender_;
    antiskid::host::Clock& clock_;
    const std::atomic<bool>& stop_;
    PlayReport& report_;
    bool started_ = false;
    Time first_{}, deadline_{}, clock_base_{};
    Time log_base_{}, newest_{};
    bool anchored_ = false;  // within the loop
};

double us(Time time) {
    return static_cast<double>(time.count()) * 1e-3;
}

struct Percentile {
    const char* name;
    double fraction;
};
constexpr std::array kPercentiles{Percentile{"p50", 0.5}, Percentile{"p90", 0.9}, Percentile{"p99", 0.99}, Percentile{"p99_9", 0.999}};

std::optional<std::uint32_t> hexadecimal(std::string_view text) {
    return settings::number_in<std::uint32_t>(text, 16);
}

}  // namespace

void play(const OpenLog& open, const PlayOptions& options, FrameSender& sender, antiskid::host::Clock& clock, const std::atomic<bool>& stop,
          PlayReport& report) {
    Player player(options, sender, clock, stop, report);
    for (std::uint64_t i = 0; options.loops == 0 || i < options.loops; ++i) {
        const std::uint64_t before = report.sent + report.unsent;
        if (!player.loop(*open())) {
            report.stopped = true;
            return;
        }
        if (report.sent + report.unsent == before) return;  // nothing to play: do not loop for ever
    }
}

std::string to_text(const PlayReport& r) {
    std::string text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{} frames sent in {:.3f} s", r.sent, seconds(r.duration));
    if (r.loops > 1) fmt::format_to(out, ", {} loops", r.loops);
    if (r.unsent > 0) fmt::format_to(out, ", {} given up (queue full)", r.unsent);
    if (r.filtered > 0) fmt::format_to(out, ", {} kept back by the filter", r.filtered);
    if (r.error_frames > 0) fmt::format_to(out, ", {} error frames not sent", r.error_frames);
    fmt::format_to(out, "\nlate by, us: min {:.1f}", us(r.late.minimum()));
    for (const Percentile& p : kPercentiles) fmt::format_to(out, ", {} {:.1f}", p.name, us(r.late.percentile(p.fraction)));
    fmt::format_to(out, ", max {:.1f}, mean {:.1f}\n", us(r.late.maximum()), r.late.mean_ns() * 1e-3);
    return text;
}

std::string to_json(const PlayReport& r, const std::string& log, const std::string& interface) {
    settings::Json late{{"count", r.late.count()}, {"min_ns", r.late.minimum().count()}, {"mean_ns", r.late.mean_ns()}};
    for (const Percentile& p : kPercentiles) late[std::string(p.name) + "_ns"] = r.late.percentile(p.fraction).count();
    late["max_ns"] = r.late.maximum().count();
    const settings::Json root{{"log", log},
                              {"interface", interface},
                              {"version", ANTISKID_VERSION},
                              {"frames_sent", r.sent},
                              {"frames_unsent", r.unsent},
                              {"frames_filtered", r.filtered},
                              {"error_frames", r.error_frames},
                              {"loops", r.loops},
                              {"stopped", r.stopped},
                              {"duration_s", seconds(r.duration)},
                              {"late", late}};
    return settings::json_page(root);
}

void IdFilter::add(std::string_view rule) {
    const auto colon = rule.find(':');
    const std::string_view id_text = rule.substr(0, colon);
    const bool extended = id_text.size() == 8;
    const std::uint32_t all = extended ? 0x1FFFFFFFU : 0x7FFU;
    const auto id = hexadecimal(id_text);
    const auto mask = colon == std::string_view::npos ? all : hexadecimal(rule.substr(colon + 1));
    if ((id_text.size() != 3 && !extended) || !id || *id > all || !mask)
        throw std::invalid_argument(
            "--id " + std::string(rule) +
            ": expected an identifier of three or eight hexadecimal digits, with or without a mask, like 110, 100:7F0 or 18FF0000");
    rules_.push_back({*id, *mask & all, extended});
}

bool IdFilter::passes(const LogFrame& frame) const {
    return rules_.empty() || std::any_of(rules_.begin(), rules_.end(), [&](const Rule& rule) {
               return frame.extended == rule.extended && ((frame.frame.id ^ rule.id) & rule.mask) == 0;
           });
}

}  // namespace rig::replay
