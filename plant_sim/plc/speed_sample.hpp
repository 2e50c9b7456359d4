/// Converts an encoder of the model to the sample that its electronics send.
#pragma once

#include <cstdint>

#include "firmware/can/rig_sample.hpp"
#include "plant_sim/model/encoder.hpp"

namespace plc {

/// Nearest nanosecond; halves are rounded up, as llround does for `time_s` >= 0, but without a call.
[[nodiscard]] inline antiskid::control::Time nearest_ns(double time_s) {
    const double ns = time_s * 1e9;
    const auto whole = static_cast<std::int64_t>(ns);
    return antiskid::control::Time(whole + (ns - static_cast<double>(whole) >= 0.5 ? 1 : 0));
}

[[nodiscard]] inline antiskid::can::SpeedSample speed_sample(const plant::Encoder& encoder, double now_s) {
    return {.edge_count = encoder.edge_count(),
            .edge_time = nearest_ns(encoder.edge_time_s()),
            .speed_radps = static_cast<float>(encoder.speed_radps(now_s))};
}

}  // namespace plc
