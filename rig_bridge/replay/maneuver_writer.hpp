/// Writes one imported maneuver: frames of our layout at 1 kHz, interpolated linearly from samples at any rate, and computes its figures.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/can/rig_sample.hpp"
#include "rig_bridge/record/bus_log.hpp"
#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/replay/import_map.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig::replay {

/// Computes the edges of a toothed encoder from a recorded speed.
class VirtualEncoder {
  public:
    explicit VirtualEncoder(double teeth) : edges_per_rad_(teeth / (2.0 * std::numbers::pi)) {}

    /// Speed changes linearly to `speed_radps` during `step_s`, which ends at `now_s`; negative speeds count as standstill.
    void advance(double speed_radps, double now_s, double step_s) {
        const double before = speed_radps_;
        speed_radps_ = std::max(speed_radps, 0.0);
        const double from = edges_;
        edges_ += 0.5 * (before + speed_radps_) * step_s * edges_per_rad_;
        const double last = std::floor(edges_);
        if (last <= std::floor(from)) return;
        // The way from `from` to the last edge, x = v0 t + a t^2 / 2.
        const double way = (last - from) / edges_per_rad_;
        const double rate = (speed_radps_ - before) / step_s;
        const double root = std::sqrt(std::max(before * before + 2.0 * rate * way, 0.0));
        edge_s_ = now_s - step_s + (before + root > 0.0 ? 2.0 * way / (before + root) : step_s);
    }

    [[nodiscard]] antiskid::can::SpeedSample sample() const {
        return {.edge_count = static_cast<std::uint32_t>(static_cast<std::uint64_t>(edges_)),
                .edge_time = antiskid::control::Time{std::llround(edge_s_ * 1e9)},
                .speed_radps = static_cast<float>(speed_radps_)};
    }

  private:
    double edges_per_rad_;
    double edges_ = 0.0;
    double edge_s_ = 0.0;
    double speed_radps_ = 0.0;
};

/// SI units as in Channel; missing channels are zero.
struct ImportSample {
    double time_s = 0.0;
    std::array<double, kChannelCount> value{};
    bool load_cells = true;  ///< their values are new enough to go on the bus

    [[nodiscard]] double operator[](Channel channel) const { return value[static_cast<std::size_t>(channel)]; }
};

/// Data common to all maneuvers of an import.
struct ImportedRig {
    const antiskid::can::Layout& layout;
    record::MeterParameters meter;
    const rig::Plan& plan;    ///< law and demand, which the recording lacks
    bool with_valve = false;  ///< the recording has the valve current
    std::int64_t number = 0;
};

class ManeuverWriter {
  public:
    /// Creates `folder` and bus.log in it.
    ManeuverWriter(const ImportedRig& rig, const std::filesystem::path& folder);

    /// Times must increase.
    void add(const ImportSample& sample, rig::Phase phase);
    /// Throws std::runtime_error when the log could not be written.
    void finish();

    [[nodiscard]] record::Figures figures() const { return meter_.figures(); }
    [[nodiscard]] std::vector<std::string> warnings() const { return meter_.warnings(); }
    [[nodiscard]] std::uint64_t frames() const { return log_.frames(); }

  private:
    void step(const ImportSample& sample, rig::Phase phase);
    /// Number of frames.
    std::size_t send_due(antiskid::can::RigPort& port, const antiskid::can::RigSample& sample, antiskid::can::Time stamp);
    void send(antiskid::can::Frame frame, antiskid::can::Time stamp);

    const ImportedRig& rig_;
    record::BusLog log_;
    record::BusMeter meter_;
    antiskid::can::RigPort sensors_, bridge_, load_cells_;
    bool load_cells_sent_ = false;
    antiskid::can::ControllerPort controller_;
    VirtualEncoder wheel_, flywheel_;
    std::optional<ImportSample> last_;
    std::int64_t next_ms_ = 0;
};

}  // namespace rig::replay
