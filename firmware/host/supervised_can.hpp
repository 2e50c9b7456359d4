/// A SocketCAN interface that may disappear and return while the loop runs.
///
/// A socket on a removed interface never works again. Another thread, which may allocate, therefore opens a new socket once the interface is back,
/// and the loop's thread takes it at its next receive(). Neither thread waits for the other.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "firmware/can/bus.hpp"

namespace antiskid::host {

class SupervisedCan final : public can::Bus {
  public:
    /// Opens a new bus or throws std::runtime_error with the reason.
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
    /// Counts are summed over all sockets.
    [[nodiscard]] can::LinkStatus status() const override;

    // The other thread.

    /// Whether service() must be called: the link is down, but not bus-off, from which the kernel recovers by itself.
    [[nodiscard]] bool lost() const { return lost_.load(std::memory_order_relaxed); }
    /// Tries to open a new socket, unless the loop has not taken the last one yet; returns the reason of a failure, else "". Also frees sockets that
    /// the loop has replaced.
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
