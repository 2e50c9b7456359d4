#include "firmware/controller/can_link.hpp"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <system_error>
#include <type_traits>

#include "firmware/host/settings/file_descriptor.hpp"

namespace antiskid::controller {

namespace {

using Bytes = std::span<const std::byte>;

/// A structure of the kernel's at the beginning; all zero where there are not enough bytes.
template <typename T>
T as(Bytes bytes) {
    static_assert(std::is_trivially_copyable_v<T>);
    T value{};
    if (bytes.size() >= sizeof value) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
}

std::string as_text(Bytes bytes) {
    const auto end = std::find(bytes.begin(), bytes.end(), std::byte{0});
    std::string text;
    std::transform(bytes.begin(), end, std::back_inserter(text), [](std::byte b) { return static_cast<char>(b); });
    return text;
}

std::size_t aligned(std::size_t size) {
    return (size + RTA_ALIGNTO - 1) / RTA_ALIGNTO * RTA_ALIGNTO;
}

/// `visit(type, content)` for each attribute, up to the first whose length cannot be.
template <typename Visit>
void each_attribute(Bytes bytes, Visit visit) {
    while (bytes.size() >= sizeof(rtattr)) {
        const auto head = as<rtattr>(bytes);
        if (head.rta_len < sizeof head || head.rta_len > bytes.size()) return;
        visit(head.rta_type & NLA_TYPE_MASK, bytes.subspan(sizeof head, head.rta_len - sizeof head));
        bytes = bytes.subspan(std::min(aligned(head.rta_len), bytes.size()));
    }
}

void read_chip(Bytes bytes, CanLink& link) {
    each_attribute(bytes, [&link](int type, Bytes content) {
        switch (type) {
            case IFLA_CAN_BITTIMING:
                link.bitrate = as<can_bittiming>(content).bitrate;
                break;
            case IFLA_CAN_STATE:
                link.state = as<std::uint32_t>(content);
                break;
            case IFLA_CAN_CTRLMODE:
                link.modes = as<can_ctrlmode>(content).flags;
                break;
            case IFLA_CAN_RESTART_MS:
                link.restart_ms = as<std::uint32_t>(content);
                break;
            case IFLA_CAN_BERR_COUNTER: {
                const auto counters = as<can_berr_counter>(content);
                link.errors = {.transmit = counters.txerr, .receive = counters.rxerr};
                break;
            }
            default:
                break;
        }
    });
}

void read_info(Bytes bytes, CanLink& link) {
    each_attribute(bytes, [&link](int type, Bytes content) {
        if (type == IFLA_INFO_KIND) link.kind = as_text(content);
        if (type == IFLA_INFO_DATA && link.chip()) read_chip(content, link);
        if (type == IFLA_INFO_XSTATS && link.chip()) link.bus_off_events = as<can_device_stats>(content).bus_off;
    });
}

struct Request {
    nlmsghdr header;
    ifinfomsg link;
};

/// The kernel's answer in `buffer`; empty, with errno, where there is none.
Bytes ask(unsigned index, std::span<std::byte> buffer) {
    const settings::FileDescriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
    if (!socket.is_open()) return {};
    Request request{};
    request.header.nlmsg_len = sizeof request;
    request.header.nlmsg_type = RTM_GETLINK;
    request.header.nlmsg_flags = NLM_F_REQUEST;
    request.link.ifi_family = AF_UNSPEC;
    request.link.ifi_index = static_cast<int>(index);
    if (::send(socket.get(), &request, sizeof request, 0) < 0) return {};
    const ssize_t size = ::recv(socket.get(), buffer.data(), buffer.size(), 0);
    return Bytes(buffer).first(size > 0 ? static_cast<std::size_t>(size) : 0);
}

}  // namespace

CanLink parse_link(Bytes message) {
    CanLink link;
    const auto header = as<nlmsghdr>(message);
    constexpr std::size_t kHead = NLMSG_HDRLEN + sizeof(ifinfomsg);
    if (header.nlmsg_type != RTM_NEWLINK || header.nlmsg_len < kHead || header.nlmsg_len > message.size()) return link;
    const auto about = as<ifinfomsg>(message.subspan(NLMSG_HDRLEN));
    link.there = true;
    link.is_can = about.ifi_type == ARPHRD_CAN;
    link.up = (about.ifi_flags & IFF_UP) != 0;
    each_attribute(message.subspan(kHead, header.nlmsg_len - kHead), [&link](int type, Bytes content) {
        if (type == IFLA_TXQLEN) link.queue_length = as<std::uint32_t>(content);
        if (type == IFLA_LINKINFO) read_info(content, link);
    });
    return link;
}

CanLink can_link(const std::string& interface) {
    constexpr std::size_t kMax = 32768;  // what the kernel itself sends at most
    CanLink link;
    const unsigned index = if_nametoindex(interface.c_str());
    if (index == 0) return link;
    std::array<std::byte, kMax> buffer{};
    const Bytes answer = ask(index, buffer);
    if (answer.empty())
        link.rejection = "netlink: " + std::generic_category().message(errno);
    else
        link = parse_link(answer);
    return link;
}

}  // namespace antiskid::controller
