#include "plant_sim/simulation/faulty_bus.hpp"

#include <algorithm>

namespace plant_sim::simulation {

using antiskid::can::Frame;
using antiskid::can::Time;

std::size_t FaultyBus::End::receive(std::span<Frame> frames) {
    std::size_t count = 0;
    for (; count < std::min(frames.size(), queue_.size()) && queue_[count].frame.received <= bus_.now_; ++count) {
        frames[count] = queue_[count].frame;
        if (observer_) observer_(frames[count], queue_[count].damaged);
    }
    queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
}

bool FaultyBus::End::send(const Frame& frame) {
    if (!status_.up) {
        ++status_.transmit_dropped;
        return false;
    }
    for (End& end : bus_.ends_)
        if (&end != this) end.take(frame, *this);
    return true;
}

bool FaultyBus::End::wait(Time /*timeout*/) {
    return !queue_.empty() && queue_.front().frame.received <= bus_.now_;
}

void FaultyBus::End::set_up(bool up) {
    if (!up) queue_.clear();
    status_.up = up;
}

void FaultyBus::End::take(const Frame& frame, const End& from) {
    if (send_only_ || !status_.up) return;
    Travelling one{.frame = frame};
    one.frame.received = bus_.now_;
    if (&from == neighbour_) return insert(one);
    const auto occurs = [this](FrameFault fault) {
        const double share = shares_.at(static_cast<std::size_t>(fault));
        if (share == 0.0 || wear::uniform(bus_.draw_) >= share) return false;
        ++bus_.fault_counts_.at(static_cast<std::size_t>(fault));
        return true;
    };
    if (occurs(FrameFault::lost)) return;
    if (occurs(FrameFault::late))
        one.frame.received += Time(static_cast<std::int64_t>(wear::uniform(bus_.draw_) * static_cast<double>(kMaxLate.count())));
    if (frame.length > 0 && occurs(FrameFault::damaged)) {
        one.damaged = true;
        constexpr std::uint64_t kMaxBits = 3;
        const std::uint64_t bits = 1 + bus_.draw_() % kMaxBits;
        const std::uint64_t first = bus_.draw_();
        const std::uint64_t all = 8ULL * frame.length;
        for (std::uint64_t i = 0; i < bits; ++i) {
            const std::uint64_t bit = (first + i * 5) % all;  // up to three bits of one frame, none of them twice
            one.frame.data.at(bit / 8) ^= static_cast<std::uint8_t>(1U << (bit % 8));
        }
    }
    insert(one);
    if (occurs(FrameFault::doubled)) insert(one);
}

void FaultyBus::End::insert(const Travelling& one) {
    if (queue_.empty() || queue_.back().frame.received <= one.frame.received) {
        queue_.push_back(one);
        return;
    }
    const auto after =
        std::find_if(queue_.rbegin(), queue_.rend(), [&](const Travelling& other) { return other.frame.received <= one.frame.received; });
    queue_.insert(after.base(), one);
}

}  // namespace plant_sim::simulation
