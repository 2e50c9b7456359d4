// The CAN interface: what rtnetlink says of it, and what is thought of that.
#include "firmware/controller/can_link.hpp"

#include <linux/can/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>

#include <cstring>
#include <functional>

#include "tests/controller/results.hpp"

using namespace controller_test;
using controller::CanLink;

namespace {

CanLink good_link() {
    CanLink link;
    link.there = link.is_can = link.up = true;
    link.kind = "can";
    link.queue_length = 64;
    link.bitrate = 1'000'000;
    link.state = CAN_STATE_ERROR_ACTIVE;
    link.restart_ms = 100;
    link.errors = CanLink::ErrorCounters{};
    return link;
}

struct BadLink {
    std::function<void(CanLink&)> how;
    Wrong expected;
};

Wrong judged_link(const CanLink& link) {
    return wrong(can_link_checks(link, "can0", 1'000'000));
}

/// A netlink message as the kernel builds it.
class Message {
  public:
    Message(std::uint16_t type, unsigned flags) {
        bytes_.resize(NLMSG_HDRLEN + sizeof(ifinfomsg));
        nlmsghdr header{};
        header.nlmsg_type = type;
        std::memcpy(bytes_.data(), &header, sizeof header);
        ifinfomsg about{};
        about.ifi_type = ARPHRD_CAN;
        about.ifi_flags = flags;
        std::memcpy(bytes_.data() + NLMSG_HDRLEN, &about, sizeof about);
    }
    template <typename T>
    Message& add(std::uint16_t type, const T& value) {
        const std::size_t at = open(type);
        const auto* const from = reinterpret_cast<const std::byte*>(&value);
        bytes_.insert(bytes_.end(), from, from + sizeof value);
        close(at);
        return *this;
    }
    [[nodiscard]] std::size_t open(std::uint16_t type) {
        bytes_.resize(RTA_ALIGN(bytes_.size()));
        const std::size_t at = bytes_.size();
        rtattr head{};
        head.rta_type = type;
        bytes_.resize(at + sizeof head);
        std::memcpy(bytes_.data() + at, &head, sizeof head);
        return at;
    }
    void close(std::size_t at) {
        const auto length = static_cast<std::uint16_t>(bytes_.size() - at);
        std::memcpy(bytes_.data() + at, &length, sizeof length);
    }
    [[nodiscard]] std::vector<std::byte> bytes() const {
        std::vector<std::byte> whole = bytes_;
        const auto length = static_cast<std::uint32_t>(whole.size());
        std::memcpy(whole.data(), &length, sizeof length);
        return whole;
    }

  private:
    std::vector<std::byte> bytes_;
};

Message kvaser() {
    Message message(RTM_NEWLINK, IFF_UP);
    message.add(IFLA_IFNAME, std::array<char, 5>{"can0"});
    message.add(IFLA_TXQLEN, std::uint32_t{64});
    const std::size_t info = message.open(IFLA_LINKINFO);
    message.add(IFLA_INFO_KIND, std::array<char, 4>{"can"});
    const std::size_t data = message.open(IFLA_INFO_DATA | NLA_F_NESTED);
    can_bittiming timing{};
    timing.bitrate = 500'000;
    message.add(IFLA_CAN_BITTIMING, timing);
    message.add(IFLA_CAN_STATE, std::uint32_t{CAN_STATE_ERROR_PASSIVE});
    message.add(IFLA_CAN_CTRLMODE, can_ctrlmode{.mask = 0, .flags = CAN_CTRLMODE_LISTENONLY});
    message.add(IFLA_CAN_RESTART_MS, std::uint32_t{250});
    message.add(IFLA_CAN_BERR_COUNTER, can_berr_counter{.txerr = 128, .rxerr = 7});
    message.close(data);
    can_device_stats stats{};
    stats.bus_off = 3;
    message.add(IFLA_INFO_XSTATS, stats);
    message.close(info);
    return message;
}

}  // namespace

TEST_CASE("a controller chip that is as it should be passes every check", "[RT-130]") {
    const auto checks = can_link_checks(good_link(), "can0", 1'000'000);
    CHECK(checks.size() == 7);
    for (const controller::Check& check : checks) {
        CAPTURE(check.name, check.measured);
        CHECK(check.verdict == controller::CheckResult::pass);
    }
}

TEST_CASE("an interface that is bad in one respect fails that check alone", "[RT-130]") {
    const std::vector<BadLink> links{
        {[](auto& l) { l.there = false; }, {"CAN interface: fail"}},
        {[](auto& l) { l.is_can = false; }, {"CAN interface: fail"}},
        {[](auto& l) { l.up = false; }, {"CAN interface: fail"}},
        {[](auto& l) { l.rejection = "netlink: Operation not permitted"; }, {"CAN interface: fail"}},
        {[](auto& l) { l.queue_length = 3; }, {"CAN transmit queue: fail"}},
        {[](auto& l) { l.queue_length = 5000; }, {"CAN transmit queue: fail"}},
        {[](auto& l) { l.bitrate = 500'000; }, {"CAN bit rate: fail"}},
        {[](auto& l) { l.state = CAN_STATE_ERROR_WARNING; }, {"CAN state: warn"}},
        {[](auto& l) { l.state = CAN_STATE_ERROR_PASSIVE; }, {"CAN state: fail"}},
        {[](auto& l) { l.state = CAN_STATE_BUS_OFF; }, {"CAN state: fail"}},
        {[](auto& l) { l.state = 77; }, {"CAN state: fail"}},
        {[](auto& l) { l.state.reset(); }, {"CAN state: fail"}},
        {[](auto& l) { l.errors->receive = 1; }, {"CAN error counters: warn"}},
        {[](auto& l) { l.errors->transmit = 96; }, {"CAN error counters: fail"}},
        {[](auto& l) { l.restart_ms = 0; }, {"CAN restart: fail"}},
        {[](auto& l) { l.restart_ms = 5000; }, {"CAN restart: fail"}},
        {[](auto& l) { l.modes = CAN_CTRLMODE_LISTENONLY; }, {"CAN mode: fail"}},
        {[](auto& l) { l.modes = CAN_CTRLMODE_ONE_SHOT; }, {"CAN mode: fail"}},
    };
    for (const BadLink& bad : links) {
        CanLink link = good_link();
        bad.how(link);
        CHECK(judged_link(link) == bad.expected);
    }
}

TEST_CASE("what a virtual interface or a driver cannot tell is skipped, never passed", "[RT-130]") {
    CanLink link = good_link();
    link.errors.reset();
    CHECK(named(can_link_checks(link, "can0", 1'000'000), "CAN error counters").verdict == controller::CheckResult::skipped);

    CanLink vcan;
    vcan.there = vcan.is_can = vcan.up = true;
    vcan.kind = "vcan";
    vcan.queue_length = 1000;
    const auto checks = can_link_checks(vcan, "vcan0", 1'000'000);
    CHECK(wrong(checks).empty());
    for (const char* const name : {"CAN bit rate", "CAN state", "CAN error counters", "CAN restart"}) {
        const controller::Check check = named(checks, name);
        CHECK(check.verdict == controller::CheckResult::skipped);
        CHECK(check.measured == "not a CAN controller: virtual (vcan)");
    }
}

TEST_CASE("the kernel's message is read whole", "[RT-130]") {
    const CanLink link = controller::parse_link(kvaser().bytes());
    CHECK(link.there);
    CHECK(link.is_can);
    CHECK(link.up);
    CHECK(link.kind == "can");
    CHECK(link.queue_length == 64);
    CHECK(link.bitrate == 500'000);
    CHECK(link.state == CAN_STATE_ERROR_PASSIVE);
    CHECK(link.modes == CAN_CTRLMODE_LISTENONLY);
    CHECK(link.restart_ms == 250);
    REQUIRE(link.errors);
    CHECK(link.errors->transmit == 128);
    CHECK(link.errors->receive == 7);
    CHECK(link.bus_off_events == 3);

    CHECK_FALSE(controller::parse_link(Message(NLMSG_ERROR, IFF_UP).bytes()).there);
    CHECK_FALSE(controller::parse_link(Message(RTM_NEWLINK, 0).bytes()).up);
}

TEST_CASE("a message that is cut off, or whose lengths lie, is read no further than it goes", "[RT-130]") {
    const std::vector<std::byte> whole = kvaser().bytes();
    for (std::size_t size = 0; size < whole.size(); ++size) {
        // On the heap and no longer than it says: a read beyond the end is the sanitizer's to see.
        const std::vector<std::byte> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        CHECK_FALSE(controller::parse_link(cut).there);
    }
    for (std::size_t at = NLMSG_HDRLEN + sizeof(ifinfomsg); at < whole.size(); ++at) {
        std::vector<std::byte> broken = whole;
        broken[at] = std::byte{0xFF};
        CHECK(controller::parse_link(broken).there);
    }
}

TEST_CASE("this machine's kernel is asked: the loopback is no CAN, and what is not there is not there", "[RT-130]") {
    const CanLink lo = controller::can_link("lo");
    CHECK(lo.rejection.empty());
    CHECK(lo.there);
    CHECK_FALSE(lo.is_can);
    CHECK_FALSE(controller::can_link("nosuch0").there);
}
