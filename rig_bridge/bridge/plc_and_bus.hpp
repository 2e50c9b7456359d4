/// Interfaces of the bridge's main loop to its two other threads: the PLC's registers and the bus.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/can/observer.hpp"
#include "rig_bridge/modbus/client.hpp"

namespace rig::bridge {

/// The PLC's client. Calls do not block.
class Plc {
  public:
    virtual ~Plc() = default;
    virtual void command(const CommandedValues& wanted) = 0;
    [[nodiscard]] virtual modbus::Snapshot snapshot() const = 0;
};

/// State of the bus by the recorder.
struct BusNow {
    bool up = false;
    std::string error;            ///< why it is not up
    antiskid::can::BusView view;  ///< reception times on the steady clock
    /// Time at which `view` contained everything that had arrived. Ages are relative to it, so that a delayed reader takes no sender for silent.
    antiskid::can::Time valid_at = antiskid::control::kNever;
    /// Why recent status frames of the controller were refused, by RejectedFrames; empty: none was.
    std::string controller_rejected;
    /// Evidence of two controllers, by DuplicateSenders; empty: none. The bridge's own frames are received too.
    std::string two_controllers;
    std::string two_bridges;
    double rim_mps = 0.0;        ///< flywheel, by its encoder
    double wheel_radps = 0.0;    ///< omega of the braked wheel, by its encoder
    double wheel_rim_mps = 0.0;  ///< r(F_z) omega
    double slip = 0.0;           ///< eq. (3), by both encoders
    std::uint64_t syncs = 0;     ///< SYNC frames so far
    /// Offset of the recording's time stamps from the monotonic clock.
    antiskid::can::Time wall_minus_monotonic{};
    std::uint64_t frames = 0;     ///< of the recording
    std::uint64_t dropped = 0;    ///< by the kernel, in the recording
    std::uint64_t missing = 0;    ///< frames that could not be written
    std::string recording_error;  ///< why
};

class BusFeed {
  public:
    virtual ~BusFeed() = default;
    [[nodiscard]] virtual BusNow now() const = 0;
};

}  // namespace rig::bridge
