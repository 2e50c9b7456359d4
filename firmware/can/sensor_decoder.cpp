#include "firmware/can/sensor_decoder.hpp"

namespace antiskid::can {

namespace {

/// Whole ticks of the sensor's clock that have passed at `time`, modulo 2^64.
std::uint64_t ticks(const Signal& signal, control::Time time) {
    const double exact = static_cast<double>(time.count()) / signal.scale;
    const auto toward_zero = static_cast<std::int64_t>(exact);
    return static_cast<std::uint64_t>(static_cast<double>(toward_zero) > exact ? toward_zero - 1 : toward_zero);
}

}  // namespace

RawSpeed to_raw(const SpeedSignals& signals, const SpeedSample& sample) {
    if (signals.source == control::SpeedSource::edges) {
        return {.edge_count = sample.edge_count & signals.edge_count.mask(),
                .edge_time = ticks(signals.edge_time, sample.edge_time) & signals.edge_time.mask(),
                .speed = 0};
    }
    return {.edge_count = 0, .edge_time = 0, .speed = signals.speed_radps.raw(static_cast<double>(sample.speed_radps))};
}

RawManeuver to_raw(const ManeuverSignals& signals, const ManeuverSample& sample) {
    return {.law = static_cast<std::int64_t>(sample.law),
            .arm = sample.arm ? 1 : 0,
            .weight_on_wheels = sample.weight_on_wheels ? 1 : 0,
            .demand = signals.demand_Pa.raw(static_cast<double>(sample.demand_Pa)),
            .slip_reference = signals.slip_reference.raw(static_cast<double>(sample.slip_reference)),
            .deceleration = signals.deceleration_mps2.raw(static_cast<double>(sample.deceleration_mps2)),
            .current = signals.current_mA.raw(static_cast<double>(sample.current_mA))};
}

RawSpeed read_raw(const SpeedSignals& signals, const Payload& payload) {
    if (signals.source == control::SpeedSource::edges) {
        return {.edge_count = static_cast<std::uint64_t>(payload.read(signals.edge_count)),
                .edge_time = static_cast<std::uint64_t>(payload.read(signals.edge_time)),
                .speed = 0};
    }
    return {.edge_count = 0, .edge_time = 0, .speed = payload.read(signals.speed_radps)};
}

RawManeuver read_raw(const ManeuverSignals& signals, const Payload& payload) {
    return {.law = payload.read(signals.law),
            .arm = payload.read(signals.arm),
            .weight_on_wheels = payload.read(signals.weight_on_wheels),
            .demand = payload.read(signals.demand_Pa),
            .slip_reference = payload.read(signals.slip_reference),
            .deceleration = payload.read(signals.deceleration_mps2),
            .current = payload.read(signals.current_mA)};
}

void SpeedDecoder::apply(const SpeedSignals& signals, const RawSpeed& raw, control::Time received, control::SpeedInput& input) {
    input.received = received;
    input.source = signals.source;
    if (signals.source == control::SpeedSource::speed) {
        input.speed_radps = static_cast<float>(signals.speed_radps.value(raw.speed));
        return;
    }
    input.edge_count += static_cast<std::uint32_t>((raw.edge_count - last_count_) & signals.edge_count.mask());
    ticks_ += (raw.edge_time - last_time_) & signals.edge_time.mask();
    last_count_ = raw.edge_count;
    last_time_ = raw.edge_time;
    input.edge_time = control::Time{static_cast<std::int64_t>(static_cast<double>(ticks_) * signals.edge_time.scale)};
}

bool apply(const ManeuverSignals& signals, const RawManeuver& raw, control::Time received, control::ManeuverInput& input) {
    if (raw.law >= control::kLawCount) return false;
    input.received = received;
    input.law = static_cast<control::Law>(raw.law);
    input.arm = raw.arm != 0;
    input.weight_on_wheels = raw.weight_on_wheels != 0;
    input.demand_Pa = static_cast<float>(signals.demand_Pa.value(raw.demand));
    input.slip_reference = static_cast<float>(signals.slip_reference.value(raw.slip_reference));
    input.deceleration_mps2 = static_cast<float>(signals.deceleration_mps2.value(raw.deceleration));
    input.current_mA = static_cast<float>(signals.current_mA.value(raw.current));
    return true;
}

}  // namespace antiskid::can
