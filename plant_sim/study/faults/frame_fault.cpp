#include "plant_sim/study/faults/frame_fault.hpp"

#include <algorithm>

namespace faults {

using antiskid::can::Frame;
using antiskid::can::Payload;

namespace {
constexpr std::size_t kRemembered = 500;
}

FrameFault::FrameFault(const Fault& fault, const antiskid::can::Layout& layout, antiskid::can::Role role)
    : fault_(fault), message_(layout[role]), max_delay_(role == antiskid::can::Role::valve ? 20.0 : 200.0) {}

void FrameFault::arrive(const Frame& frame, std::int64_t period) {
    const auto later = std::find_if(under_way_.begin(), under_way_.end(), [period](const Arrival& a) { return a.period > period; });
    under_way_.insert(later, {period, frame});
}

Frame FrameFault::with_counter(const Frame& frame, std::uint64_t counter) const {
    const antiskid::can::Signal& field = message_.protection.counter;
    Frame wrong = frame;
    const Payload sent(frame.data);
    Payload difference;  // fields of a payload can be written only once, therefore the counter is changed by exclusive or
    difference.write(field, sent.read(field) ^ static_cast<std::int64_t>(counter));
    const auto bits = difference.bytes();
    for (std::size_t i = 0; i < wrong.data.size(); ++i) wrong.data[i] ^= bits[i];
    wrong.data[message_.protection.crc_byte] = antiskid::can::e2e_crc(wrong, message_.protection);
    return wrong;
}

void FrameFault::hit(Frame frame, std::int64_t period, rig::Random& random) {
    switch (fault_.what.kind) {
        case Kind::drop:
            return;
        case Kind::corrupt: {
            const std::uint64_t bits = 1 + random.bits() % 8;
            for (std::uint64_t i = 0; i < bits; ++i) {
                const std::uint64_t bit = random.bits() % (std::uint64_t{8} * frame.length);
                frame.data[bit / 8U] ^= static_cast<std::uint8_t>(1U << (bit % 8U));
            }
            return arrive(frame, period);
        }
        case Kind::replayed:
            if (fault_.negative) arrive(frame, period);
            return arrive(sent_[random.bits() % sent_.size()], period);
        case Kind::duplicated:
            arrive(frame, period);
            return arrive(frame, period);
        case Kind::reordered:
            held_ = frame;
            return;
        case Kind::wrong_counter: {
            const std::uint64_t counter = fault_.negative ? 0 : random.bits() % message_.protection.counter_modulo;
            return arrive(with_counter(frame, counter), period);
        }
        default:
            return arrive(frame, period);
    }
}

void FrameFault::send(const Frame& live, bool active, std::int64_t period, rig::Random& random) {
    if (sent_.size() < kRemembered) {
        sent_.push_back(live);
    } else {
        sent_[oldest_] = live;
        oldest_ = (oldest_ + 1) % kRemembered;
    }
    if (held_) {
        arrive(live, period);
        arrive(*held_, period);
        held_.reset();
    } else if (active && fault_.what.kind == Kind::delay) {
        arrive(live, period + static_cast<std::int64_t>(between(2.0, max_delay_, fault_.strength)));
    } else if (active && fault_.what.kind == Kind::jitter) {
        const double max = between(1.0, std::min(50.0, max_delay_), fault_.strength);
        in_order_ = std::max(in_order_, period + static_cast<std::int64_t>((max + 1.0) * random.uniform()));
        arrive(live, in_order_);
    } else if (active && random.uniform() < fault_.share) {
        hit(live, period, random);
    } else {
        arrive(live, period);
    }
}

std::optional<Frame> FrameFault::receive(std::int64_t period) {
    if (under_way_.empty() || under_way_.front().period > period) return std::nullopt;
    const Frame frame = under_way_.front().frame;
    under_way_.pop_front();
    return frame;
}

}  // namespace faults
