// What a client must survive, and must never believe.
#include <cmath>

#include "rig_bridge/modbus/client.hpp"
#include "tests/catch.hpp"
#include "tests/modbus/fake_plc.hpp"
#include "tests/modbus/plc_stub.hpp"

using namespace std::chrono_literals;
using fake::Bytes;
using fake::Request;
using rig::Measured;
using rig::modbus::LinkState;
using stub::eventually;

namespace {

constexpr float kTruth = 10.0F;
constexpr float kPoison = 99.0F;

rig::RegisterMap impatient() {
    auto map = stub::shipped_map();
    map.link.poll = 2ms;
    map.link.response_timeout = 60ms;
    map.link.backoff_min = 1ms;
    map.link.backoff_max = 8ms;
    return map;
}

/// Where the float at registers 10 and 11 stands in the frame of an answer to a reading of all inputs.
constexpr std::size_t kTcpSpeed = 7 + 2 + 20;
constexpr std::size_t kRtuSpeed = 1 + 2 + 20;

Bytes with_speed(Bytes frame, std::size_t at, float value) {
    const Bytes bytes = fake::big_float(value);
    std::copy(bytes.begin(), bytes.end(), frame.begin() + static_cast<std::ptrdiff_t>(at));
    return frame;
}

bool is_poll(const Request& request) {
    return request.honest.size() > 40;
}

/// Every `nth` poll is spoilt by `spoil`, the others are honest; the client must go on, with true values only.
void check_only_truth(const std::string& expected_error, const fake::Manners& spoil) {
    std::atomic<int> polls{0};
    fake::TcpPlc plc(
        [&](const Request& request) {
            if (!is_poll(request) || ++polls % 3 != 0) return fake::honest(request);
            return spoil(request);
        },
        kTruth);
    const rig::modbus::ModbusClient client(impatient(), rig::modbus::TcpServer{"127.0.0.1", plc.port()});
    bool believed = false;
    std::string error;
    REQUIRE(eventually([&] {
        const auto now = client.snapshot();
        const double speed = now.value(Measured::flywheel_speed_mps);
        believed = believed || !(std::isnan(speed) || speed == kTruth);
        // Not only the newest error: on a busy machine an honest answer may be late, too.
        if (now.error.find("input registers 0 to 19") != std::string::npos && now.error.find(expected_error) != std::string::npos) error = now.error;
        return polls > 20 && now.counters.connects >= 5 && !error.empty();
    }));
    CHECK_FALSE(believed);
    CHECK_THAT(error, ContainsSubstring("127.0.0.1:" + std::to_string(plc.port())));
    REQUIRE(eventually([&] { return client.snapshot().link == LinkState::connected; }));
}

}  // namespace

TEST_CASE("Nobody at the address: named, tried again, nothing believed", "[BRG-034]") {
    std::uint16_t port = 0;
    { port = rig::modbus::ModbusServer(stub::shipped_map(), {}).port(); }  // free again now
    const rig::modbus::ModbusClient client(impatient(), rig::modbus::TcpServer{"127.0.0.1", port});
    REQUIRE(eventually([&] { return client.snapshot().counters.failed_connects >= 5; }));
    const auto now = client.snapshot();
    CHECK(now.link == LinkState::connecting);
    CHECK_THAT(now.error, ContainsSubstring("127.0.0.1:" + std::to_string(port)) && ContainsSubstring("refused"));
    CHECK(std::isnan(now.value(Measured::flywheel_speed_mps)));
    CHECK(std::isinf(now.age_s[0]));
    CHECK(std::isinf(now.plc_watchdog_age_s));
    CHECK_FALSE(now.fresh(Measured::flywheel_speed_mps, 1e9));
}

TEST_CASE("The client waits between attempts, longer each time, also where a connection opens and is useless", "[BRG-030]") {
    auto map = impatient();
    map.link.backoff_min = 20ms;
    map.link.backoff_max = 80ms;
    const auto begin = std::chrono::steady_clock::now();
    SECTION("nobody there") {
        std::uint16_t port = 0;
        { port = rig::modbus::ModbusServer(stub::shipped_map(), {}).port(); }
        const rig::modbus::ModbusClient client(map, rig::modbus::TcpServer{"127.0.0.1", port});
        REQUIRE(eventually([&] { return client.snapshot().counters.failed_connects >= 5; }));
    }
    SECTION("closed at the first request") {
        fake::TcpPlc plc([](const Request&) { return false; });
        const rig::modbus::ModbusClient client(map, rig::modbus::TcpServer{"127.0.0.1", plc.port()});
        REQUIRE(eventually([&] { return plc.requests() >= 5; }));
    }
    SECTION("closed at the poll") {
        fake::TcpPlc plc([](const Request& request) { return !is_poll(request) && fake::honest(request); });
        const rig::modbus::ModbusClient client(map, rig::modbus::TcpServer{"127.0.0.1", plc.port()});
        REQUIRE(eventually([&] { return client.snapshot().counters.connects >= 5; }));
    }
    CHECK(std::chrono::steady_clock::now() - begin >= 20ms + 40ms + 80ms + 80ms);
}

TEST_CASE("A server that accepts and never answers", "[BRG-034]") {
    fake::TcpPlc plc([](const Request&) { return true; });
    const rig::modbus::ModbusClient client(impatient(), rig::modbus::TcpServer{"127.0.0.1", plc.port()});
    REQUIRE(eventually([&] { return client.snapshot().counters.timeouts >= 4; }));
    const auto now = client.snapshot();
    CHECK(now.link == LinkState::connecting);
    CHECK_THAT(now.error, ContainsSubstring("no answer within 60 ms"));
    CHECK(now.counters.polls == 0);
    CHECK(plc.connections() >= 4);  // every time-out closes its connection
}

TEST_CASE("Values grow old when the server falls silent", "[BRG-034]") {
    std::atomic<bool> silent{false};
    fake::TcpPlc plc([&](const Request& request) { return silent || fake::honest(request); }, kTruth);
    const rig::modbus::ModbusClient client(impatient(), rig::modbus::TcpServer{"127.0.0.1", plc.port()});
    REQUIRE(eventually([&] { return client.snapshot().fresh(Measured::flywheel_speed_mps, 60.0); }));
    silent = true;
    REQUIRE(eventually([&] { return client.snapshot().link == LinkState::lost; }));
    const double before = client.snapshot().age_s[0];
    REQUIRE(eventually([&] { return client.snapshot().age_s[0] > before + 0.1; }));
    CHECK(client.snapshot().value(Measured::flywheel_speed_mps) == kTruth);
    CHECK_FALSE(client.snapshot().fresh(Measured::flywheel_speed_mps, 0.1));
    silent = false;
    REQUIRE(eventually([&] { return client.snapshot().link == LinkState::connected; }));
}

TEST_CASE("An answer that comes after the time-out is never believed", "[BRG-034]") {
    check_only_truth("no answer within 60 ms", [](const Request& request) {
        std::this_thread::sleep_for(90ms);
        raw::send(request.line, with_speed(request.honest, kTcpSpeed, kPoison));
        return true;
    });
}

TEST_CASE("A late answer is not believed even under the number of the next request", "[BRG-034]") {
    check_only_truth("no answer within 60 ms", [](const Request& request) {
        std::this_thread::sleep_for(90ms);
        Bytes answer = with_speed(request.honest, kTcpSpeed, kPoison);
        for (int i = 0; i < 4; ++i) {
            ++answer[1];
            raw::send(request.line, answer);
        }
        return true;
    });
}

TEST_CASE("An answer that trickles in is given up in time", "[BRG-034]") {
    check_only_truth("no answer within 60 ms", [](const Request& request) {
        for (const std::uint8_t byte : with_speed(request.honest, kTcpSpeed, kPoison)) {
            raw::send(request.line, {byte});
            std::this_thread::sleep_for(5ms);
        }
        return true;
    });
}

TEST_CASE("Answers to something else are not believed", "[BRG-034]") {
    const auto spoilt = [](std::size_t at, std::uint8_t flip) {
        return [at, flip](const Request& request) {
            Bytes answer = with_speed(request.honest, kTcpSpeed, kPoison);
            answer[at] ^= flip;
            raw::send(request.line, answer);
            return true;
        };
    };
    SECTION("transaction number, low byte") {
        check_only_truth("with transaction", spoilt(1, 1));
    }
    SECTION("transaction number, high byte") {
        check_only_truth("with transaction", spoilt(0, 0x80));
    }
    SECTION("protocol") {
        check_only_truth("with protocol 1, expected 0", spoilt(3, 1));
    }
    SECTION("length") {
        check_only_truth("with length 45, expected 43", spoilt(5, 6));
    }
    SECTION("unit") {
        check_only_truth("with unit 9, expected 1", spoilt(6, 8));
    }
    SECTION("function code") {
        check_only_truth("with function 3, expected 4", spoilt(7, 7));
    }
    SECTION("fewer registers") {
        check_only_truth("with length", spoilt(8, 8));
    }
}

TEST_CASE("Frames that are cut off are not believed", "[BRG-034]") {
    const auto cut = [](std::size_t length) {
        return [length](const Request& request) {
            Bytes answer = with_speed(request.honest, kTcpSpeed, kPoison);
            answer.resize(length);
            raw::send(request.line, answer);
            return false;  // and the connection closed
        };
    };
    SECTION("in the header") {
        check_only_truth("reset", cut(4));
    }
    SECTION("before the values") {
        check_only_truth("reset", cut(9));
    }
    SECTION("in the values") {
        check_only_truth("reset", cut(35));
    }
    SECTION("at once") {
        check_only_truth("reset", cut(0));
    }
    SECTION("and left open") {
        check_only_truth("no answer within 60 ms", [](const Request& request) {
            raw::send(request.line, {request.honest.begin(), request.honest.begin() + 35});
            return true;
        });
    }
}

TEST_CASE("Answers that nobody asked for are not taken for the next one's", "[BRG-034]") {
    check_only_truth("with transaction", [](const Request& request) {
        raw::send(request.line, request.honest);
        raw::send(request.line, with_speed(request.honest, kTcpSpeed, kPoison));
        return true;
    });
}

TEST_CASE("The confirmation of another write is not believed", "[BRG-034]") {
    const auto at = GENERATE(std::size_t{9}, std::size_t{11});  // low bytes of address and count
    std::atomic<bool> spoil{true};
    fake::TcpPlc plc([&](const Request& request) {
        Bytes answer = request.honest;
        if (spoil && answer[7] == 16) answer[at] ^= 2;
        raw::send(request.line, answer);
        return true;
    });
    rig::modbus::ModbusClient client(impatient(), rig::modbus::TcpServer{"127.0.0.1", plc.port()});
    REQUIRE(eventually([&] {
        client.command({});
        return client.snapshot().error.find("confirmation of another write") != std::string::npos;
    }));
    CHECK(client.snapshot().command == rig::modbus::CommandState::pending);
    spoil = false;
    REQUIRE(eventually([&] {
        client.command({});
        return client.snapshot().command == rig::modbus::CommandState::applied;
    }));
}

TEST_CASE("Exceptions are named with the registers they concern", "[BRG-030]") {
    check_only_truth("exception 2, illegal data address", [](const Request& request) {
        Bytes answer(request.honest.begin(), request.honest.begin() + 9);
        answer[5] = 3;
        answer[7] |= 0x80;
        answer[8] = 2;
        raw::send(request.line, answer);
        return true;
    });
}

TEST_CASE("On a serial line late answers are not believed either", "[BRG-034]") {
    // Later than the time-out, than the quiet that follows, and than the first question after that.
    const auto late = GENERATE(90ms, 140ms, 200ms, 330ms);
    CAPTURE(late.count());
    std::atomic<int> polls{0};
    fake::RtuPlc plc(
        [&](const Request& request) {
            if (is_poll(request) && ++polls % 4 == 0) {
                std::this_thread::sleep_for(late);
                Bytes answer = with_speed(request.honest, kRtuSpeed, kPoison);
                answer.resize(answer.size() - 2);
                fake::RtuPlc::write(request.line, fake::with_crc(answer));
            } else {
                fake::RtuPlc::write(request.line, request.honest);
            }
            return true;
        },
        kTruth);
    const rig::modbus::ModbusClient client(impatient(), rig::modbus::SerialDevice{plc.path()});
    bool believed = false;
    REQUIRE(eventually([&] {
        const auto now = client.snapshot();
        const double speed = now.value(Measured::flywheel_speed_mps);
        believed = believed || !(std::isnan(speed) || speed == kTruth);
        return polls >= 12 && now.counters.connects >= 3;
    }));
    CHECK_FALSE(believed);
    CHECK_THAT(client.snapshot().error, ContainsSubstring(plc.path()));
}

TEST_CASE("On a serial line a wrong checksum or unit is not believed", "[BRG-034]") {
    const bool unit = GENERATE(false, true);
    std::atomic<int> polls{0};
    fake::RtuPlc plc(
        [&](const Request& request) {
            Bytes answer = request.honest;
            if (is_poll(request) && ++polls % 3 == 0) {
                answer = with_speed(request.honest, kRtuSpeed, kPoison);
                if (unit) {
                    answer[0] = 9;
                    answer.resize(answer.size() - 2);
                    answer = fake::with_crc(answer);
                }
            }
            fake::RtuPlc::write(request.line, answer);
            return true;
        },
        kTruth);
    const rig::modbus::ModbusClient client(impatient(), rig::modbus::SerialDevice{plc.path()});
    bool believed = false, named = false;
    REQUIRE(eventually([&] {
        const auto now = client.snapshot();
        const double speed = now.value(Measured::flywheel_speed_mps);
        believed = believed || !(std::isnan(speed) || speed == kTruth);
        // Not only the newest error: on a busy machine an honest answer may be late, too.
        named = named || now.error.find(unit ? "another unit" : "checksum") != std::string::npos;
        return named && polls >= 10 && now.counters.connects >= 3;
    }));
    CHECK_FALSE(believed);
}

TEST_CASE("The checksum of the serial fake is the published one", "[BRG-034]") {
    CHECK(fake::crc16({'1', '2', '3', '4', '5', '6', '7', '8', '9'}) == 0x4B37);
}

TEST_CASE("A serial device that is not there is named", "[BRG-034]") {
    const rig::modbus::ModbusClient client(impatient(), rig::modbus::SerialDevice{"/dev/no-such-line"});
    REQUIRE(eventually([&] { return client.snapshot().counters.failed_connects >= 2; }));
    CHECK_THAT(client.snapshot().error, ContainsSubstring("/dev/no-such-line") && ContainsSubstring("No such file"));
}

TEST_CASE("A line that never falls silent is given up", "[BRG-034]") {
    const rig::modbus::PseudoTerminal terminal;
    std::atomic<bool> stop{false};
    std::thread noise([&] {
        while (!stop) {
            fake::RtuPlc::write(terminal.master(), {0x55, 0xAA});
            std::this_thread::sleep_for(2ms);
        }
    });
    {
        const rig::modbus::ModbusClient client(impatient(), rig::modbus::SerialDevice{terminal.path()});
        CHECK(eventually([&] { return client.snapshot().error.find("never quiet") != std::string::npos; }));
    }
    stop = true;
    noise.join();
}
