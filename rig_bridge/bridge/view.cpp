#include "rig_bridge/bridge/view.hpp"

#include <fmt/format.h>

#include <cmath>

#include "firmware/host/settings/progress.hpp"
#include "rig_bridge/record/summary.hpp"

namespace rig::bridge {

using rig::Abort;
using rig::Phase;

namespace {

constexpr std::size_t kBar = 24;

/// How much of the phase's speed change is done; phases without one show nothing.
double share(const ViewModel& v) {
    if (!(v.prescribed_mps > 0.0)) return 0.0;
    if (v.phase == Phase::spin_up) return v.rim_mps / v.prescribed_mps;
    if (v.phase == Phase::braking) return 1.0 - v.rim_mps / v.prescribed_mps;
    return v.phase > Phase::braking && v.phase <= Phase::finished ? 1.0 : 0.0;
}

std::string abort_text(const ViewModel& v) {
    if (v.abort == Abort::none) return {};
    return fmt::format("  ABORT {}", v.record_lost ? record::kRecordLost : name(v.abort));
}

std::string campaign_text(const CampaignView& c) {
    const double done = c.planned > 0 ? static_cast<double>(c.finished) / static_cast<double>(c.planned) : 0.0;
    const std::string left = c.left_s ? duration_text(*c.left_s) + " left" : std::string("time left unknown");
    return fmt::format("maneuver {}  [{}] {} of {} finished, {}", c.number, settings::bar(done, kBar), c.finished, c.planned, left);
}

}  // namespace

std::string fault_text(const std::vector<std::string>& faults) {
    return faults.empty() ? "none" : fmt::format("{}", fmt::join(faults, " "));
}

std::string duration_text(double seconds) {
    constexpr double kMax = 3.6e8;  // what nobody waits for
    if (!std::isfinite(seconds) || seconds < 0.0 || seconds > kMax) return "?";
    const auto s = static_cast<std::int64_t>(std::llround(seconds));
    if (s < 60) return fmt::format("{} s", s);
    if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
    return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
}

std::string health_text(const record::Health& health) {
    std::string text = name(health.state);
    if (std::isfinite(health.statistic)) text += fmt::format(" ({:.2f} of its limit)", health.statistic);
    if (!health.reason.empty()) text += ": " + health.reason;
    return text;
}

std::string fit(std::string_view line, std::size_t columns) {
    std::size_t width = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const bool begins = (static_cast<unsigned char>(line[i]) & 0xC0U) != 0x80U;
        if (begins && width++ == columns) return std::string(line.substr(0, i));
    }
    return std::string(line);
}

std::vector<std::string> screen(const ViewModel& v, std::size_t columns) {
    std::vector<std::string> lines;
    lines.push_back(v.campaign ? fmt::format("{}  {}", v.scenario, campaign_text(*v.campaign)) : v.scenario);
    if (v.campaign && !v.campaign->regulation.empty()) lines.push_back(v.campaign->regulation);
    lines.push_back(fmt::format("{:<10} {:7.2f} s  [{}]  {:.1f} s in this phase{}", name(v.phase), v.time_s, settings::bar(share(v), kBar), v.phase_s,
                                abort_text(v)));
    lines.push_back(fmt::format("rim {:6.2f} m/s   wheel {:6.2f} m/s   slip {:6.3f}", v.rim_mps, v.wheel_mps, v.slip));
    lines.push_back(fmt::format("pressure {:5.2f} MPa   load {:6.2f} kN   torque {:6.2f} kN m   brake {:5.1f} °C", v.pressure_Pa * 1e-6,
                                v.load_N * 1e-3, v.torque_Nm * 1e-3, v.temperature_C));
    lines.push_back(fmt::format("controller {:<20}  PLC {:<10}  bus {:<4}  {} frames, {} dropped", v.controller, v.plc, v.bus, v.frames, v.dropped));
    lines.push_back(fmt::format("faults: {}{}{}", fault_text(v.faults), v.note.empty() ? "" : "   ", v.note));
    if (v.campaign && !v.campaign->health.empty()) lines.push_back("brake " + v.campaign->health);
    for (std::string& line : lines) line = fit(line, columns);
    return lines;
}

std::string plain_line(const ViewModel& v) {
    std::string line =
        fmt::format("{:8.2f} s {:<10} {:6.2f} m/s  slip {:6.3f}  {:5.2f} MPa  {:6.2f} kN  {:5.1f} degC  controller {}, PLC {}, bus {}", v.time_s,
                    name(v.phase), v.rim_mps, v.slip, v.pressure_Pa * 1e-6, v.load_N * 1e-3, v.temperature_C, v.controller, v.plc, v.bus);
    line += abort_text(v);
    if (!v.faults.empty()) line += "  faults: " + fault_text(v.faults);
    if (!v.note.empty()) line += "  " + v.note;
    if (v.campaign)
        line += "  " + fmt::format("[{} of {}, {}]", v.campaign->number, v.campaign->planned,
                                   v.campaign->left_s ? duration_text(*v.campaign->left_s) + " left" : "time left unknown");
    if (v.campaign && !v.campaign->health.empty()) line += "  brake " + v.campaign->health;
    return line;
}

}  // namespace rig::bridge
