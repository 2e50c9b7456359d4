/// What the frames on the bus say to the bridge, and to the recording that is under way. Knows no thread or socket; clocks are handed in.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/can/layout.hpp"
#include "firmware/can/observer.hpp"
#include "firmware/can/wall_clock_offset.hpp"
#include "rig_bridge/bridge/live_speed.hpp"
#include "rig_bridge/bridge/lockstep.hpp"
#include "rig_bridge/bridge/parts.hpp"
#include "rig_bridge/bridge/recording.hpp"
#include "rig_bridge/bridge/rejected_frames.hpp"
#include "rig_bridge/bridge/senders.hpp"
#include "rig_bridge/record/meter.hpp"

namespace rig::bridge {

class BusListener {
  public:
    /// `layout` must outlive it, and so must `lockstep`; none: the monotonic clock of `clocks` is the time.
    BusListener(const antiskid::can::Layout& layout, const record::MeterParameters& parameters, antiskid::can::WallClockOffset::Clock clocks,
                Lockstep* lockstep = nullptr);

    /// A batch in the order of the bus, with the kernel's stamps, which are wall clock. `recording`: none, or it takes them, and their stamps are
    /// those of the record afterwards.
    void hear(std::span<record::CapturedFrame> frames, Recording* recording);

    /// Puts all of it that comes from frames, and what has become of `recording`, into `now`. `drained`: everything that had arrived by `time` was
    /// heard.
    void tell(BusNow& now, antiskid::can::Time time, bool drained, const Recording* recording);

  private:
    void accept(const antiskid::can::Frame& frame);

    const antiskid::can::Layout& layout_;
    record::MeterParameters parameters_;
    Lockstep* lockstep_;
    antiskid::can::WallClockOffset stamps_;
    std::uint64_t syncs_ = 0;
    antiskid::can::Observer live_;
    RejectedFrames status_;  // the controller's
    WhoSends senders_;
    LiveSpeed wheel_;
    LiveSpeed flywheel_;
};

}  // namespace rig::bridge
