#include <fmt/core.h>
#include <linux/can/netlink.h>

#include <array>
#include <string_view>

#include "firmware/controller/can_link.hpp"

namespace antiskid::controller {

namespace {

constexpr std::uint32_t kErrorWarning = 96;  // ISO 11898: above, a node is suspect

std::string set_up(const std::string& interface, std::uint32_t bitrate) {
    return fmt::format("ip link set {0} down; ip link set {0} type can bitrate {1} restart-ms 100 && ip link set {0} up", interface, bitrate);
}

Check interface_check(const CanLink& link, const std::string& interface, std::uint32_t bitrate) {
    const std::string measured = !link.rejection.empty() ? link.rejection
                                 : !link.there           ? interface + " does not exist"
                                 : !link.is_can          ? interface + " is no CAN interface"
                                 : !link.up              ? interface + " is down"
                                                         : "up";
    const bool vcan = interface.starts_with("v");
    return judged("CAN interface", measured == "up",
                  {.measured = measured,
                   .required = "up",
                   .remedy = vcan ? fmt::format("ip link add dev {0} type vcan; ip link set {0} up", interface) : set_up(interface, bitrate)});
}

Check queue_check(const CanLink& link, const std::string& interface) {
    // One period's frames must fit; a frame queued behind a hundred others would be sent too late to be of use.
    constexpr std::uint32_t kMin = 10;
    constexpr std::uint32_t kMax = 1000;
    return judged("CAN transmit queue", link.queue_length >= kMin && link.queue_length <= kMax,
                  {.measured = fmt::format("{} frames", link.queue_length),
                   .required = fmt::format("{} to {} frames", kMin, kMax),
                   .remedy = fmt::format("ip link set {} txqueuelen 64", interface)});
}

Check state_check(const CanLink& link, const std::string& interface) {
    constexpr std::array<std::string_view, 6> kStates{"error-active", "error-warning", "error-passive", "bus-off", "stopped", "sleeping"};
    const std::uint32_t state = link.state.value_or(CAN_STATE_MAX);
    const std::string_view said = state < kStates.size() ? kStates.at(state) : "not told";
    return judged(
        "CAN state", state == CAN_STATE_ERROR_ACTIVE,
        {.measured = fmt::format("{}, {} times bus-off so far", said, link.bus_off_events),
         .required = "error-active",
         .remedy = fmt::format("look for 60 ohm between the wires with the power off, and for equal bit rates: ip -details -statistics link show {}",
                               interface)},
        state == CAN_STATE_ERROR_WARNING ? CheckResult::warn : CheckResult::fail);
}

Check counters_check(const CanLink& link, const std::string& interface) {
    const std::string required = fmt::format("none; below {} at the most", kErrorWarning);
    if (!link.errors) return skipped("CAN error counters", "this driver does not tell", required);
    const auto [transmit, receive] = *link.errors;
    const bool suspect = transmit >= kErrorWarning || receive >= kErrorWarning;
    return judged("CAN error counters", transmit == 0 && receive == 0,
                  {.measured = fmt::format("transmit {}, receive {}", transmit, receive),
                   .required = required,
                   .remedy = "termination, wiring, a second node with another bit rate: candump -e " + interface + ",0:0,#FFFFFFFF"},
                  suspect ? CheckResult::fail : CheckResult::warn);
}

Check restart_check(const CanLink& link, const std::string& interface) {
    constexpr std::uint32_t kMax_ms = 1000;
    return judged("CAN restart", link.restart_ms > 0 && link.restart_ms <= kMax_ms,
                  {.measured = link.restart_ms == 0 ? std::string("never: bus-off is for good") : fmt::format("after {} ms", link.restart_ms),
                   .required = fmt::format("1 to {} ms after bus-off", kMax_ms),
                   .remedy = fmt::format("ip link set {0} down; ip link set {0} type can restart-ms 100; ip link set {0} up", interface)});
}

Check mode_check(const CanLink& link, const std::string& interface) {
    constexpr std::uint32_t kDeaf = CAN_CTRLMODE_LISTENONLY | CAN_CTRLMODE_LOOPBACK | CAN_CTRLMODE_ONE_SHOT | CAN_CTRLMODE_PRESUME_ACK;
    const std::uint32_t wrong = link.modes & kDeaf;
    return judged("CAN mode", wrong == 0,
                  {.measured = wrong == 0 ? std::string("sends, acknowledges, repeats")
                                          : fmt::format("listen-only, loopback, one-shot or presume-ack (mode bits 0x{:02x})", wrong),
                   .required = "none of these modes",
                   .remedy = fmt::format(
                       "ip link set {0} down; ip link set {0} type can listen-only off loopback off one-shot off presume-ack off; ip link set {0} up",
                       interface)});
}

}  // namespace

Checks can_link_checks(const CanLink& link, const std::string& interface, std::uint32_t bitrate) {
    Checks checks{interface_check(link, interface, bitrate)};
    if (!link.there || !link.is_can) return checks;
    checks.push_back(queue_check(link, interface));
    const std::string wanted_rate = fmt::format("{} bit/s", bitrate);
    if (!link.chip()) {
        const std::string why = "not a CAN controller: virtual (" + link.kind + ")";
        checks.push_back(skipped("CAN bit rate", why, wanted_rate));
        checks.push_back(skipped("CAN state", why, "error-active"));
        checks.push_back(skipped("CAN error counters", why, "none"));
        checks.push_back(skipped("CAN restart", why, "some time after bus-off"));
        return checks;
    }
    checks.push_back(judged("CAN bit rate", link.bitrate == bitrate,
                            {.measured = fmt::format("{} bit/s", link.bitrate), .required = wanted_rate, .remedy = set_up(interface, bitrate)}));
    checks.push_back(state_check(link, interface));
    checks.push_back(counters_check(link, interface));
    checks.push_back(restart_check(link, interface));
    checks.push_back(mode_check(link, interface));
    return checks;
}

}  // namespace antiskid::controller
