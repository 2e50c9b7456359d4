/// State of a CAN interface in the kernel (rtnetlink(7), linux/can/netlink.h), and its checks. can_link() reads the state; tests fill it in
/// themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "firmware/controller/check.hpp"

namespace antiskid::controller {

struct CanLink {
    bool there = false;
    bool is_can = false;  ///< by its hardware type
    bool up = false;
    std::string kind;  ///< "can": with a controller chip; "vcan", "vxcan": virtual
    std::uint32_t queue_length = 0;
    std::uint32_t bitrate = 0;           ///< bit/s; 0: not reported. This and the members below: only with a controller chip
    std::optional<std::uint32_t> state;  ///< enum can_state: 0 error-active, 1 -warning, 2 -passive, 3 bus-off, 4 stopped, 5 sleeping
    std::uint32_t modes = 0;             ///< CAN_CTRLMODE_...
    std::uint32_t restart_ms = 0;        ///< 0: no automatic restart after bus-off
    struct ErrorCounters {
        std::uint32_t transmit = 0;
        std::uint32_t receive = 0;
    };
    std::optional<ErrorCounters> errors;  ///< not reported by every driver
    std::uint32_t bus_off_events = 0;     ///< since the driver was loaded
    std::string rejection;                ///< why the kernel could not be asked

    [[nodiscard]] bool chip() const { return kind == "can"; }
};

/// Parses an RTM_NEWLINK message. `there` is false if it is another message or truncated.
[[nodiscard]] CanLink parse_link(std::span<const std::byte> message);

[[nodiscard]] CanLink can_link(const std::string& interface);

/// Checks that the link is up, and its queue; with a controller chip also bit rate, state, error counters, restart and mode. `bitrate`: of the rig,
/// bit/s.
[[nodiscard]] Checks can_link_checks(const CanLink& link, const std::string& interface, std::uint32_t bitrate);

}  // namespace antiskid::controller
