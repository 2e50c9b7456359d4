/// What the frames on the bus say to the bridge, and the live speeds. Knows no thread, socket, file or clock.
#pragma once

#include "firmware/can/layout.hpp"
#include "firmware/can/observer.hpp"
#include "rig_bridge/bridge/live_speed.hpp"
#include "rig_bridge/bridge/parts.hpp"
#include "rig_bridge/bridge/rejected_frames.hpp"
#include "rig_bridge/bridge/senders.hpp"
#include "rig_bridge/record/meter.hpp"

namespace rig::bridge {

class BusListener {
  public:
    /// `layout` must outlive it.
    BusListener(const antiskid::can::Layout& layout, const record::MeterParameters& parameters);

    /// Every frame on the bus, in its order; `frame.received` by the clock of tell().
    void accept(const antiskid::can::Frame& frame);

    /// Puts all of it that comes from frames, SYNC's count apart, into `now`. `drained`: everything that had arrived by `time` was accepted.
    void tell(BusNow& now, antiskid::can::Time time, bool drained);

  private:
    record::MeterParameters parameters_;
    antiskid::can::Observer live_;
    RejectedFrames status_;  // the controller's
    WhoSends senders_;
    LiveSpeed wheel_;
    LiveSpeed flywheel_;
};

}  // namespace rig::bridge
