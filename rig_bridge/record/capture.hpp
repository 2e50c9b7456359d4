/// Receives every frame on a CAN interface, including this program's own: any identifier, remote and error frames.
///
///     Capture capture("vcan0");
///     while (run) if (capture.wait(100ms)) for (const CapturedFrame& f : capture.receive()) { log.write(f); meter(f); }
///
/// CAN FD frames are only counted. Stamps are the kernel's (SO_TIMESTAMPNS, wall clock), as printed by candump. Frames dropped by the kernel because
/// our queue was full are counted. No allocation after construction; for one thread.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "rig_bridge/record/captured_frame.hpp"

namespace rig::record {

struct CaptureOptions {
    /// Requested from the kernel, which grants less without CAP_NET_ADMIN (net.core.rmem_max). A frame takes about 0.8 KiB: 8 MiB hold about a second
    /// of a full bus.
    int receive_buffer_bytes = 8 << 20;
};

struct CaptureStatus {
    bool up = true;               ///< false: interface gone, or down until a frame arrives again
    bool gone = false;            ///< the interface was removed: open a new Capture
    std::uint64_t frames = 0;     ///< returned by receive()
    std::uint64_t fd_frames = 0;  ///< not returned
    std::uint64_t dropped = 0;    ///< by the kernel, because our queue was full
    std::string interface_error;  ///< why it is not up, naming the interface; empty while it is
};

class Capture {
  public:
    static constexpr std::size_t kBatch = 64;

    /// Throws std::runtime_error naming the interface if it is missing, down or not CAN, or the kernel has no CAN support.
    explicit Capture(const std::string& interface, const CaptureOptions& options = {});
    ~Capture();
    Capture(const Capture&) = delete;
    Capture& operator=(const Capture&) = delete;

    /// Frames that have arrived, oldest first, at most kBatch; valid until the next call. Never waits.
    [[nodiscard]] std::span<CapturedFrame> receive();
    /// Waits until frames can be received or the link's state has changed; false after a time-out.
    [[nodiscard]] bool wait(antiskid::can::Time timeout);

    /// Reads the count of dropped frames from the kernel, so that drops after the last received frame are included.
    [[nodiscard]] CaptureStatus status() const;
    [[nodiscard]] const std::string& interface() const { return interface_; }
    /// For poll() together with other descriptors.
    [[nodiscard]] int descriptor() const { return socket_; }
    /// The size granted by the kernel.
    /// CaptureStatus::up alone.
    [[nodiscard]] bool up() const { return status_.up; }
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
