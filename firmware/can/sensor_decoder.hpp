/// From raw integers to control::Sensors: used behind the bytes (ControllerPort) and without them
/// (RoundedLink), so that both give the same numbers. Freestanding.
#pragma once

#include <cstdint>

#include "firmware/can/layout.hpp"
#include "firmware/can/rig_sample.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::can {

struct RawSpeed {
    std::uint64_t edge_count = 0;
    std::uint64_t edge_time = 0;
    std::int64_t speed = 0;
};

struct RawManeuver {
    std::int64_t law = 0;
    std::int64_t arm = 0;
    std::int64_t weight_on_wheels = 0;
    std::int64_t demand = 0;
    std::int64_t slip_reference = 0;
    std::int64_t deceleration = 0;
    std::int64_t current = 0;
};

/// What the sensor's electronics would put on the bus: counts and times modulo their fields, values rounded
/// and limited.
[[nodiscard]] RawSpeed to_raw(const SpeedSignals& signals, const SpeedSample& sample);
[[nodiscard]] RawManeuver to_raw(const ManeuverSignals& signals, const ManeuverSample& sample);

/// The raw values of a frame's payload.
[[nodiscard]] RawSpeed read_raw(const SpeedSignals& signals, const Payload& payload);
[[nodiscard]] RawManeuver read_raw(const ManeuverSignals& signals, const Payload& payload);

/// Continues edge count and edge time across the roll-over of their fields.
///
/// The count goes on modulo 2^32. The time goes on as if the field never rolled over, which holds while an
/// edge comes at least once per roll-over of the field (429 s in our layout): after a longer standstill the
/// first interval is short by whole roll-overs. Both start from the first raw value.
class SpeedDecoder {
  public:
    void apply(const SpeedSignals& signals, const RawSpeed& raw, control::Time received, control::SpeedInput& input);

  private:
    std::uint64_t last_count_ = 0;
    std::uint64_t last_time_ = 0;
    std::uint64_t ticks_ = 0;
};

/// False, with `input` unchanged, when the law is none that exists.
[[nodiscard]] bool apply(const ManeuverSignals& signals, const RawManeuver& raw, control::Time received, control::ManeuverInput& input);

}  // namespace antiskid::can
