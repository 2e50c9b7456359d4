#include "firmware/can/socket_can.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <system_error>
#include <vector>

#include "firmware/can/raw_socket.hpp"
#include "firmware/can/wall_clock_offset.hpp"
#include "firmware/can/wall_minus_monotonic.hpp"

namespace antiskid::can {

namespace {

constexpr std::int64_t kPerSecond = 1'000'000'000;

Time time_of(const timespec& t) {
    return Time{std::int64_t{t.tv_sec} * kPerSecond + t.tv_nsec};
}

can_frame raw(const Frame& frame) {
    can_frame out{};
    out.can_id = frame.id & CAN_SFF_MASK;
    out.can_dlc = std::min<std::uint8_t>(frame.length, CAN_MAX_DLEN);
    std::memcpy(out.data, frame.data.data(), sizeof out.data);
    return out;
}

/// Makes an epoll descriptor that reports each frame arriving at `socket`, read or not.
int edge_triggered(const int socket, const std::string& interface) {
    epoll_event arrival{};
    arrival.events = EPOLLIN | EPOLLET;
    const int epoll = epoll_create1(EPOLL_CLOEXEC);
    if (epoll >= 0 && epoll_ctl(epoll, EPOLL_CTL_ADD, socket, &arrival) == 0) return epoll;
    const int error = errno;
    if (epoll >= 0) close(epoll);
    throw std::system_error(error, std::generic_category(), "CAN interface '" + interface + "' cannot be waited for");
}

}  // namespace

struct SocketCan::Batch {
    static constexpr std::size_t kControl = CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t));

    Batch() : offset(WallMinusMonotonic{}) {
        for (std::size_t i = 0; i < kBatch; ++i) {
            vectors[i] = {.iov_base = &frames[i], .iov_len = sizeof frames[i]};
            headers[i].msg_hdr.msg_iov = &vectors[i];
            headers[i].msg_hdr.msg_iovlen = 1;
            headers[i].msg_hdr.msg_control = &control[i];
        }
        for (std::size_t i = 0; i < kMaxSent; ++i) {
            sent_vectors[i] = {.iov_base = &sent_frames[i], .iov_len = sizeof sent_frames[i]};
            sent_headers[i].msg_hdr.msg_iov = &sent_vectors[i];
            sent_headers[i].msg_hdr.msg_iovlen = 1;
        }
    }

    struct alignas(cmsghdr) Control {
        std::array<unsigned char, kControl> bytes;
    };

    WallClockOffset offset;
    std::array<can_frame, kBatch> frames{};
    std::array<iovec, kBatch> vectors{};
    std::array<Control, kBatch> control{};
    std::array<mmsghdr, kBatch> headers{};
    std::array<can_frame, kMaxSent> sent_frames{};
    std::array<iovec, kMaxSent> sent_vectors{};
    std::array<mmsghdr, kMaxSent> sent_headers{};
};

SocketCan::SocketCan(const std::string& interface, std::span<const std::uint16_t> ids, const SocketCanOptions& options)
    : newest_only_(options.newest_only), batch_(std::make_unique<Batch>()) {
    RawSocket socket(interface, RawSocket::Calls::may_wait);

    // Remote frames of a wanted identifier pass, to be counted.
    std::vector<can_filter> filters;
    for (const std::uint16_t id : ids) filters.push_back({.can_id = id, .can_mask = CAN_EFF_FLAG | CAN_SFF_MASK});
    socket.set_option(SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), static_cast<socklen_t>(filters.size() * sizeof(can_filter)), "the filters");
    const can_err_mask_t every_error = CAN_ERR_MASK;
    socket.set_option(SOL_CAN_RAW, CAN_RAW_ERR_FILTER, every_error, "error frames");
    const int on = 1;
    socket.set_option(SOL_SOCKET, SO_TIMESTAMPNS, on, "time stamps");
    socket.set_option(SOL_SOCKET, SO_RXQ_OVFL, on, "the drop counter");
    socket.set_option(SOL_SOCKET, SO_RCVBUF, options.receive_buffer_bytes, "the receive buffer");
    // The kernel raises this to its least value, room for a handful of frames.
    const int smallest = 1;
    socket.set_option(SOL_SOCKET, SO_SNDBUF, smallest, "the send buffer");
    const timeval longest{.tv_sec = 0, .tv_usec = kLongestWait.count() / 1000};
    socket.set_option(SOL_SOCKET, SO_RCVTIMEO, longest, "the longest wait");

    socket.bind();
    if (options.wakes) {
        // The kernel serves filters for a single identifier last: when this socket receives the frame, the other one already has it.
        RawSocket wake(interface);
        const can_filter one{.can_id = *options.wakes, .can_mask = CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_SFF_MASK};
        wake.set_option(SOL_CAN_RAW, CAN_RAW_FILTER, one, "the filters");
        wake.bind();
        wake_epoll_ = edge_triggered(wake.get(), interface);
        wake_socket_ = wake.release();
    }
    socket_ = socket.release();
}

SocketCan::~SocketCan() {
    close(socket_);
    if (wake_socket_ < 0) return;
    close(wake_epoll_);
    close(wake_socket_);
}

std::size_t SocketCan::receive(std::span<Frame> frames) {
    return receive(frames, MSG_DONTWAIT);
}

std::size_t SocketCan::receive_within(Time timeout, std::span<Frame> frames) {
    if (timeout >= kLongestWait) return receive(frames, MSG_WAITFORONE);
    return wait(timeout) ? receive(frames, MSG_DONTWAIT) : 0;
}

std::size_t SocketCan::receive(std::span<Frame> frames, int flags) {
    const std::size_t wanted = std::min(frames.size(), kBatch);
    for (std::size_t i = 0; i < wanted; ++i) {
        batch_->headers[i].msg_hdr.msg_controllen = Batch::kControl;
    }
    const int received = recvmmsg(socket_, batch_->headers.data(), static_cast<unsigned>(wanted), flags, nullptr);
    if (received < 0) {
        note_error(errno);
        return 0;
    }

    batch_->offset.next_batch();
    std::size_t count = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(received); ++i) {
        const auto [stamp, drops] = beside(batch_->headers[i].msg_hdr);
        status_.receive_dropped += drops.value_or(kernel_drops_) - kernel_drops_;
        kernel_drops_ = drops.value_or(kernel_drops_);
        const can_frame& raw = batch_->frames[i];
        if ((raw.can_id & CAN_ERR_FLAG) != 0) {
            note_error_frame(raw.can_id & CAN_ERR_MASK);
            continue;
        }
        status_.bus_off = false;
        status_.up = true;
        if (batch_->headers[i].msg_len != sizeof raw || (raw.can_id & (CAN_EFF_FLAG | CAN_RTR_FLAG)) != 0 || raw.can_dlc > CAN_MAX_DLEN) {
            ++status_.malformed;
            continue;
        }
        Frame& frame = frames[count++];
        frame.id = raw.can_id & CAN_SFF_MASK;
        frame.length = raw.can_dlc;
        std::memcpy(frame.data.data(), raw.data, sizeof raw.data);
        frame.received = batch_->offset.monotonic(time_of(stamp));
    }
    return count;
}

bool SocketCan::send(const Frame& frame) {
    const can_frame out = raw(frame);
    if (::send(socket_, &out, sizeof out, MSG_DONTWAIT) == static_cast<ssize_t>(sizeof out)) {
        note_sent();
        return true;
    }
    ++status_.transmit_dropped;
    note_error(errno);
    return false;
}

std::size_t SocketCan::send_all(std::span<const Frame> frames) {
    if (frames.empty()) return 0;
    const std::size_t wanted = std::min(frames.size(), kMaxSent);
    std::transform(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(wanted), batch_->sent_frames.begin(), raw);
    std::size_t taken = 0;
    if (!newest_only_ || !earlier_frames_wait()) {
        const int sent = sendmmsg(socket_, batch_->sent_headers.data(), static_cast<unsigned>(wanted), MSG_DONTWAIT);
        if (sent < 0) {
            note_error(errno);
        } else {
            taken = static_cast<std::size_t>(sent);
            note_sent();
        }
    }
    status_.transmit_dropped += static_cast<std::uint32_t>(frames.size() - taken);
    return taken;
}

/// By the kernel's count of bytes that have not yet left the interface's queue; 0 if the kernel does not report it.
bool SocketCan::earlier_frames_wait() const {
    std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
    socklen_t size = sizeof memory;
    return getsockopt(socket_, SOL_SOCKET, SO_MEMINFO, memory.data(), &size) == 0 && memory[SK_MEMINFO_WMEM_ALLOC] > 0;
}

void SocketCan::note_sent() {
    if (!status_.bus_off) status_.up = true;
}

bool SocketCan::wait(Time timeout) {
    const std::int64_t left = std::max<std::int64_t>(timeout.count(), 0);
    const timespec limit{.tv_sec = left / kPerSecond, .tv_nsec = left % kPerSecond};
    if (wake_socket_ >= 0) return wait_for_wake(limit);
    pollfd descriptor{.fd = socket_, .events = POLLIN, .revents = 0};
    return ppoll(&descriptor, 1, &limit, nullptr) > 0;
}

bool SocketCan::wait_for_wake(const timespec& limit) {
    epoll_event event{};
    const bool arrived = epoll_pwait2(wake_epoll_, &event, 1, &limit, nullptr) > 0;
    // A full receive queue of the second socket would raise no further events.
    if (!arrived || ++wake_events_ % kBatch == 0) {
        for (mmsghdr& header : batch_->headers) header.msg_hdr.msg_controllen = Batch::kControl;
        (void)recvmmsg(wake_socket_, batch_->headers.data(), kBatch, MSG_DONTWAIT, nullptr);
    }
    return arrived;
}

void SocketCan::note_error(int error) {
    if (error == ENETDOWN || error == ENODEV || error == ENXIO) status_.up = false;
}

void SocketCan::note_error_frame(std::uint32_t classes) {
    ++status_.error_frames;
    if ((classes & CAN_ERR_BUSOFF) != 0) {
        ++status_.bus_off_events;
        status_.bus_off = true;
        status_.up = false;
    }
    if ((classes & CAN_ERR_RESTARTED) != 0) {
        status_.bus_off = false;
        status_.up = true;
    }
}

}  // namespace antiskid::can
