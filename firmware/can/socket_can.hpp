/// A real CAN interface (or vcan) through Linux SocketCAN's raw sockets.
///
/// Received: classic data frames with the wanted 11-bit identifiers (filtered in the kernel) and every error
/// frame. Remote frames of a wanted identifier are counted as malformed; extended and FD frames do not get
/// in.
///
/// Time stamps: the kernel's at reception (SO_TIMESTAMPNS), taken to CLOCK_MONOTONIC with an offset that is
/// measured at construction, every 1024 batches, and whenever stamps go back or leap by more than 2 ms: a
/// step or slew of the wall clock shifts stamps by at most 2 ms, for at most 1024 batches. They may lie some
/// microseconds off the true instant, in either direction. Stamps of CAN hardware are not used: their clocks
/// are foreign ones, and all that the controller takes from the stamp is the age of an input.
///
/// Link: interface down (ENETDOWN) -> `up` false until a frame arrives or one can be sent again. Interface
/// gone (ENODEV) -> `up` false for good: open a new one. Bus-off error frame -> `bus_off` and not `up`, until
/// the chip says that it restarted (CAN_ERR_RESTARTED) or a data frame arrives; let the kernel restart the
/// chip: `ip link set can0 type can restart-ms 100`.
///
/// Transmit queue: the socket's own send buffer is made as small as the kernel allows, so that only a few
/// frames can wait ahead; a frame that finds it full is given up and counted, and the caller's next, newer
/// one is tried on its own. Nobody can call back what the kernel has taken. With `newest_only`, send_all()
/// therefore hands over nothing while frames of an earlier call still wait: when a jam ends, at most one
/// call's frames are old, and the next ones are the newest.
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
    int receive_buffer_bytes = 1 << 20;  ///< asked of the kernel, which may give less (net.core.rmem_max)
    bool newest_only = false;            ///< see above
    /// The only identifier that ends wait(): without it every frame of a period would wake the program up.
    std::optional<std::uint16_t> wakes{};
};

class SocketCan final : public Bus {
  public:
    static constexpr std::size_t kBatch = 32;
    static constexpr std::size_t kMaxSent = 16;  ///< in one call of send_all(), a rig's period has 9 at most; the rest is given up

    /// `ids`: the identifiers to receive; none: error frames only. Throws std::runtime_error naming the
    /// interface and the command that mends it when the interface is absent, down or no CAN, or the kernel
    /// has no CAN.
    SocketCan(const std::string& interface, std::span<const std::uint16_t> ids, const SocketCanOptions& options = {});
    ~SocketCan() override;
    SocketCan(const SocketCan&) = delete;
    SocketCan& operator=(const SocketCan&) = delete;

    std::size_t receive(std::span<Frame> frames) override;
    std::size_t receive_within(Time timeout, std::span<Frame> frames) override;
    bool send(const Frame& frame) override;
    std::size_t send_all(std::span<const Frame> frames) override;
    /// True also when the link's state changed; receive() then takes note of it.
    bool wait(Time timeout) override;
    [[nodiscard]] LinkStatus status() const override { return status_; }

    /// For poll() beside other descriptors.
    [[nodiscard]] int descriptor() const { return socket_; }

  private:
    struct Batch;
    std::size_t receive(std::span<Frame> frames, int flags);
    [[nodiscard]] bool earlier_frames_wait() const;
    void note_sent();
    [[nodiscard]] bool wait_for_bell(const timespec& limit);
    void note_error(int error);
    void note_error_frame(std::uint32_t classes);

    int socket_ = -1;
    int bell_ = -1;        // a second socket, for `wakes` alone
    int bell_rings_ = -1;  // epoll, edge-triggered: the bell need not be emptied each time
    std::uint32_t rings_ = 0;
    bool newest_only_;
    std::uint32_t kernel_drops_ = 0;
    LinkStatus status_;
    std::unique_ptr<Batch> batch_;  // the kernel's structures, made once
};

}  // namespace antiskid::can
