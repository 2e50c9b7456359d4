#include "rig_bridge/panel/live_feed.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <utility>

namespace rig::panel {

namespace {

void put(std::string& out, double value) {
    if (std::isfinite(value))
        fmt::format_to(std::back_inserter(out), "{:.5g}", value);
    else
        out += "null";
}

}  // namespace

void Pixel::add(const LiveSample& sample) {
    for (std::size_t i = 0; i < kSignals; ++i) {
        // What is known stands against what is not: fmin and fmax pass NaN over.
        least_.value[i] = std::fmin(least_.value[i], sample.value[i]);
        greatest_.value[i] = std::fmax(greatest_.value[i], sample.value[i]);
    }
    last_ = sample;
    ++samples_;
}

std::int64_t Pixel::time_ms() const {
    return std::llround(1e3 * last_.time_s);
}

std::string Pixel::json() const {
    std::string out = fmt::format("{{\"t\":{:.3f},\"v\":[", 1e-3 * static_cast<double>(time_ms()));
    for (std::size_t i = 0; i < kSignals; ++i) {
        out += i == 0 ? "[" : ",[";
        put(out, least_.value[i] * kChannels[i].scale);
        out += ',';
        put(out, greatest_.value[i] * kChannels[i].scale);
        out += ',';
        put(out, last_.value[i] * kChannels[i].scale);
        out += ']';
    }
    return out + "]}";
}

void LiveFeed::state(Text text, double now_s) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;
    state_.swap(text);
    next_state_s_ = now_s + kState_s;
}

void LiveFeed::collect(const Publish& publish) {
    for (LiveSample sample; ring_.pop(sample);) pixel_.add(sample);
    if (!pixel_.empty() && pixel_.time_ms() != published_ms_) {
        publish("pixel", pixel_.json());
        published_ms_ = pixel_.time_ms();
        pixel_ = {};
    }
    if (const auto state = states_ ? states_() : std::nullopt) publish("state", *state);
    Text text;
    {
        const std::lock_guard lock(mutex_);
        text.swap(state_);
    }
    if (text) publish("state", text());
}

}  // namespace rig::panel
