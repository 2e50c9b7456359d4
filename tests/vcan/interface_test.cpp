// SocketCAN and an interface that is not there, down or gone, with real AF_CAN sockets.
#include "firmware/can/socket_can.hpp"

#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/can/roles.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"
#include "tests/vcan/real_bus.hpp"

using namespace antiskid;
using namespace antiskid::can;
using namespace real_bus;

TEST_CASE("an interface that cannot be used is refused with the command that mends it", "[CAN-080]") {
    CHECK_THROWS_WITH(SocketCan("vcan77", kWanted),
                      ContainsSubstring("CAN interface 'vcan77' does not exist") && ContainsSubstring("ip link add dev vcan77 type vcan"));
    CHECK_THROWS_WITH(SocketCan("can77", kWanted),
                      ContainsSubstring("'can77' does not exist") && ContainsSubstring("ip link set can77 up type can bitrate 1000000"));
    CHECK_THROWS_WITH(SocketCan("lo", kWanted), ContainsSubstring("'lo' is no CAN interface"));
    CHECK_THROWS_WITH(SocketCan("", kWanted), ContainsSubstring("is no interface name"));
    CHECK_THROWS_WITH(SocketCan("sixteen-letters.", kWanted), ContainsSubstring("1 to 15 characters"));
    const Interface down("vcan5");
    shell("ip link set vcan5 down");
    CHECK_THROWS_WITH(SocketCan("vcan5", kWanted), ContainsSubstring("'vcan5' is down") && ContainsSubstring("`ip link set vcan5 up`"));
}

TEST_CASE("an interface that goes down is reported, and used again when it comes up", "[CAN-080]") {
    const Interface fragile("vcan4");
    SocketCan a("vcan4", kWanted);
    SocketCan b("vcan4", kWanted);
    for (int round = 0; round < 2; ++round) {
        REQUIRE(a.send(numbered(0x110, 1)));
        CHECK(await(b, 1).size() == 1);
        shell("ip link set vcan4 down");
        CHECK(await_status(b, [](const auto& status) { return !status.up; }));
        CHECK_FALSE(b.status().bus_off);
        CHECK_FALSE(a.send(numbered(0x110, 2)));
        CHECK_FALSE(a.status().up);
        shell("ip link set vcan4 up");
        CHECK(a.send(numbered(0x110, 3)));
        CHECK(a.status().up);
        const std::vector<Frame> frames = await(b, 1);
        REQUIRE(frames.size() == 1);
        CHECK(number_of(frames[0]) == 3);
        CHECK(b.status().up);
    }
}

TEST_CASE("an interface that vanishes is reported for good", "[CAN-080]") {
    const Interface fragile("vcan3");
    SocketCan bus("vcan3", kWanted);
    shell("ip link del vcan3");
    CHECK(await_status(bus, [](const auto& status) { return !status.up; }));
    shell("ip link add dev vcan3 type vcan && ip link set vcan3 up");
    for (int i = 0; i < 3; ++i) {
        CHECK_FALSE(bus.send(numbered(0x110, 1)));
        CHECK(drain(bus).empty());
        CHECK_FALSE(bus.status().up);
    }
}
