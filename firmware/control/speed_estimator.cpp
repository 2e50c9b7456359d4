#include "firmware/control/speed_estimator.hpp"

#include "firmware/control/arithmetic.hpp"

namespace antiskid::control {

namespace {
constexpr float kTwoPi = 6.28318531F;
constexpr Time kStandstill{100'000'000};
constexpr Time kLatest{25'000'000};  // no sound frame is later than this against another one
}  // namespace

SpeedEstimator::SpeedEstimator(float teeth) : radians_per_edge_(kTwoPi / teeth) {}

/// The offset of the sensor's clock from ours is estimated from the frames with the least delay. They are forgotten within some thousand readings,
/// because the clocks drift, and a clock that was set must not look like a late frame.
float SpeedEstimator::late_s(const SpeedInput& input) {
    constexpr int kForgotten = 10;  // as a power of two, readings
    const Time after = input.received - input.edge_time;
    const Time behind = clock_known_ ? after - quickest_ : Time{};
    quickest_ = behind.count() > 0 ? quickest_ + Time{behind.count() >> kForgotten} : after;
    clock_known_ = true;
    return seconds(behind);
}

SpeedReading SpeedEstimator::update(const SpeedInput& input) {
    SpeedReading reading;
    if (input.received == kNever) return reading;
    const bool new_frame = input.received != last_received_;
    last_received_ = input.received;

    if (input.source == SpeedSource::speed) {
        reading.speed_radps = input.speed_radps;
        reading.fresh = new_frame;
        reading.valid = true;
        return reading;
    }

    if (!started_) {
        started_ = true;
        edge_count_ = input.edge_count;
        edge_time_ = input.edge_time;
        newest_edge_seen_ = input.received;
    }
    const std::uint32_t edges = input.edge_count - edge_count_;
    const Time took = input.edge_time - edge_time_;
    // The sensor's clock runs as ours: edges that took longer than the time since the last ones came are a clock that jumped, or an old
    // frame, whose count and time seem to have rolled over. The next edge is measured from here.
    const bool leapt = running_ && edges != 0 && took > input.received - newest_edge_seen_ + kLatest;
    if (leapt) {
        edge_count_ = input.edge_count;
        edge_time_ = input.edge_time;
        newest_edge_seen_ = input.received;
    } else if (edges != 0 && took.count() > 0) {
        // The first edge after a standstill only starts the clock: the time since the previous edge is unknown.
        reading.late_s = late_s(input);
        if (running_) {
            reading.interval_s = seconds(took);
            speed_radps_ = radians_per_edge_ * static_cast<float>(edges) / reading.interval_s;
            reading.fresh = true;
            measured_ = true;
        }
        running_ = true;
        edge_count_ = input.edge_count;
        edge_time_ = input.edge_time;
        newest_edge_seen_ = input.received;
    } else if (new_frame) {
        // A clock that went backwards was restarted: the next edge is measured from here.
        if (took.count() < 0) {
            clock_known_ = false;
            edge_count_ = input.edge_count;
            edge_time_ = input.edge_time;
        }
        const Time idle = input.received - newest_edge_seen_;
        if (idle >= kStandstill) {
            running_ = false;
            clock_known_ = false;  // the two clocks run apart unseen
            measured_ = true;
            speed_radps_ = 0.0F;
            reading.fresh = true;
        } else if (running_ && edges == 0 && idle.count() > 0 && radians_per_edge_ / seconds(idle) < speed_radps_) {
            speed_radps_ = radians_per_edge_ / seconds(idle);
            reading.bounded = true;
        }
    }
    reading.speed_radps = speed_radps_;
    reading.valid = measured_;
    return reading;
}

}  // namespace antiskid::control
