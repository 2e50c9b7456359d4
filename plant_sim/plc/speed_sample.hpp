/// From an encoder of the model to what its electronics put on the bus.
#pragma once

#include <cmath>

#include "firmware/can/rig_sample.hpp"
#include "plant_sim/model/encoder.hpp"

namespace plc {

[[nodiscard]] inline antiskid::can::SpeedSample speed_sample(const plant::Encoder& encoder, double now_s) {
    return {.edge_count = encoder.edge_count(),
            .edge_time = antiskid::control::Time(std::llround(encoder.edge_time_s() * 1e9)),
            .speed_radps = static_cast<float>(encoder.speed_radps(now_s))};
}

}  // namespace plc
