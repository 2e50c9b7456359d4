/// Faults of a bus on the frames of one message.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "firmware/can/frame.hpp"
#include "firmware/can/layout.hpp"
#include "plant_sim/study/faults/catalogue.hpp"

namespace faults {

/// - drop: a share of the frames is lost
/// - delay: each frame is 2 to 200 periods late, by strength; the valve command at most 20, since the controller's transmit queue keeps only the
///   newest
/// - jitter: each frame is up to 1 to 50 periods late, by strength, in order; the valve command again at most 20
/// - corrupt: in a share of the frames 1 to 8 bits are inverted
/// - replayed: a share of the frames is replaced by one that was sent up to 500 frames ago; if negative, that frame is sent in addition
/// - duplicated: a share of the frames is sent twice
/// - reordered: a share of the frames arrives after the following one
/// - wrong_counter: a share of the frames has another alive counter with a matching CRC; if negative, the counter stands still
class FrameFault {
  public:
    /// `layout` must outlive it.
    FrameFault(const Fault& fault, const antiskid::can::Layout& layout, antiskid::can::Role role);

    /// Takes a frame sent in period `period`.
    void send(const antiskid::can::Frame& live, bool active, std::int64_t period, rig::Random& random);
    /// The next frame that has arrived by `period`; none: no further one.
    [[nodiscard]] std::optional<antiskid::can::Frame> receive(std::int64_t period);

  private:
    void hit(antiskid::can::Frame frame, std::int64_t period, rig::Random& random);
    void arrive(const antiskid::can::Frame& frame, std::int64_t period);
    [[nodiscard]] antiskid::can::Frame with_counter(const antiskid::can::Frame& frame, std::uint64_t counter) const;

    struct Arrival {
        std::int64_t period = 0;
        antiskid::can::Frame frame;
    };
    Fault fault_;
    const antiskid::can::Message& message_;
    double max_delay_;               // periods
    std::deque<Arrival> under_way_;  // by period; equal ones as they were sent
    std::vector<antiskid::can::Frame> sent_;
    std::size_t oldest_ = 0;
    std::optional<antiskid::can::Frame> held_;  // reordered: waits for the following frame
    std::int64_t in_order_ = 0;                 // jitter: earliest arrival that keeps the order
};

}  // namespace faults
