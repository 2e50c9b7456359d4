/// An in-process bus for tests and studies: every frame sent by one end is received by all other ends, in order. Deterministic.
///
/// For one thread. Frames are stamped with the time of the last set_time(), and wait() never waits.
#pragma once

#include <array>
#include <cstddef>
#include <deque>

#include "firmware/can/bus.hpp"

namespace antiskid::can {

class Loopback {
  public:
    /// Capacity of an end's receive queue, in frames; further frames are lost and counted in its `receive_dropped`.
    static constexpr std::size_t kQueue = 256;

    class End final : public Bus {
      public:
        explicit End(Loopback& hub) : hub_(hub) {}
        std::size_t receive(std::span<Frame> frames) override;
        /// False while this end's link is down or bus-off.
        bool send(const Frame& frame) override;
        /// Whether a frame is waiting; returns at once.
        bool wait(Time timeout) override;
        [[nodiscard]] LinkStatus status() const override { return status_; }

        /// Sets the reported link state. An end that is down or bus-off neither sends nor receives.
        void set_link(bool up, bool bus_off);

      private:
        friend class Loopback;
        void push(const Frame& frame);

        Loopback& hub_;
        std::array<Frame, kQueue> ring_{};
        std::size_t head_ = 0;
        std::size_t count_ = 0;
        LinkStatus status_;
    };

    Loopback() = default;
    Loopback(const Loopback&) = delete;
    Loopback& operator=(const Loopback&) = delete;

    /// A new end, owned by the hub. Allocates: not for the real-time path.
    [[nodiscard]] End& connect();
    /// The time stamp of frames sent from now on.
    void set_time(Time now) { now_ = now; }

  private:
    std::deque<End> ends_;
    Time now_{};
};

}  // namespace antiskid::can
