/// View of `rig-bridge watch` on a campaign that runs in another terminal: text of 80 columns, or a line of JSON. Pure.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/control/types.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig::bridge {

struct StripSample {
    double time_s = 0.0;
    double rim_mps = 0.0;
    double wheel_mps = 0.0;
    double slip = 0.0;
    double slip_reference = 0.0;
    double pressure_Pa = 0.0;
};

/// The last ten seconds of speed, slip and pressure as plain text.
class StripChart {
  public:
    static constexpr double kLength_s = 10.0;
    static constexpr std::size_t kColumns = 60;  ///< of the strip; with its scale a line has kWidth
    static constexpr std::size_t kWidth = 79;
    static constexpr std::size_t kRows = 4;  ///< of each strip

    /// Clears the chart if time does not increase.
    void add(const StripSample& sample);
    /// Three strips and the axis of time; * rim, o wheel, * slip, - its reference, * pressure. Empty before the first sample.
    [[nodiscard]] std::vector<std::string> lines() const;

  private:
    std::deque<StripSample> samples_;
};

/// Whether and by whom the campaign is run, by bus and ledger.
struct BridgeActivity {
    std::optional<double> silent_s;  ///< since its last frame on the bus; none: no frame so far
    bool with_ledger = false;        ///< whether the members below are known
    bool held = false;               ///< a process has the ledger open for writing
    std::int64_t running = 0;        ///< the maneuver that the ledger has as running; 0: none
};

struct WatchedCampaign {
    // Of the ledger; without one only the scenario.
    std::string campaign;  ///< empty: no ledger
    std::string scenario;
    std::int64_t finished = 0;
    std::int64_t planned = 0;
    std::optional<double> left_s;
    std::string specimen;
    std::vector<std::string> outcomes;  ///< the last ones, oldest first: "0007 finished"
    std::string hold;                   ///< as to_text(Hold); empty: it is not held
    std::string ledger_error;           ///< why it could not be read
    BridgeActivity bridge;

    // Of the bus.
    bool bus_up = false;
    std::string bus_error;
    std::int64_t number = 0;  ///< of the maneuver
    std::optional<rig::Phase> phase;
    double phase_s = 0.0;      ///< in it
    bool phase_began = false;  ///< its beginning was seen; otherwise it may have lasted longer
    double rim_mps = 0.0;
    double wheel_mps = 0.0;
    double slip = 0.0;
    double slip_reference = 0.0;
    double pressure_Pa = 0.0;
    double load_N = 0.0;
    double current_mA = 0.0;
    std::string_view controller;  ///< its state, "silent", or "rejected": heard, but no frame is good
    std::string senders;          ///< as senders_text()
    std::vector<std::string> faults;
    bool tells_road = false;  ///< the layout has that frame
    std::optional<antiskid::control::RoadEstimate> road;
};

/// Largest age of the last frame of a running bridge.
inline constexpr double kBridgeSilent_s = 1.0;

[[nodiscard]] inline bool received(const BridgeActivity& signs) {
    return signs.silent_s && *signs.silent_s <= kBridgeSilent_s;
}
/// For people: running, silent, dead, or no bridge.
[[nodiscard]] std::string to_text(const BridgeActivity& signs);

/// None of its lines wider than 80 columns.
[[nodiscard]] std::vector<std::string> watch_screen(const WatchedCampaign& watched, const StripChart& chart);
/// The same as one line, for logs.
[[nodiscard]] std::string watch_line(const WatchedCampaign& watched);
/// One JSON object in one line; units in the keys, null for what is not known.
[[nodiscard]] std::string watch_json(const WatchedCampaign& watched);

}  // namespace rig::bridge
