// Which command goes out under which number, and what became of it.
#include "rig_bridge/modbus/command_tracker.hpp"

#include <limits>

#include "rig_bridge/modbus/backoff.hpp"
#include "rig_bridge/modbus/plc_address.hpp"
#include "tests/catch.hpp"

using namespace std::chrono_literals;
using rig::at;
using rig::Commanded;
using rig::modbus::CommandState;

namespace {

rig::CommandedValues speed(double mps) {
    rig::CommandedValues wanted{};
    at(wanted, Commanded::flywheel_speed_mps) = mps;
    return wanted;
}

struct Fixture {
    rig::RegisterMap map = rig::load_register_map("config/registers.toml");
    rig::modbus::CommandTracker tracker{map};

    /// The number under which what is due goes out; 0: nothing is due.
    std::uint16_t send() {
        const auto image = tracker.due();
        if (!image) return 0;
        tracker.sending(*image);
        return static_cast<std::uint16_t>(image->read(map.field(Commanded::commit)).value);
    }
};

}  // namespace

TEST_CASE("A wish is pending until its number is confirmed", "[BRG-030]") {
    Fixture d;
    CHECK(d.tracker.state() == CommandState::none);
    CHECK(d.send() == 0);
    d.tracker.want(speed(0.0), 1s);  // all zero is a wish, too
    CHECK(d.tracker.state() == CommandState::pending);
    CHECK(d.tracker.pending_s(3s) == 2.0);
    CHECK(d.send() == 1);
    CHECK(d.send() == 0);
    CHECK(d.tracker.state() == CommandState::pending);
    CHECK(d.tracker.pending_s(4s) == 3.0);
    d.tracker.seen(0, 0, 0s);
    CHECK(d.tracker.state() == CommandState::pending);
    d.tracker.seen(1, 0, 0s);
    CHECK(d.tracker.state() == CommandState::applied);
    CHECK(d.tracker.pending_s(9s) == 0.0);
}

TEST_CASE("Only what the registers would show differently is sent", "[BRG-030]") {
    Fixture d;
    d.tracker.want(speed(50.0), 1s);
    CHECK(d.send() == 1);
    d.tracker.seen(1, 0, 0s);
    auto same = speed(50.0 + 1e-9);  // no other float32
    at(same, Commanded::bridge_watchdog) = 77.0;
    at(same, Commanded::commit) = 9.0;
    d.tracker.want(same, 2s);
    CHECK(d.tracker.state() == CommandState::applied);
    CHECK(d.send() == 0);
    d.tracker.want(speed(50.1), 3s);
    CHECK(d.tracker.state() == CommandState::pending);
    CHECK(d.send() == 2);
}

TEST_CASE("A newer wish does not wait for the older one's answer, and is as late as that", "[BRG-030]") {
    Fixture d;
    d.tracker.want(speed(10.0), 1s);
    const auto first = d.tracker.due();
    REQUIRE(first);
    d.tracker.want(speed(20.0), 2s);  // while the first is being written
    d.tracker.sending(*first);
    CHECK(d.tracker.pending_s(3s) == 2.0);
    CHECK(d.send() == 2);
    d.tracker.seen(1, 0, 0s);
    CHECK(d.tracker.state() == CommandState::pending);
    CHECK(d.tracker.pending_s(3s) == 2.0);
    d.tracker.seen(2, 0, 0s);
    CHECK(d.tracker.state() == CommandState::applied);

    // Confirmed before the newer one goes out: that one's own time counts.
    d.tracker.want(speed(30.0), 10s);
    const auto third = d.tracker.due();
    d.tracker.want(speed(40.0), 12s);
    d.tracker.sending(*third);
    d.tracker.seen(3, 0, 0s);
    CHECK(d.tracker.pending_s(13s) == 1.0);
}

TEST_CASE("A refused command is not repeated, a changed one is sent", "[BRG-030]") {
    Fixture d;
    d.tracker.want(speed(10.0), 1s);
    CHECK(d.send() == 1);
    d.tracker.seen(0, 1, 0s);
    CHECK(d.tracker.state() == CommandState::rejected);
    d.tracker.want(speed(10.0), 2s);
    CHECK(d.tracker.state() == CommandState::rejected);
    CHECK(d.send() == 0);
    d.tracker.want(speed(11.0), 3s);
    CHECK(d.tracker.state() == CommandState::pending);
    CHECK(d.send() == 2);
    d.tracker.seen(2, 1, 0s);
    CHECK(d.tracker.state() == CommandState::applied);
}

TEST_CASE("What cannot be sent is named, and nothing older is sent in its place", "[BRG-030]") {
    Fixture d;
    d.tracker.want(speed(10.0), 1s);
    auto bad = speed(101.0);
    d.tracker.want(bad, 2s);
    CHECK(d.tracker.state() == CommandState::unsendable);
    CHECK(d.tracker.error() == "flywheel_speed: 101 m/s is out of range 0 to 100");
    CHECK(d.send() == 0);
    d.tracker.want(speed(std::numeric_limits<double>::quiet_NaN()), 2s);
    CHECK(d.tracker.error() == "flywheel_speed: not a number");
    bad = speed(10.0);
    at(bad, Commanded::drive_enable) = 2.0;
    d.tracker.want(bad, 2s);
    CHECK(d.tracker.error() == "drive_enable: 2 is out of range 0 to 1");
    bad = speed(10.0);
    at(bad, Commanded::load_base_N) = -1.0;
    d.tracker.want(bad, 2s);
    CHECK(d.tracker.error() == "load_base: -1 N is out of range 0 to 100000");
    d.tracker.want(speed(10.0), 3s);
    CHECK(d.tracker.error().empty());
    CHECK(d.send() == 1);
}

TEST_CASE("After a reconnection the newest wish goes out again under a new number", "[BRG-030]") {
    Fixture d;
    d.tracker.reconnected(41, 1s);
    CHECK(d.send() == 0);  // nobody has asked for anything
    d.tracker.want(speed(10.0), 2s);
    CHECK(d.send() == 42);
    d.tracker.seen(42, 0, 0s);
    CHECK(d.tracker.state() == CommandState::applied);

    d.tracker.reconnected(0, 5s);  // a PLC that was restarted
    CHECK(d.tracker.state() == CommandState::pending);
    CHECK(d.tracker.pending_s(6s) == 1.0);
    d.tracker.seen(0, 0, 0s);
    CHECK(d.send() == 43);
    CHECK(d.tracker.state() == CommandState::pending);
    d.tracker.seen(43, 0, 0s);
    CHECK(d.tracker.state() == CommandState::applied);
}

TEST_CASE("Commit numbers wrap around without 0 and without one that already has an answer", "[BRG-030]") {
    Fixture d;
    d.tracker.reconnected(65534, 1s);
    d.tracker.want(speed(1.0), 1s);
    CHECK(d.send() == 65535);
    d.tracker.seen(65535, 2, 0s);
    d.tracker.want(speed(2.0), 2s);
    CHECK(d.send() == 1);
    d.tracker.seen(1, 2, 0s);
    d.tracker.want(speed(3.0), 3s);
    CHECK(d.send() == 3);  // 2 was refused in the last round
    CHECK(d.tracker.state() == CommandState::pending);
}

TEST_CASE("A number that is none of ours is somebody else's command: counted, and answered by ours", "[BRG-136]") {
    Fixture d;
    d.tracker.seen(41, 7, 1s);  // what an earlier bridge left
    CHECK(d.tracker.foreign_commands() == 0);
    d.tracker.want(speed(10.0), 1s);
    CHECK(d.send() == 1);
    d.tracker.seen(41, 7, 1s);
    d.tracker.seen(1, 7, 1s);
    CHECK(d.tracker.foreign_commands() == 0);
    CHECK(d.tracker.state() == CommandState::applied);

    std::uint16_t rejected = 7;
    SECTION("taken over") {
        d.tracker.seen(900, 7, 5s);
        CHECK(d.tracker.foreign_commit() == 900);
    }
    SECTION("rejected") {
        rejected = 900;
        d.tracker.seen(1, rejected, 5s);
        CHECK(d.tracker.foreign_commit() == 900);
    }
    SECTION("under a number that was ours before") {
        d.tracker.want(speed(20.0), 2s);
        CHECK(d.send() == 2);
        d.tracker.seen(2, 7, 3s);
        d.tracker.seen(1, 7, 5s);
        CHECK(d.tracker.foreign_commit() == 1);
    }
    CHECK(d.tracker.foreign_commands() == 1);
    CHECK(d.tracker.state() == CommandState::pending);
    CHECK(d.tracker.pending_s(6s) == 1.0);
    const std::uint16_t again = d.send();
    CHECK(again > 1);
    d.tracker.seen(again, rejected, 6s);
    CHECK(d.tracker.state() == CommandState::applied);
    CHECK(d.tracker.foreign_commands() == 1);
}

TEST_CASE("Somebody else's command that ours replaces before the PLC answers it is counted once", "[BRG-136]") {
    Fixture d;
    d.tracker.reconnected(41, 1s);
    d.tracker.seen(41, 0, 1s);
    d.tracker.want(speed(10.0), 1s);
    d.tracker.register_holds(41);
    CHECK(d.tracker.foreign_commands() == 0);
    CHECK(d.send() == 42);
    d.tracker.register_holds(42);
    d.tracker.register_holds(0);  // a PLC that clears what it took
    CHECK(d.tracker.foreign_commands() == 0);

    d.tracker.want(speed(20.0), 2s);
    d.tracker.register_holds(4711);
    CHECK(d.tracker.foreign_commands() == 1);
    CHECK(d.tracker.foreign_commit() == 4711);
    d.tracker.register_holds(4711);
    CHECK(d.send() == 43);
    SECTION("the PLC looks at ours alone") {}
    SECTION("the PLC takes it over for a moment") {
        d.tracker.seen(4711, 0, 2s);
    }
    d.tracker.register_holds(43);
    d.tracker.seen(43, 0, 3s);
    CHECK(d.tracker.state() == CommandState::applied);
    CHECK(d.tracker.foreign_commands() == 1);
    d.tracker.seen(4711, 0, 4s);  // the same number, once more
    CHECK(d.tracker.foreign_commands() == 2);
}

TEST_CASE("Ours is ours where somebody else's was between it and the PLC's answer", "[BRG-136]") {
    Fixture d;
    d.tracker.reconnected(41, 1s);
    d.tracker.seen(41, 0, 1s);
    d.tracker.want(speed(10.0), 1s);
    d.tracker.register_holds(41);
    CHECK(d.send() == 42);
    SECTION("written after the register was read, and taken over before ours") {
        d.tracker.seen(4711, 0, 2s);
        d.tracker.register_holds(42);
    }
    SECTION("found in the register while a slow PLC still answers the one before") {
        d.tracker.want(speed(20.0), 2s);
        d.tracker.register_holds(4711);
        CHECK(d.send() == 43);
        d.tracker.seen(42, 0, 2s);
        d.tracker.seen(4711, 0, 3s);
        d.tracker.register_holds(43);
    }
    CHECK(d.tracker.foreign_commands() == 1);
    CHECK(d.tracker.foreign_commit() == 4711);
}

TEST_CASE("Ours that a slow PLC passes over, and a PLC that begins anew, are nobody else's", "[BRG-136]") {
    Fixture d;
    d.tracker.seen(0, 0, 1s);
    for (int i = 1; i <= 5; ++i) {
        d.tracker.want(speed(i), 1s);
        CHECK(d.send() == i);
    }
    d.tracker.seen(3, 2, 1s);  // refused the second, saw neither the first nor yet the last
    d.tracker.seen(5, 2, 1s);
    CHECK(d.tracker.state() == CommandState::applied);
    d.tracker.seen(0, 0, 1s);  // restarted
    CHECK(d.tracker.foreign_commands() == 0);
    d.tracker.reconnected(77, 2s);
    d.tracker.seen(77, 0, 2s);  // whoever commanded while the link was down: it is commanded anew anyway
    CHECK(d.tracker.foreign_commands() == 0);
    CHECK(d.send() == 78);
}

TEST_CASE("Waits between attempts double up to their bound and start anew after success", "[BRG-030]") {
    rig::modbus::Backoff backoff(100ms, 1s);
    CHECK(backoff.next() == 100ms);
    CHECK(backoff.next() == 200ms);
    CHECK(backoff.next() == 400ms);
    CHECK(backoff.next() == 800ms);
    CHECK(backoff.next() == 1s);
    CHECK(backoff.next() == 1s);
    backoff.reset();
    CHECK(backoff.next() == 100ms);
    rig::modbus::Backoff constant(50ms, 50ms);
    CHECK(constant.next() == 50ms);
    CHECK(constant.next() == 50ms);
}

TEST_CASE("A PLC address is a numeric host, with or without port, or a device", "[BRG-034]") {
    const auto tcp = [](const std::string& text) { return std::get<rig::modbus::TcpServer>(rig::modbus::parse_plc_address(text)); };
    CHECK(tcp("192.168.1.10:1502").address == "192.168.1.10");
    CHECK(tcp("192.168.1.10:1502").port == 1502);
    CHECK(tcp("10.0.0.1").port == 502);
    CHECK(std::get<rig::modbus::SerialDevice>(rig::modbus::parse_plc_address("/dev/ttyUSB0")).path == "/dev/ttyUSB0");
    for (const std::string wrong :
         {"", "plc.local:502", "1.2.3:502", "1.2.3.4:", "1.2.3.4:0", "1.2.3.4:65536", "1.2.3.4:5x", "1.2.3.4:502:1", "ttyUSB0", "[::1]:502"}) {
        CAPTURE(wrong);
        CHECK_THROWS_WITH(rig::modbus::parse_plc_address(wrong), ContainsSubstring("'" + wrong + "'"));
    }
    CHECK(rig::modbus::numeric_plc_address("localhost:1502") == "127.0.0.1:1502");
    CHECK(rig::modbus::numeric_plc_address("10.0.0.1:502") == "10.0.0.1:502");
    CHECK_THROWS_WITH(rig::modbus::numeric_plc_address("plc 7:502"), ContainsSubstring("'plc 7:502'"));
    CHECK(rig::modbus::to_string(rig::modbus::parse_plc_address("10.0.0.1")) == "Modbus TCP 10.0.0.1:502");
    CHECK(rig::modbus::to_string(rig::modbus::parse_plc_address("/dev/ttyS1")) == "Modbus RTU /dev/ttyS1");
}
