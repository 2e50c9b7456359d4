#include "rig_bridge/replay/raw_can_sender.hpp"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace rig::replay {

namespace {

[[noreturn]] void reject(const std::string& interface, const std::string& why) {
    throw std::runtime_error("CAN interface '" + interface + "': " + why);
}

bool is_up(int socket, const std::string& interface) {
    ifreq request{};
    std::strncpy(request.ifr_name, interface.c_str(), IFNAMSIZ - 1);
    return ioctl(socket, SIOCGIFFLAGS, &request) == 0 && (static_cast<unsigned>(request.ifr_flags) & IFF_UP) != 0;
}

can_frame as_kernel_frame(const LogFrame& from) {
    can_frame frame{};
    frame.can_id = from.frame.id;
    if (from.extended) frame.can_id |= CAN_EFF_FLAG;
    if (from.remote) frame.can_id |= CAN_RTR_FLAG;
    frame.can_dlc = from.frame.length;
    std::copy(from.frame.data.begin(), from.frame.data.end(), std::begin(frame.data));
    return frame;
}

}  // namespace

RawCanSender::RawCanSender(const std::string& interface) : interface_(interface) {
    const unsigned index = if_nametoindex(interface.c_str());
    if (index == 0) reject(interface, "there is none; for a virtual one: ip link add " + interface + " type vcan");
    socket_ = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
    if (socket_ < 0) reject(interface, std::string("the kernel has no CAN: ") + std::strerror(errno));
    setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(index);
    const bool bound = bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    const int error = errno;
    const bool up = is_up(socket_, interface);
    if (bound && up) return;
    close(socket_);
    if (!bound) reject(interface, std::string("is no CAN interface: ") + std::strerror(error));
    reject(interface, "is down; ip link set " + interface + " up");
}

RawCanSender::~RawCanSender() {
    close(socket_);
}

bool RawCanSender::send(const LogFrame& from) {
    constexpr useconds_t kPause_us = 100;
    const can_frame frame = as_kernel_frame(from);
    Time waited{};
    for (;;) {
        if (write(socket_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame)) return true;
        if (errno == EINTR) continue;
        if (errno != ENOBUFS && errno != EAGAIN) reject(interface_, std::string("cannot send: ") + std::strerror(errno));
        if (waited >= kPatience) return false;
        usleep(kPause_us);
        waited += std::chrono::microseconds{kPause_us};
    }
}

}  // namespace rig::replay
