/// Decodes the frames on the bus for the bridge and for the current recording. Independent of threads and sockets; clocks are injected.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/can/layout.hpp"
#include "firmware/can/observer.hpp"
#include "firmware/can/wall_clock_offset.hpp"
#include "rig_bridge/bridge/live_speed.hpp"
#include "rig_bridge/bridge/lockstep.hpp"
#include "rig_bridge/bridge/plc_and_bus.hpp"
#include "rig_bridge/bridge/recording.hpp"
#include "rig_bridge/bridge/rejected_frames.hpp"
#include "rig_bridge/bridge/senders.hpp"
#include "rig_bridge/record/meter.hpp"

namespace rig::bridge {

class BusListener {
  public:
    /// `layout` and `lockstep` must outlive it. Time is that of `lockstep`; null: the monotonic clock of `clocks`.
    BusListener(const antiskid::can::Layout& layout, const record::MeterParameters& parameters, antiskid::can::WallClockOffset::Clock clocks,
                Lockstep* lockstep = nullptr);

    /// Takes a batch in bus order, with the kernel's wall-clock stamps. `recording`, if not null, stores the frames and replaces their stamps by
    /// those of the record.
    void receive(std::span<record::CapturedFrame> frames, Recording* recording);

    /// Fills the members of `now` that come from frames, and the state of `recording`. `drained`: all frames that had arrived by `time` were taken.
    void fill(BusNow& now, antiskid::can::Time time, bool drained, const Recording* recording);

  private:
    void accept(const antiskid::can::Frame& frame);

    const antiskid::can::Layout& layout_;
    record::MeterParameters parameters_;
    Lockstep* lockstep_;
    antiskid::can::WallClockOffset stamps_;
    std::uint64_t syncs_ = 0;
    antiskid::can::Observer live_;
    RejectedFrames status_;  // the controller's
    DuplicateSenders senders_;
    LiveSpeed wheel_;
    LiveSpeed flywheel_;
};

}  // namespace rig::bridge
