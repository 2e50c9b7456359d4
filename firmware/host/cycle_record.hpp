/// What the loop tells the rest of the program about one period: copied through the ring, fixed size.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/can/bus.hpp"
#include "firmware/control/types.hpp"
#include "firmware/host/spsc_ring.hpp"

namespace antiskid::host {

struct CycleRecord {
    std::uint64_t step = 0;  ///< number of the step, from 1
    control::Time now{};     ///< time handed to the controller
    /// From the deadline waited for, or the reception of the frame gone by, to the loop running; 0 in lockstep.
    control::Time latency{};
    /// From there, in lockstep from the reception of SYNC, to the last frame handed to the bus. None: not timed.
    std::optional<control::Time> work{};
    /// From the reception of the newest wheel frame, in lockstep of SYNC, to there. None: no wheel frame yet, or not timed.
    std::optional<control::Time> edge_to_command{};
    std::uint64_t skipped = 0;   ///< periods missed just before this one
    std::uint32_t received = 0;  ///< frames taken from the bus
    std::uint32_t unsent = 0;    ///< frames that the bus did not take
    bool synchronised = true;    ///< false: lockstep, and SYNC failed to come
    bool by_timer = false;       ///< the sensors' frame failed to come
    can::LinkStatus link;
    control::Command command;
};

/// Four seconds at 1 kHz: the reader may be held up that long before records are lost.
using CycleRing = SpscRing<CycleRecord, 4096>;

}  // namespace antiskid::host
