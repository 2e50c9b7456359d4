/// One imported maneuver: frames of our layout at 1 kHz from samples at any rate, linear between them, and its figures.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"
#include "rig_bridge/record/bus_log.hpp"
#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/replay/import_map.hpp"
#include "rig_bridge/replay/virtual_encoder.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig::replay {

/// SI as in Channel; channels that the recording lacks are zero.
struct ImportSample {
    double time_s = 0.0;
    std::array<double, kChannelCount> value{};

    [[nodiscard]] double operator[](Channel channel) const { return value[static_cast<std::size_t>(channel)]; }
};

/// What is the same for all maneuvers of an import.
struct ImportedRig {
    const antiskid::can::Layout& layout;
    record::MeterParameters meter;
    const rig::Plan& plan;    ///< law and demand: what the recording does not say
    bool with_valve = false;  ///< the recording has the valve current
    std::int64_t number = 0;
};

class ManeuverWriter {
  public:
    /// Makes `folder` and bus.log in it.
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
    void send(antiskid::can::Frame frame, antiskid::can::Time stamp);

    const ImportedRig& rig_;
    record::BusLog log_;
    record::BusMeter meter_;
    antiskid::can::RigPort sensors_, bridge_;
    antiskid::can::ControllerPort controller_;
    VirtualEncoder wheel_, flywheel_;
    std::optional<ImportSample> last_;
    std::int64_t next_ms_ = 0;
};

}  // namespace rig::replay
