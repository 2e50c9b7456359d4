/// Record of one control period, passed from the loop to the rest of the program through the ring. Fixed size.
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
    /// From the timer's deadline, or the reception of the frame that started the step, to the loop running; 0 in lockstep.
    control::Time latency{};
    /// From then (in lockstep: from the reception of SYNC) until the last frame was handed to the bus. None: not timed.
    std::optional<control::Time> work{};
    /// From the reception of the newest wheel frame (in lockstep: of SYNC) to the same instant. None: no wheel frame yet, or not timed.
    std::optional<control::Time> edge_to_command{};
    std::uint64_t skipped = 0;   ///< periods missed just before this one
    std::uint32_t received = 0;  ///< frames taken from the bus
    std::uint32_t unsent = 0;    ///< frames that the bus did not take
    bool synchronised = true;    ///< false: lockstep, and SYNC did not arrive
    bool by_timer = false;       ///< the sensor frame did not arrive, the step was started by the timer
    can::LinkStatus link;
    control::Command command;
};

/// Holds four seconds at 1 kHz; if the reader is delayed longer, records are lost.
using CycleRing = SpscRing<CycleRecord, 4096>;

}  // namespace antiskid::host
