#include <fmt/format.h>

#include <array>
#include <iterator>
#include <nlohmann/json.hpp>

#include "rig_bridge/replay/player.hpp"

namespace rig::replay {

namespace {

double us(Time time) {
    return static_cast<double>(time.count()) * 1e-3;
}

double in_seconds(Time time) {
    return static_cast<double>(time.count()) * 1e-9;
}

struct Percentile {
    const char* name;
    double fraction;
};
constexpr std::array kPercentiles{Percentile{"p50", 0.5}, Percentile{"p90", 0.9}, Percentile{"p99", 0.99}, Percentile{"p99_9", 0.999}};

}  // namespace

std::string to_text(const PlayReport& r) {
    std::string text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{} frames sent in {:.3f} s", r.sent, in_seconds(r.duration));
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
    nlohmann::ordered_json late{{"count", r.late.count()}, {"min_ns", r.late.minimum().count()}, {"mean_ns", r.late.mean_ns()}};
    for (const Percentile& p : kPercentiles) late[std::string(p.name) + "_ns"] = r.late.percentile(p.fraction).count();
    late["max_ns"] = r.late.maximum().count();
    const nlohmann::ordered_json root{{"log", log},
                                      {"interface", interface},
                                      {"version", ANTISKID_VERSION},
                                      {"frames_sent", r.sent},
                                      {"frames_unsent", r.unsent},
                                      {"frames_filtered", r.filtered},
                                      {"error_frames", r.error_frames},
                                      {"loops", r.loops},
                                      {"stopped", r.stopped},
                                      {"duration_s", in_seconds(r.duration)},
                                      {"late", late}};
    return root.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace rig::replay
