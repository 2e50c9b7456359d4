#include "rig_bridge/bridge/strip_chart.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace rig {

namespace {

using Value = std::function<double(const StripSample&)>;

struct Curve {
    char mark;
    Value value;
};

struct Strip {
    const char* label;
    double least_top;           // no scale is finer than this
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
    double top = strip.least_top;
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
            const auto row =
                kRows - 1 - std::min<std::size_t>(static_cast<std::size_t>(share * kRows), kRows - 1);
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

}  // namespace

void StripChart::add(const StripSample& sample) {
    if (!samples_.empty() && sample.time_s < samples_.back().time_s) samples_.clear();
    samples_.push_back(sample);
    while (samples_.back().time_s - samples_.front().time_s > kLength_s) samples_.pop_front();
}

std::vector<std::string> StripChart::lines() const {
    const std::array<Strip, 3> strips{
        {{"speed, m/s",
          1.0,
          {{'o', [](const StripSample& s) { return s.wheel_mps; }},
           {'*', [](const StripSample& s) { return s.rim_mps; }}}},
         {"slip",
          0.2,
          {{'-', [](const StripSample& s) { return s.slip_reference; }},
           {'*', [](const StripSample& s) { return s.slip; }}}},
         {"p, MPa", 1.0, {{'*', [](const StripSample& s) { return 1e-6 * s.pressure_Pa; }}}}}};
    std::vector<std::string> all;
    for (const Strip& strip : strips)
        for (std::string& line : draw(strip, samples_)) all.push_back(std::move(line));
    all.push_back(fmt::format("{:18}|{:<{}}{}", "", fmt::format("-{:g} s", kLength_s), kColumns - 3, "now"));
    return all;
}

}  // namespace rig
