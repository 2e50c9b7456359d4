/// A SocketCAN interface that may vanish and come back while the loop runs.
///
/// A socket on an interface that was removed stays dead. So the loop's thread uses whatever socket it was
/// handed last, and another thread, which may allocate, opens a new one once the interface is back and leaves
/// it at the door. Nobody ever waits for the other.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "firmware/can/bus.hpp"

namespace antiskid::host {

class SupervisedCan final : public can::Bus {
  public:
    /// Opens a fresh bus or throws std::runtime_error saying why not.
    using Open = std::function<std::unique_ptr<can::Bus>()>;

    /// Opens the first one; throws what `open` throws.
    explicit SupervisedCan(Open open);
    ~SupervisedCan() override;
    SupervisedCan(const SupervisedCan&) = delete;
    SupervisedCan& operator=(const SupervisedCan&) = delete;

    // The loop's thread.
    std::size_t receive(std::span<can::Frame> frames) override;
    std::size_t receive_within(can::Time timeout, std::span<can::Frame> frames) override;
    bool send(const can::Frame& frame) override;
    std::size_t send_all(std::span<const can::Frame> frames) override;
    bool wait(can::Time timeout) override;
    /// Counts go on across sockets.
    [[nodiscard]] can::LinkStatus status() const override;

    // The other thread.

    /// Whether service() is wanted: the link is down, but not bus-off, which the kernel ends by itself.
    [[nodiscard]] bool lost() const { return lost_.load(std::memory_order_relaxed); }
    /// Tries to open a new socket, unless the last one still waits to be taken; returns why that failed, or
    /// "". Also frees sockets that the loop has given up.
    std::string service();

  private:
    void take_fresh();

    Open open_;
    std::unique_ptr<can::Bus> active_;  ///< the loop's
    can::LinkStatus before_;            ///< counts of the sockets before `active_`
    std::atomic<can::Bus*> fresh_{nullptr};
    std::atomic<can::Bus*> retired_{nullptr};
    std::atomic<bool> lost_{false};
};

}  // namespace antiskid::host
