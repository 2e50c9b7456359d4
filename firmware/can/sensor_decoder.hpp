/// Converts between raw integers and control::Sensors. ControllerPort and RoundedLink both use it, so that they give the same numbers. Freestanding.
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

/// The raw values that a sensor would send: counts and times modulo their fields, values rounded and limited.
[[nodiscard]] RawSpeed to_raw(const SpeedSignals& signals, const SpeedSample& sample);
[[nodiscard]] RawManeuver to_raw(const ManeuverSignals& signals, const ManeuverSample& sample);

/// The raw values of a frame's payload.
[[nodiscard]] RawSpeed read_raw(const SpeedSignals& signals, const Payload& payload);
[[nodiscard]] RawManeuver read_raw(const ManeuverSignals& signals, const Payload& payload);

/// Continues edge count and edge time across the roll-over of their fields.
///
/// The count continues modulo 2^32, the time without roll-over; both start from the first raw value. At least one edge is needed per roll-over of the
/// time field (429 s in config/antiskid.dbc): after a longer standstill the first interval is too short by whole roll-overs.
class SpeedDecoder {
  public:
    void apply(const SpeedSignals& signals, const RawSpeed& raw, control::Time received, control::SpeedInput& input);

  private:
    std::uint64_t last_count_ = 0;
    std::uint64_t last_time_ = 0;
    std::uint64_t ticks_ = 0;
};

/// False, with `input` unchanged, if the law's code is undefined.
[[nodiscard]] bool apply(const ManeuverSignals& signals, const RawManeuver& raw, control::Time received, control::ManeuverInput& input);

}  // namespace antiskid::can
