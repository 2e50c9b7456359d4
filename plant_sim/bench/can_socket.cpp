#include "plant_sim/bench/can_socket.hpp"

#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace antiskid::bench {

CanSocket::CanSocket(const std::string& interface, const canid_t wanted) : descriptor_(socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)) {
    if (descriptor_ >= 0) {
        const can_filter filter{.can_id = wanted, .can_mask = CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_SFF_MASK};
        sockaddr_can address{};
        address.can_family = AF_CAN;
        address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
        if (address.can_ifindex > 0 && setsockopt(descriptor_, SOL_CAN_RAW, CAN_RAW_FILTER, &filter, sizeof filter) == 0 &&
            bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
            return;
    }
    const std::string reason = std::generic_category().message(errno);
    if (descriptor_ >= 0) close(descriptor_);
    throw std::runtime_error("CAN interface '" + interface + "': " + reason + "; `./rig vcan -- COMMAND` gives a command a vcan0");
}

CanSocket::~CanSocket() {
    close(descriptor_);
}

void CanSocket::set_patience(const std::chrono::milliseconds patience) {
    const auto ms = patience.count();
    const timeval limit{.tv_sec = ms / 1000, .tv_usec = ms % 1000 * 1000};
    if (setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit) != 0)
        throw std::system_error(errno, std::generic_category(), "time-out of a CAN socket");
}

void CanSocket::send(const can_frame& frame) {
    if (write(descriptor_, &frame, sizeof frame) != static_cast<ssize_t>(sizeof frame))
        throw std::system_error(errno, std::generic_category(), "sending a CAN frame");
}

bool CanSocket::receive(can_frame& frame) {
    if (read(descriptor_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame)) return true;
    if (errno != EAGAIN) throw std::system_error(errno, std::generic_category(), "receiving a CAN frame");
    return false;
}

}  // namespace antiskid::bench
