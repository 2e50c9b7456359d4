/// A real CAN interface (or vcan) through Linux SocketCAN's raw sockets.
///
/// Receives classic data frames with the requested 11-bit identifiers (filtered in the kernel) and every error frame. Remote frames of a requested
/// identifier are counted as malformed; extended and FD frames are filtered out.
///
/// Time stamps: the kernel's at reception (SO_TIMESTAMPNS), converted to CLOCK_MONOTONIC with an offset that is measured at construction, every 1024
/// batches, and whenever stamps go back or jump by more than 2 ms. A step or slew of the wall clock therefore shifts stamps by at most 2 ms, for at
/// most 1024 batches; otherwise the error is some microseconds, of either sign. Hardware time stamps are not used: they come from another clock, and
/// the controller needs the stamp only for the age of an input.
///
/// Link: interface down (ENETDOWN) -> `up` false until a frame arrives or one can be sent again. Interface
/// gone (ENODEV) -> `up` stays false: open a new SocketCan. Bus-off error frame -> `bus_off` and not `up`, until the chip reports a restart
/// (CAN_ERR_RESTARTED) or a data frame arrives. Have the kernel restart the chip: `ip link set can0 type can restart-ms 100`.
///
/// Transmit queue: the socket's own send buffer is made as small as the kernel allows, so that only a few frames can queue up; a frame that does not
/// fit is discarded and counted, and the next call tries its own frame. Frames in the kernel's queue cannot be withdrawn. With `newest_only`,
/// send_all() therefore sends nothing while frames of an earlier call are still queued: after a blockage the frames of at most one call are old, and
/// those that follow are new.
///
/// System calls: receive() makes one for up to kBatch frames; so does receive_within() for the longest wait, for a
/// shorter one two; send() and send_all() make one, send_all() with `newest_only` two; status() none.
#pragma once

#include <cstdint>
#include <ctime>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "firmware/can/bus.hpp"
#include "firmware/can/layout.hpp"

namespace antiskid::can {

struct SocketCanOptions {
    int receive_buffer_bytes = 1 << 20;  ///< requested; the kernel may grant less (net.core.rmem_max)
    bool newest_only = false;            ///< see "Transmit queue" above
    /// The only identifier that ends wait(); none: every received frame does.
    std::optional<std::uint16_t> wakes{};
};

class SocketCan final : public Bus {
  public:
    static constexpr std::size_t kBatch = 32;
    static constexpr std::size_t kMaxSent = 16;  ///< per call of send_all(), further frames are discarded; a rig sends at most 9 in a period

    /// `ids`: the identifiers to receive; none: error frames only. Throws std::runtime_error naming the interface and the command that corrects it if
    /// the interface is missing, down or not CAN, or the kernel has no CAN support.
    SocketCan(const std::string& interface, std::span<const std::uint16_t> ids, const SocketCanOptions& options = {});
    ~SocketCan() override;
    SocketCan(const SocketCan&) = delete;
    SocketCan& operator=(const SocketCan&) = delete;

    std::size_t receive(std::span<Frame> frames) override;
    std::size_t receive_within(Time timeout, std::span<Frame> frames) override;
    bool send(const Frame& frame) override;
    std::size_t send_all(std::span<const Frame> frames) override;
    /// Also returns true when the link's state has changed; the next receive() updates status().
    bool wait(Time timeout) override;
    [[nodiscard]] LinkStatus status() const override { return status_; }

    /// For poll() together with other descriptors.
    [[nodiscard]] int descriptor() const { return socket_; }

  private:
    struct Batch;
    std::size_t receive(std::span<Frame> frames, int flags);
    [[nodiscard]] bool earlier_frames_wait() const;
    void note_sent();
    [[nodiscard]] bool wait_for_wake(const timespec& limit);
    void note_error(int error);
    void note_error_frame(std::uint32_t classes);

    int socket_ = -1;
    int wake_socket_ = -1;  // a second socket that receives only `wakes`
    int wake_epoll_ = -1;   // epoll, edge-triggered: the second socket need not be read after each wait
    std::uint32_t wake_events_ = 0;
    bool newest_only_;
    std::uint32_t kernel_drops_ = 0;
    LinkStatus status_;
    std::unique_ptr<Batch> batch_;  // buffers for the kernel, allocated once
};

}  // namespace antiskid::can
