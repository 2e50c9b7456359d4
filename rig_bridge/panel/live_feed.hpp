/// Passes data from a program's loop to its panel without making the loop wait: samples through a ring, states as a function that makes their text in
/// the panel's thread.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/host/spsc_ring.hpp"

namespace rig::panel {

struct Channel {
    const char* key;
    const char* label;
    const char* unit;
    const char* chart;  ///< charts with several channels have one axis
    double scale;       ///< from SI
    bool dashed;        ///< line style when several runs are overlaid
};

enum class Signal : std::uint8_t { rim, wheel, slip, slip_reference, demand, pressure, current, load, temperature };
inline constexpr std::size_t kSignals = 9;

inline constexpr std::array<Channel, kSignals> kChannels{{
    {"rim", "aircraft / rim", "m/s", "speed", 1.0, true},
    {"wheel", "braked wheel", "m/s", "speed", 1.0, false},
    {"slip", "slip", "", "slip", 1.0, false},
    {"slip_reference", "reference in force", "", "slip", 1.0, true},
    {"demand", "demand", "MPa", "pressure", 1e-6, true},
    {"pressure", "brake pressure", "MPa", "pressure", 1e-6, false},
    {"current", "valve current", "mA", "current", 1.0, false},
    {"load", "vertical load", "kN", "load", 1e-3, false},
    {"temperature", "brake temperature", "\u00b0C", "temperature", 1.0, false},
}};

/// Values in SI units, mA and degrees Celsius; NaN: unknown.
struct LiveSample {
    LiveSample() { value.fill(std::numeric_limits<double>::quiet_NaN()); }
    double& operator[](Signal signal) { return value[static_cast<std::size_t>(signal)]; }

    double time_s = 0.0;
    std::array<double, kSignals> value{};
};

/// Summary of all samples of one pixel: minimum, maximum and last value of each signal, so that no peak is lost.
class Pixel {
  public:
    void add(const LiveSample& sample);
    [[nodiscard]] bool empty() const { return samples_ == 0; }
    /// Of the last sample, as json() writes it.
    [[nodiscard]] std::int64_t time_ms() const;
    /// {"t":1.02,"v":[[min,max,last],...]} in the channels' units; null for unknown values.
    [[nodiscard]] std::string json() const;

  private:
    std::uint64_t samples_ = 0;
    LiveSample least_, greatest_, last_;
};

/// For one writing thread, the program's loop, and one reading thread, the server's.
class LiveFeed {
  public:
    using States = std::function<std::optional<std::string>()>;
    /// `states`: source of the states, called by the reader, if the loop does not make them; returns none if there are no new ones.
    explicit LiveFeed(States states = {}) : states_(std::move(states)) {}

    /// A sample for which the ring has no room is dropped.
    void sample(const LiveSample& sample) { (void)ring_.push(sample); }
    /// Whether new states are due.
    [[nodiscard]] bool state_due(double now_s) const { return now_s >= next_state_s_ || now_s < next_state_s_ - 2.0 * kState_s; }
    using Text = std::function<std::string()>;
    /// Passes states of the loop. `text` makes a JSON object of them in the reader's thread and must own its data. While the reader takes the
    /// previous ones the call has no effect, and states stay due.
    void state(Text text, double now_s);

    using Publish = std::function<void(std::string_view event, const std::string& data)>;
    /// For the reader: publishes one pixel of all samples since the last pixel, unless their time is still that pixel's (the clock of a bus may
    /// stand still), and the states if there are new ones.
    void collect(const Publish& publish);

  private:
    static constexpr double kState_s = 0.1;
    antiskid::host::SpscRing<LiveSample, 4096> ring_;
    Pixel pixel_;
    std::optional<std::int64_t> published_ms_;
    double next_state_s_ = 0.0;
    States states_;
    std::mutex mutex_;
    Text state_;
};

}  // namespace rig::panel
