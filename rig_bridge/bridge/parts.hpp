/// What the bridge's main loop sees of its two other threads, and of nothing else: the PLC's registers and the bus.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/can/observer.hpp"
#include "rig_bridge/modbus/client.hpp"

namespace rig::bridge {

/// The PLC's client; neither call waits.
class Plc {
  public:
    virtual ~Plc() = default;
    virtual void command(const CommandedValues& wanted) = 0;
    [[nodiscard]] virtual modbus::Snapshot snapshot() const = 0;
};

/// The bus as the recorder has it now.
struct BusNow {
    bool up = false;
    std::string error;            ///< why it is not up
    antiskid::can::BusView view;  ///< times of reception by the steady clock
    /// When everything that had arrived was in `view`: ages count to here, so that a reader that was held up takes nobody for silent.
    antiskid::can::Time looked = antiskid::control::kNever;
    /// Why status frames of the controller that came lately were refused, as RejectedFrames names it; empty: none was.
    std::string controller_rejected;
    /// What shows that there are two, as WhoSends says it; empty: nothing does. The bridge's own commands are among those that are heard.
    std::string two_controllers;
    std::string two_bridges;
    double rim_mps = 0.0;        ///< flywheel, by its encoder
    double wheel_radps = 0.0;    ///< omega of the braked wheel, by its encoder
    double wheel_rim_mps = 0.0;  ///< r(F_z) omega
    double slip = 0.0;           ///< eq. (3), by both encoders
    std::uint64_t syncs = 0;     ///< SYNC frames so far
    /// Of the recording: its time stamps are the monotonic clock's plus this.
    antiskid::can::Time wall_minus_monotonic{};
    std::uint64_t frames = 0;     ///< of the recording
    std::uint64_t dropped = 0;    ///< by the kernel, in the recording
    std::uint64_t missing = 0;    ///< that the disk did not take
    std::string recording_error;  ///< why
};

class BusFeed {
  public:
    virtual ~BusFeed() = default;
    [[nodiscard]] virtual BusNow now() const = 0;
};

}  // namespace rig::bridge
