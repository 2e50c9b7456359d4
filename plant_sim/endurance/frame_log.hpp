/// Bus log of a maneuver in one process: the frames that rig, bridge and controller would send, in candump's format. As in lockstep, a SYNC ends each
/// sample and the controller's answer follows.
#pragma once

#include <cstdint>
#include <filesystem>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"
#include "plant_sim/endurance/test_cell.hpp"
#include "rig_bridge/record/bus_log.hpp"

namespace endurance {

class FrameLog {
  public:
    /// Creates `file`. `layout` must outlive the log.
    FrameLog(const antiskid::can::Layout& layout, antiskid::control::Time period, const std::filesystem::path& file);

    void add(const Period& period);
    /// Closes the file. Throws std::runtime_error if frames are missing.
    void finish();
    [[nodiscard]] std::uint64_t frames() const { return log_.frames(); }

  private:
    void write(antiskid::can::Frame frame);

    antiskid::can::RigPort rig_;
    antiskid::can::ControllerPort controller_;
    rig::record::BusLog log_;
    antiskid::control::Time period_;
    antiskid::control::Time now_{};
    std::uint32_t number_ = 0;
};

}  // namespace endurance
