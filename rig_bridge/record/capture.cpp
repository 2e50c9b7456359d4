#include "rig_bridge/record/capture.hpp"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "firmware/can/raw_socket.hpp"

namespace rig::record {

using antiskid::can::Time;

namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;

void take(const canfd_frame& raw, CapturedFrame& out) {
    out.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
    out.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
    out.error = (raw.can_id & CAN_ERR_FLAG) != 0;
    out.frame.id = raw.can_id & (out.extended || out.error ? CAN_EFF_MASK : CAN_SFF_MASK);
    out.frame.length = std::min<std::uint8_t>(raw.len, CAN_MAX_DLEN);
    std::memcpy(out.frame.data.data(), raw.data, CAN_MAX_DLEN);
}

}  // namespace

struct Capture::Batch {
    static constexpr std::size_t kControl = CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t));

    Batch() {
        for (std::size_t i = 0; i < kBatch; ++i) {
            vectors[i] = {.iov_base = &frames[i], .iov_len = sizeof frames[i]};
            headers[i].msg_hdr.msg_iov = &vectors[i];
            headers[i].msg_hdr.msg_iovlen = 1;
            headers[i].msg_hdr.msg_control = &control[i];
        }
    }

    struct alignas(cmsghdr) Control {
        std::array<unsigned char, kControl> bytes;
    };

    std::array<canfd_frame, kBatch> frames{};
    std::array<iovec, kBatch> vectors{};
    std::array<Control, kBatch> control{};
    std::array<mmsghdr, kBatch> headers{};
};

Capture::Capture(const std::string& interface, const CaptureOptions& options) : interface_(interface), batch_(std::make_unique<Batch>()) {
    antiskid::can::RawSocket socket(interface);
    const can_err_mask_t every_error = CAN_ERR_MASK;
    socket.set_option(SOL_CAN_RAW, CAN_RAW_ERR_FILTER, every_error, "error frames");
    const int on = 1;
    socket.set_option(SOL_CAN_RAW, CAN_RAW_FD_FRAMES, on, "FD frames");
    socket.set_option(SOL_SOCKET, SO_TIMESTAMPNS, on, "time stamps");
    socket.set_option(SOL_SOCKET, SO_RXQ_OVFL, on, "the drop counter");
    // Exceeds net.core.rmem_max only with CAP_NET_ADMIN.
    const int bytes = options.receive_buffer_bytes;
    if (setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) != 0)
        socket.set_option(SOL_SOCKET, SO_RCVBUF, bytes, "the receive buffer");
    socket.bind();
    socket_ = socket.release();
}

Capture::~Capture() {
    close(socket_);
}

std::span<CapturedFrame> Capture::receive() {
    for (mmsghdr& header : batch_->headers) header.msg_hdr.msg_controllen = Batch::kControl;
    const int received = recvmmsg(socket_, batch_->headers.data(), kBatch, MSG_DONTWAIT, nullptr);
    if (received < 0) {
        note_error(errno);
        return {};
    }
    if (received > 0 && !status_.up) {
        status_.up = true;
        status_.interface_error.clear();
    }
    std::size_t count = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(received); ++i) {
        const auto [stamp, drops] = antiskid::can::beside(batch_->headers[i].msg_hdr);
        dropped_ += drops.value_or(kernel_drops_) - kernel_drops_;
        kernel_drops_ = drops.value_or(kernel_drops_);
        if (batch_->headers[i].msg_len == CANFD_MTU) {
            ++status_.fd_frames;
            continue;
        }
        take(batch_->frames[i], frames_[count]);
        frames_[count].frame.received = Time{std::int64_t{stamp.tv_sec} * kNanoseconds + stamp.tv_nsec};
        ++count;
    }
    status_.frames += count;
    return {frames_.data(), count};
}

bool Capture::wait(Time timeout) {
    const std::int64_t left = std::max<std::int64_t>(timeout.count(), 0);
    const timespec limit{.tv_sec = left / kNanoseconds, .tv_nsec = left % kNanoseconds};
    pollfd descriptor{.fd = socket_, .events = POLLIN, .revents = 0};
    return ppoll(&descriptor, 1, &limit, nullptr) > 0;
}

void Capture::note_error(int error) {
    if (error != ENETDOWN && error != ENODEV && error != ENXIO) return;
    status_.up = false;
    status_.gone = status_.gone || error != ENETDOWN;
    status_.interface_error = "CAN interface '" + interface_ + (status_.gone ? "' is gone" : "' went down");
}

CaptureStatus Capture::status() const {
    CaptureStatus status = status_;
    status.dropped = dropped_;
    std::array<std::uint32_t, SK_MEMINFO_VARS> info{};
    socklen_t size = sizeof info;
    if (getsockopt(socket_, SOL_SOCKET, SO_MEMINFO, info.data(), &size) == 0) status.dropped += info[SK_MEMINFO_DROPS] - kernel_drops_;
    return status;
}

int Capture::receive_buffer_bytes() const {
    int bytes = 0;
    socklen_t size = sizeof bytes;
    return getsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &bytes, &size) == 0 ? bytes : 0;
}

}  // namespace rig::record
