#include "rig_bridge/bridge/watch_view.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>

#include <fmt/core.h>
#include <cmath>
#include <functional>

#include "firmware/host/settings/json.hpp"
#include "rig_bridge/bridge/view.hpp"

namespace rig::bridge {

namespace {

using Value = std::function<double(const StripSample&)>;

struct Curve {
    char mark;
    Value value;
};

struct Strip {
    const char* label;
    double min_top;             // no scale is finer than this
    std::vector<Curve> curves;  // a later one is drawn over an earlier one
};

/// 1, 2 or 5 times a power of ten, not below `value`.
double round_up(double value) {
    const double decade = std::pow(10.0, std::floor(std::log10(value)));
    for (const double step : {1.0, 2.0, 5.0})
        if (value <= step * decade * (1.0 + 1e-9)) return step * decade;
    return 10.0 * decade;
}

std::vector<std::string> draw(const Strip& strip, const std::deque<StripSample>& samples) {
    constexpr std::size_t kRows = StripChart::kRows;
    double top = strip.min_top;
    for (const StripSample& s : samples)
        for (const Curve& curve : strip.curves)
            if (const double v = curve.value(s); std::isfinite(v)) top = std::max(top, v);
    top = round_up(top);
    std::array<std::string, kRows> rows;
    rows.fill(std::string(StripChart::kColumns, ' '));
    for (const Curve& curve : strip.curves) {
        for (const StripSample& s : samples) {
            const double ago = (samples.back().time_s - s.time_s) / StripChart::kLength_s;
            const auto column = static_cast<std::size_t>((1.0 - ago) * (StripChart::kColumns - 1));
            const double value = curve.value(s);
            const double share = std::isfinite(value) ? std::clamp(value / top, 0.0, 1.0) : 0.0;
            const auto row = kRows - 1 - std::min<std::size_t>(static_cast<std::size_t>(share * kRows), kRows - 1);
            // One mark a column and curve: the newest.
            for (std::string& other : rows)
                if (other[column] == curve.mark) other[column] = ' ';
            rows[row][column] = curve.mark;
        }
    }
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < kRows; ++i) {
        const std::string scale = i == 0 ? fmt::format("{:g}", top) : i == kRows - 1 ? "0" : "";
        lines.push_back(fmt::format("{:<12}{:>5} |{}", i == 0 ? strip.label : "", scale, rows[i]));
    }
    return lines;
}

std::string phase_text(const WatchedCampaign& w) {
    return w.phase ? std::string(name(*w.phase)) : "phase unknown";
}

std::string progress(const WatchedCampaign& w) {
    const std::string number = w.number > 0 ? fmt::format("maneuver {}", w.number) : "no maneuver";
    if (w.campaign.empty()) return fmt::format("{}: {}", w.scenario, number);
    return fmt::format("{}: {}, {} of {} finished, {}", w.campaign, number, w.finished, w.planned,
                       w.left_s ? duration_text(*w.left_s) + " left" : "time left unknown");
}

std::string road_text(const WatchedCampaign& w) {
    if (!w.road) return "not heard";
    return fmt::format("grip {:.2f} kN at slip {:.3f}, confidence {:.2f}", static_cast<double>(w.road->grip_N) * 1e-3,
                       static_cast<double>(w.road->peak_slip), static_cast<double>(w.road->confidence));
}

}  // namespace

std::string to_text(const BridgeActivity& s) {
    if (received(s)) return !s.with_ledger || s.held ? "at work" : "at work on this bus, but not with this ledger";
    std::string silence = s.silent_s ? fmt::format("silent for {}", duration_text(*s.silent_s)) : "not heard";
    if (!s.with_ledger) return silence;
    if (s.held) return silence + " on the bus, though it holds the ledger";
    if (s.running != 0) return silence + fmt::format(", DEAD: maneuver {} was left; the same campaign command goes on", s.running);
    return silence + ": nobody runs this campaign";
}

std::vector<std::string> watch_screen(const WatchedCampaign& w, const StripChart& chart) {
    constexpr std::size_t kColumns = 80;
    std::vector<std::string> lines{progress(w), "bridge " + to_text(w.bridge)};
    if (!w.hold.empty()) lines.push_back("HOLD: " + w.hold);
    if (!w.specimen.empty()) lines.push_back(w.specimen);
    lines.push_back(fmt::format("{:<14} {}{:.1f} s in this phase", phase_text(w), w.phase_began ? "" : "at least ", w.phase_s));
    lines.push_back(
        fmt::format("rim {:6.2f} m/s   wheel {:6.2f} m/s   slip {:6.3f}   reference {:5.3f}", w.rim_mps, w.wheel_mps, w.slip, w.slip_reference));
    lines.push_back(fmt::format("pressure {:5.2f} MPa   load {:6.2f} kN   current {:6.2f} mA", w.pressure_Pa * 1e-6, w.load_N * 1e-3, w.current_mA));
    lines.push_back(fmt::format("controller {}   faults: {}", w.controller, fault_text(w.faults)));
    if (w.tells_road) lines.push_back("road: " + road_text(w));
    if (!w.outcomes.empty()) lines.push_back(fmt::format("last: {}", fmt::join(w.outcomes, ", ")));
    if (!w.senders.empty()) lines.push_back(w.senders);
    if (!w.bus_up) lines.push_back("BUS DOWN: " + w.bus_error);
    if (!w.ledger_error.empty()) lines.push_back("ledger: " + w.ledger_error);
    for (std::string& line : chart.lines()) lines.push_back(std::move(line));
    for (std::string& line : lines) line = fit(line, kColumns);
    return lines;
}

std::string watch_line(const WatchedCampaign& w) {
    return fmt::format("{}; bridge {}{}; {} {:.1f} s; {:.2f} m/s, slip {:.3f}, {:.2f} MPa, {:.2f} kN, {:.2f} mA; controller {}; faults: {}{}{}{}",
                       progress(w), to_text(w.bridge), w.hold.empty() ? "" : "; HOLD: " + w.hold, phase_text(w), w.phase_s, w.rim_mps, w.slip,
                       w.pressure_Pa * 1e-6, w.load_N * 1e-3, w.current_mA, w.controller, fault_text(w.faults),
                       w.tells_road ? "; road: " + road_text(w) : "", w.senders.empty() ? "" : "; " + w.senders,
                       w.bus_up ? "" : "; BUS DOWN: " + w.bus_error);
}

std::string watch_json(const WatchedCampaign& w) {
    settings::Json json{{"campaign", w.campaign}, {"scenario", w.scenario}, {"number", w.number}, {"finished", w.finished}, {"planned", w.planned}};
    json["left_s"] = w.left_s ? settings::Json(*w.left_s) : nullptr;
    json["specimen"] = w.specimen;
    json["outcomes"] = w.outcomes;
    json["hold"] = w.hold;
    json["ledger_error"] = w.ledger_error;
    json["bridge"] = to_text(w.bridge);
    json["bridge_heard"] = received(w.bridge);
    json["bus_up"] = w.bus_up;
    json["bus_error"] = w.bus_error;
    json["phase"] = w.phase ? settings::Json(name(*w.phase)) : nullptr;
    json["phase_s"] = w.phase_s;
    json["phase_begin_seen"] = w.phase_began;
    json["rim_mps"] = w.rim_mps;
    json["wheel_mps"] = w.wheel_mps;
    json["slip"] = w.slip;
    json["slip_reference"] = w.slip_reference;
    json["pressure_Pa"] = w.pressure_Pa;
    json["load_N"] = w.load_N;
    json["current_mA"] = w.current_mA;
    json["controller"] = w.controller;
    json["senders"] = w.senders;
    json["faults"] = w.faults;
    json["road"] = nullptr;
    if (w.road)
        json["road"] = {{"grip_N", static_cast<double>(w.road->grip_N)},
                        {"peak_slip", static_cast<double>(w.road->peak_slip)},
                        {"confidence", static_cast<double>(w.road->confidence)}};
    return settings::json_line(json);
}

void StripChart::add(const StripSample& sample) {
    if (!samples_.empty() && sample.time_s < samples_.back().time_s) samples_.clear();
    samples_.push_back(sample);
    while (samples_.back().time_s - samples_.front().time_s > kLength_s) samples_.pop_front();
}

std::vector<std::string> StripChart::lines() const {
    const std::array<Strip, 3> strips{
        {{"speed, m/s", 1.0, {{'o', [](const StripSample& s) { return s.wheel_mps; }}, {'*', [](const StripSample& s) { return s.rim_mps; }}}},
         {"slip", 0.2, {{'-', [](const StripSample& s) { return s.slip_reference; }}, {'*', [](const StripSample& s) { return s.slip; }}}},
         {"p, MPa", 1.0, {{'*', [](const StripSample& s) { return 1e-6 * s.pressure_Pa; }}}}}};
    std::vector<std::string> all;
    for (const Strip& strip : strips)
        for (std::string& line : draw(strip, samples_)) all.push_back(std::move(line));
    all.push_back(fmt::format("{:18}|{:<{}}{}", "", fmt::format("-{:g} s", kLength_s), kColumns - 3, "now"));
    return all;
}

}  // namespace rig::bridge
