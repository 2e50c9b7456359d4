/// A whole braking maneuver as the frames of its lockstep run, made in process. Replayed to the real controller
/// it must bring the recorded answers, so whoever measures knows that the controller did its whole work.
#pragma once

#include <linux/can.h>

#include <vector>

#include "firmware/can/layout.hpp"
#include "plant_sim/stop_options.hpp"

namespace antiskid::bench {

struct RecordedStop {
    struct Cycle {
        std::vector<can_frame> sensors;  ///< in the order of the bus
        can_frame sync{};
        can_frame valve{};  ///< the answer
    };
    canid_t valve_id = 0;
    std::vector<Cycle> cycles;
};

[[nodiscard]] RecordedStop record_stop(const plant_sim::StopInputs& scenario);

/// Same identifier, length and payload.
[[nodiscard]] bool same(const can_frame& a, const can_frame& b);

}  // namespace antiskid::bench
