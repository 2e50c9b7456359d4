#include "rig_bridge/panel/curves.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace rig::panel {

void Curves::add(const LiveSample& sample) {
    const char* const between = time_.empty() ? "" : ",";
    // To a thousandth, so that the samples of several maneuvers lie at the same times.
    fmt::format_to(std::back_inserter(time_), "{}{:.3f}", between, sample.time_s);
    for (std::size_t i = 0; i < kSignals; ++i) {
        const double value = sample.value[i] * kChannels[i].scale;
        text_[i] += between;
        if (!std::isfinite(value)) {
            text_[i] += "null";
            continue;
        }
        known_[i] = true;
        fmt::format_to(std::back_inserter(text_[i]), "{:.5g}", value);
    }
}

std::string Curves::json() const {
    std::string out = "{\"t\":[" + time_ + "]";
    for (std::size_t i = 0; i < kSignals; ++i)
        if (known_[i]) out += fmt::format(",\"{}\":[{}]", kChannels[i].key, text_[i]);
    return out + "}";
}

}  // namespace rig::panel
