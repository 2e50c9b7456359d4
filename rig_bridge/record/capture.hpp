/// Every frame that passes on a CAN interface, those of this program included: any identifier, remote and error frames.
///
///     Capture capture("vcan0");
///     while (run) if (capture.wait(100ms)) for (const CapturedFrame& f : capture.receive()) { log.write(f); meter(f); }
///
/// CAN FD frames are counted and not given. Stamps are the kernel's (SO_TIMESTAMPNS, wall clock), as candump prints them. What the kernel
/// had to drop since our queue was full is counted. Nothing is allocated after construction; one thread.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "rig_bridge/record/captured_frame.hpp"

namespace rig::record {

struct CaptureOptions {
    /// Asked of the kernel, which gives less without CAP_NET_ADMIN (net.core.rmem_max). A frame takes about 0.8 KiB there:
    /// 8 MiB are about a second of a full bus.
    int receive_buffer_bytes = 8 << 20;
};

struct CaptureStatus {
    bool up = true;               ///< false: interface down, until a frame arrives again; or gone
    bool gone = false;            ///< for good: open a new one
    std::uint64_t frames = 0;     ///< given to the consumer
    std::uint64_t fd_frames = 0;  ///< not given
    std::uint64_t dropped = 0;    ///< by the kernel, before us
    std::string interface_error;  ///< why it is not up, naming the interface; empty while it is
};

class Capture {
  public:
    static constexpr std::size_t kBatch = 64;

    /// Throws std::runtime_error naming the interface when it is absent, down or no CAN, or the kernel has no CAN.
    explicit Capture(const std::string& interface, const CaptureOptions& options = {});
    ~Capture();
    Capture(const Capture&) = delete;
    Capture& operator=(const Capture&) = delete;

    /// What has arrived, oldest first, at most kBatch frames; valid until the next call. Never waits.
    [[nodiscard]] std::span<CapturedFrame> receive();
    /// Waits until something can be received or the link's state changed; false on time-out.
    [[nodiscard]] bool wait(antiskid::can::Time timeout);

    /// The count of drops is asked of the kernel: also those after which nothing arrived any more.
    [[nodiscard]] CaptureStatus status() const;
    [[nodiscard]] const std::string& interface() const { return interface_; }
    /// For poll() beside others.
    [[nodiscard]] int descriptor() const { return socket_; }
    /// What the kernel gave.
    [[nodiscard]] int receive_buffer_bytes() const;

  private:
    struct Batch;
    void note_error(int error);

    std::string interface_;
    int socket_ = -1;
    std::uint32_t kernel_drops_ = 0;  // as the kernel counts, modulo 2^32
    std::uint64_t dropped_ = 0;
    CaptureStatus status_;
    std::unique_ptr<Batch> batch_;
    std::array<CapturedFrame, kBatch> frames_{};
};

}  // namespace rig::record
