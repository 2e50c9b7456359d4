#include "firmware/can/raw_socket.hpp"

#include <linux/can.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

namespace antiskid::can {

namespace {

bool is_virtual(const std::string& interface) {
    return interface.starts_with("v");
}

std::string bring_up(const std::string& interface) {
    const char* const how = is_virtual(interface) ? " up`" : " up type can bitrate 1000000`";
    return "`ip link set " + interface + how;
}

std::string make(const std::string& interface) {
    if (is_virtual(interface)) return "make it with `ip link add dev " + interface + " type vcan` and " + bring_up(interface);
    return "plug the adapter in, then " + bring_up(interface) + " (`ip -br link show type can` lists what is there)";
}

[[noreturn]] void reject(const std::string& interface, const std::string& why) {
    throw std::runtime_error("CAN interface '" + interface + "' " + why);
}

[[noreturn]] void reject_system(const std::string& interface, const std::string& what, int error) {
    reject(interface, what + ": " + std::generic_category().message(error));
}

int open(const std::string& interface, RawSocket::Calls calls) {
    if (interface.empty() || interface.size() >= IFNAMSIZ) {
        reject(interface, "is no interface name: expected 1 to 15 characters, like can0");
    }
    const int waiting = calls == RawSocket::Calls::never_wait ? SOCK_NONBLOCK : 0;
    const int fd = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | waiting, CAN_RAW);
    if (fd >= 0) return fd;
    if (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT) {
        reject(interface,
               "cannot be used: this kernel has no CAN (`modprobe can_raw`, or run under `./rig vcan -- "
               "COMMAND`)");
    }
    reject_system(interface, "cannot be opened", errno);
}

int index_of(int fd, const std::string& interface) {
    ifreq request{};
    interface.copy(request.ifr_name, IFNAMSIZ - 1);
    if (ioctl(fd, SIOCGIFINDEX, &request) != 0) {
        if (errno == ENODEV) reject(interface, "does not exist: " + make(interface));
        reject_system(interface, "cannot be looked up", errno);
    }
    const int index = request.ifr_ifindex;
    if (ioctl(fd, SIOCGIFHWADDR, &request) == 0 && request.ifr_hwaddr.sa_family != ARPHRD_CAN) {
        reject(interface, "is no CAN interface (`ip -br link show type can` and `... type vcan` list them)");
    }
    if (ioctl(fd, SIOCGIFFLAGS, &request) != 0) reject_system(interface, "has no flags", errno);
    if ((static_cast<unsigned>(request.ifr_flags) & IFF_UP) == 0) reject(interface, "is down: " + bring_up(interface));
    return index;
}

}  // namespace

RawSocket::RawSocket(std::string interface, Calls calls) : interface_(std::move(interface)), socket_(open(interface_, calls)) {
    try {
        index_ = index_of(socket_, interface_);
    } catch (...) {
        close(socket_);
        throw;
    }
}

RawSocket::~RawSocket() {
    if (socket_ >= 0) close(socket_);
}

void RawSocket::set_option(int level, int option, const void* value, socklen_t size, const char* name) const {
    if (setsockopt(socket_, level, option, value, size) != 0) reject_system(interface_, std::string("refused ") + name, errno);
}

void RawSocket::bind() const {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = index_;
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) reject_system(interface_, "cannot be bound", errno);
}

BesideMessage beside(msghdr& header) {
    BesideMessage out;
    for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(&header, c)) {
        if (c->cmsg_level != SOL_SOCKET) continue;
        if (c->cmsg_type == SCM_TIMESTAMPNS) std::memcpy(&out.stamp, CMSG_DATA(c), sizeof out.stamp);
        if (c->cmsg_type == SO_RXQ_OVFL) {
            std::uint32_t drops = 0;
            std::memcpy(&drops, CMSG_DATA(c), sizeof drops);
            out.drops = drops;
        }
    }
    return out;
}

}  // namespace antiskid::can
