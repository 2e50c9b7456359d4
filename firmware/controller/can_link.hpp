/// A CAN interface as the kernel has it: rtnetlink(7), linux/can/netlink.h. Facts and checks; can_link() asks the kernel, tests write the
/// facts down.
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
    std::string kind;  ///< "can": a controller chip; "vcan", "vxcan": none
    std::uint32_t queue_length = 0;
    std::uint32_t bitrate = 0;           ///< 0: not told, as the rest below, where there is no controller chip
    std::optional<std::uint32_t> state;  ///< enum can_state: 0 error-active, 1 -warning, 2 -passive, 3 bus-off, 4 stopped, 5 sleeping
    std::uint32_t modes = 0;             ///< CAN_CTRLMODE_...
    std::uint32_t restart_ms = 0;        ///< 0: stays bus-off
    struct ErrorCounters {
        std::uint32_t transmit = 0;
        std::uint32_t receive = 0;
    };
    std::optional<ErrorCounters> errors;  ///< not every driver tells
    std::uint32_t bus_off_events = 0;     ///< since the driver was loaded
    std::string rejection;                ///< why the kernel could not be asked

    [[nodiscard]] bool chip() const { return kind == "can"; }
};

/// An RTM_NEWLINK message. Not `there` when it is none or cut off.
[[nodiscard]] CanLink parse_link(std::span<const std::byte> message);

[[nodiscard]] CanLink can_link(const std::string& interface);

/// Up, queue; and of a controller chip bit rate, state, error counters, restart, mode. `bitrate`: that of the rig.
[[nodiscard]] Checks can_link_checks(const CanLink& link, const std::string& interface, std::uint32_t bitrate);

}  // namespace antiskid::controller
