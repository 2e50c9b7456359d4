#include "tests/can/fake_kernel.hpp"

#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstring>
#include <ctime>
#include <stdexcept>

namespace can_test {

namespace {

constexpr int kFirst = 5000;  // above every descriptor of the process
constexpr std::int64_t kNanoseconds = 1'000'000'000;

// The wrapped calls have no other way to it. NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
FakeKernel* fake = nullptr;

int reject(int error) {
    errno = error;
    return -1;
}

timespec spec(FakeKernel::Time time) {
    return {.tv_sec = time.count() / kNanoseconds, .tv_nsec = time.count() % kNanoseconds};
}

template <typename T>
void attach(msghdr& header, std::size_t& used, int level, int type, const T& value) {
    cmsghdr note{};
    note.cmsg_len = CMSG_LEN(sizeof value);
    note.cmsg_level = level;
    note.cmsg_type = type;
    if (used + CMSG_SPACE(sizeof value) > header.msg_controllen) throw std::logic_error("no room for what the kernel notes");
    auto* const at = static_cast<unsigned char*>(header.msg_control) + used;
    std::memcpy(at, &note, sizeof note);
    std::memcpy(at + CMSG_LEN(0), &value, sizeof value);
    used += CMSG_SPACE(sizeof value);
}

void deliver(const FakeKernel::Arrival& arrival, mmsghdr& message) {
    if (message.msg_hdr.msg_iovlen != 1 || message.msg_hdr.msg_iov->iov_len != sizeof arrival.frame) throw std::logic_error("no room for one frame");
    std::memcpy(message.msg_hdr.msg_iov->iov_base, &arrival.frame, sizeof arrival.frame);
    message.msg_len = arrival.length;
    std::size_t used = 0;
    if (arrival.foreign_note) attach(message.msg_hdr, used, SOL_CAN_RAW, SCM_TIMESTAMPNS, timespec{.tv_sec = 4711, .tv_nsec = 0});
    if (arrival.stamped) attach(message.msg_hdr, used, SOL_SOCKET, SCM_TIMESTAMPNS, spec(arrival.wall));
    if (arrival.drops) attach(message.msg_hdr, used, SOL_SOCKET, SO_RXQ_OVFL, *arrival.drops);
    message.msg_hdr.msg_controllen = used;
}

}  // namespace

FakeKernel::FakeKernel() {
    if (fake != nullptr) throw std::logic_error("there is a fake kernel already");
    fake = this;
}

FakeKernel::~FakeKernel() {
    fake = nullptr;
}

}  // namespace can_test

using can_test::fake;
using can_test::FakeKernel;
using can_test::reject;

// The linker's --wrap prescribes these names. NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" {

int __real_close(int descriptor);
int __real_getsockopt(int descriptor, int level, int option, void* value, socklen_t* size);
int __real_socket(int domain, int type, int protocol);
int __real_clock_gettime(clockid_t clock, timespec* now);

int __wrap_socket(int domain, int type, int protocol) {
    if (fake == nullptr) return __real_socket(domain, type, protocol);
    if (fake->socket_error != 0) return reject(fake->socket_error);
    if (domain != PF_CAN || (type | SOCK_NONBLOCK) != (SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK) || protocol != CAN_RAW)
        throw std::logic_error("not a raw CAN socket that no child inherits");
    const int descriptor = can_test::kFirst + static_cast<int>(fake->open.size());
    fake->open.insert(descriptor);
    return descriptor;
}

int __wrap_close(int descriptor) {
    if (fake == nullptr || descriptor < can_test::kFirst) return __real_close(descriptor);
    if (fake->open.erase(descriptor) == 0) throw std::logic_error("closed twice");
    return 0;
}

int __wrap_ioctl(int /*descriptor*/, unsigned long request, ...) {
    std::va_list arguments;
    va_start(arguments, request);
    auto* const answer = va_arg(arguments, ifreq*);
    va_end(arguments);
    fake->looked_up = answer->ifr_name;
    if (request == SIOCGIFINDEX) {
        answer->ifr_ifindex = fake->index;
        return fake->index_error == 0 ? 0 : reject(fake->index_error);
    }
    if (request == SIOCGIFHWADDR) {
        answer->ifr_hwaddr.sa_family = fake->hardware;
        return fake->address_error == 0 ? 0 : reject(fake->address_error);
    }
    answer->ifr_flags = fake->flags;
    return fake->flags_error == 0 ? 0 : reject(fake->flags_error);
}

int __wrap_setsockopt(int /*descriptor*/, int level, int option, const void* value, socklen_t size) {
    const auto error = fake->option_errors.find({level, option});
    if (error != fake->option_errors.end()) return reject(error->second);
    const auto* const bytes = static_cast<const unsigned char*>(value);
    fake->options[{level, option}].assign(bytes, bytes + size);
    return 0;
}

int __wrap_bind(int /*descriptor*/, const sockaddr* address, socklen_t /*size*/) {
    sockaddr_can can{};
    std::memcpy(&can, address, sizeof can);
    if (can.can_family != AF_CAN) return reject(EINVAL);
    fake->bound_index = can.can_ifindex;
    return fake->bind_error == 0 ? 0 : reject(fake->bind_error);
}

int __wrap_recvmmsg(int /*descriptor*/, mmsghdr* messages, unsigned count, int flags, timespec* /*timeout*/) {
    const bool limited = (flags & MSG_WAITFORONE) != 0 && fake->options.contains({SOL_SOCKET, SO_RCVTIMEO});
    if ((flags & MSG_DONTWAIT) == 0 && !limited) throw std::logic_error("may wait for ever, or for a full batch");
    fake->calls.emplace_back((flags & MSG_DONTWAIT) != 0 ? "receive" : "wait and receive");
    if (fake->arrivals.empty()) return reject(fake->receive_error);
    unsigned received = 0;
    for (; received < count && !fake->arrivals.empty(); ++received) {
        can_test::deliver(fake->arrivals.front(), messages[received]);
        fake->arrivals.pop_front();
    }
    return static_cast<int>(received);
}

ssize_t __wrap_send(int /*descriptor*/, const void* data, std::size_t size, int flags) {
    if ((flags & MSG_DONTWAIT) == 0) throw std::logic_error("may wait for room");
    if (fake->send_error != 0) return reject(fake->send_error);
    can_frame frame{};
    std::memcpy(&frame, data, sizeof frame);
    fake->sent.push_back(frame);
    return static_cast<ssize_t>(size);
}

int __wrap_sendmmsg(int descriptor, mmsghdr* messages, unsigned count, int flags) {
    fake->calls.emplace_back("send");
    int sent = 0;
    for (; sent < static_cast<int>(std::min<std::size_t>(count, fake->room)); ++sent) {
        const iovec& bytes = *messages[sent].msg_hdr.msg_iov;
        if (__wrap_send(descriptor, bytes.iov_base, bytes.iov_len, flags) < 0) return -1;
    }
    return sent > 0 ? sent : can_test::reject(ENOBUFS);
}

int __wrap_getsockopt(int descriptor, int level, int option, void* value, socklen_t* size) {
    if (fake == nullptr) return __real_getsockopt(descriptor, level, option, value, size);
    fake->calls.emplace_back("look at the queue");
    std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
    if (level != SOL_SOCKET || option != SO_MEMINFO || *size != sizeof memory) throw std::logic_error("not the memory of this socket");
    if (fake->memory_error != 0) return reject(fake->memory_error);
    memory[SK_MEMINFO_WMEM_ALLOC] = fake->queued_bytes;
    std::memcpy(value, memory.data(), sizeof memory);
    return 0;
}

int __wrap_epoll_create1(int flags) {
    if (fake->epoll_error != 0) return reject(fake->epoll_error);
    if (flags != EPOLL_CLOEXEC) throw std::logic_error("a child would inherit it");
    const int descriptor = can_test::kFirst + static_cast<int>(fake->open.size());
    fake->open.insert(descriptor);
    return descriptor;
}

int __wrap_epoll_ctl(int /*epoll*/, int operation, int descriptor, epoll_event* event) {
    if (operation != EPOLL_CTL_ADD || event->events != (EPOLLIN | EPOLLET) || !fake->open.contains(descriptor))
        throw std::logic_error("not each arrival at an open socket");
    return fake->epoll_add_error == 0 ? 0 : reject(fake->epoll_add_error);
}

int __wrap_epoll_pwait2(int epoll, epoll_event* /*events*/, int /*most*/, const timespec* timeout, const void* /*mask*/) {
    if (!fake->open.contains(epoll)) throw std::logic_error("not open");
    fake->calls.emplace_back("wait for the wake socket");
    fake->waited.push_back(FakeKernel::Time{timeout->tv_sec * can_test::kNanoseconds + timeout->tv_nsec});
    return fake->poll_answer;
}

int __wrap_ppoll(pollfd* descriptors, nfds_t count, const timespec* timeout, const void* /*mask*/) {
    if (count != 1 || descriptors->events != POLLIN || !fake->open.contains(descriptors->fd))
        throw std::logic_error("not a wait for this socket's frames alone");
    fake->calls.emplace_back("wait");
    fake->waited.push_back(FakeKernel::Time{timeout->tv_sec * can_test::kNanoseconds + timeout->tv_nsec});
    return fake->poll_answer;
}

int __wrap_clock_gettime(clockid_t clock, timespec* now) {
    if (fake == nullptr) return __real_clock_gettime(clock, now);
    if (clock == CLOCK_MONOTONIC) {
        *now = can_test::spec(fake->monotonic);
        return 0;
    }
    ++fake->readings;
    *now = can_test::spec(fake->monotonic + fake->wall_ahead);
    FakeKernel::Time takes{1000};
    if (!fake->reading_takes.empty()) {
        takes = fake->reading_takes.front();
        fake->reading_takes.pop_front();
    }
    fake->monotonic += takes;
    return 0;
}

}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier)
