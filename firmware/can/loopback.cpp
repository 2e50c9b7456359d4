#include "firmware/can/loopback.hpp"

#include <algorithm>

namespace antiskid::can {

Loopback::End& Loopback::connect() {
    return ends_.emplace_back(*this);
}

std::size_t Loopback::End::receive(std::span<Frame> frames) {
    const std::size_t count = std::min(frames.size(), count_);
    for (std::size_t i = 0; i < count; ++i) {
        frames[i] = ring_[head_];
        head_ = (head_ + 1) % kQueue;
    }
    count_ -= count;
    return count;
}

bool Loopback::End::send(const Frame& frame) {
    if (!status_.up) {
        ++status_.transmit_dropped;
        return false;
    }
    Frame stamped = frame;
    stamped.received = hub_.now_;
    for (End& end : hub_.ends_) {
        if (&end != this) end.push(stamped);
    }
    return true;
}

bool Loopback::End::wait(Time /*timeout*/) {
    return count_ != 0;
}

void Loopback::End::set_link(bool up, bool bus_off) {
    if (bus_off && !status_.bus_off) {
        ++status_.bus_off_events;
        ++status_.error_frames;
    }
    status_.bus_off = bus_off;
    status_.up = up && !bus_off;
}

void Loopback::End::push(const Frame& frame) {
    if (!status_.up) return;
    if (count_ == kQueue) {
        ++status_.receive_dropped;
        return;
    }
    ring_[(head_ + count_) % kQueue] = frame;
    ++count_;
}

}  // namespace antiskid::can
