#include "firmware/host/supervised_can.hpp"

#include <exception>
#include <utility>

namespace antiskid::host {

SupervisedCan::SupervisedCan(Open open) : open_(std::move(open)), active_(open_()) {}

SupervisedCan::~SupervisedCan() {
    delete fresh_.load();
    delete retired_.load();
}

void SupervisedCan::take_fresh() {
    const can::LinkStatus now = active_->status();
    lost_.store(!now.up && !now.bus_off, std::memory_order_relaxed);
    // Wait until service() has freed the last replaced socket: `retired_` has room for one, and this thread must not free.
    if (fresh_.load(std::memory_order_relaxed) == nullptr || retired_.load(std::memory_order_relaxed) != nullptr) return;
    before_ = status();
    retired_.store(active_.release(), std::memory_order_release);
    active_.reset(fresh_.exchange(nullptr, std::memory_order_acquire));
    lost_.store(false, std::memory_order_relaxed);
}

std::size_t SupervisedCan::receive(const std::span<can::Frame> frames) {
    take_fresh();
    return active_->receive(frames);
}

std::size_t SupervisedCan::receive_within(const can::Time timeout, const std::span<can::Frame> frames) {
    take_fresh();
    return active_->receive_within(timeout, frames);
}

bool SupervisedCan::send(const can::Frame& frame) {
    return active_->send(frame);
}

std::size_t SupervisedCan::send_all(const std::span<const can::Frame> frames) {
    return active_->send_all(frames);
}

bool SupervisedCan::wait(const can::Time timeout) {
    return active_->wait(timeout);
}

can::LinkStatus SupervisedCan::status() const {
    can::LinkStatus sum = active_->status();
    sum.error_frames += before_.error_frames;
    sum.bus_off_events += before_.bus_off_events;
    sum.receive_dropped += before_.receive_dropped;
    sum.transmit_dropped += before_.transmit_dropped;
    sum.malformed += before_.malformed;
    return sum;
}

std::string SupervisedCan::service() {
    delete retired_.exchange(nullptr, std::memory_order_acquire);
    if (!lost() || fresh_.load(std::memory_order_relaxed) != nullptr) return "";
    try {
        fresh_.store(open_().release(), std::memory_order_release);
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

}  // namespace antiskid::host
