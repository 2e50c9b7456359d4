// The server, asked byte by byte: what the Modbus specification V1.1b3 prescribes, and what nobody should send.
#include "rig_bridge/modbus/server.hpp"

#include <cmath>
#include <limits>
#include <mutex>

#include "tests/catch.hpp"
#include "tests/modbus/plc_stub.hpp"
#include "tests/modbus/raw_tcp.hpp"

using namespace std::chrono_literals;
using raw::Bytes;
using rig::at;
using rig::Commanded;
using rig::Measured;
using stub::eventually;

namespace {

/// A server and one exchange with it.
struct Bench {
    rig::RegisterMap map = stub::shipped_map();
    rig::modbus::ModbusServer server{map, {}};
    rig::MeasuredValues measured{};

    Bench() {
        at(measured, Measured::plc_watchdog) = 0x0102;
        at(measured, Measured::brake_temperature_C) = -12.3;
        at(measured, Measured::flywheel_speed_mps) = 1.0;
        exchange();
    }
    rig::modbus::PlcCommands exchange() { return server.exchange(measured); }
};

Bytes exception(std::uint8_t function, std::uint8_t code) {
    return {static_cast<std::uint8_t>(function | 0x80U), code};
}

}  // namespace

TEST_CASE("Function codes answer as the specification says", "[BRG-020]") {
    Bench bench;
    const raw::Client client(bench.server.port());
    // 4: read input registers 0 to 2
    CHECK(client.ask({4, 0, 0, 0, 3}) == Bytes{4, 6, 0, 1, 1, 2, 0, 0});
    // i16 at 7: -123; float32 at 10: 3F80 0000
    CHECK(client.ask({4, 0, 7, 0, 1}) == Bytes{4, 2, 0xFF, 0x85});
    CHECK(client.ask({4, 0, 10, 0, 2}) == Bytes{4, 4, 0x3F, 0x80, 0, 0});
    // 6: write one; 3: read it back
    CHECK(client.ask({6, 0, 2, 0, 1}) == Bytes{6, 0, 2, 0, 1});
    CHECK(client.ask({3, 0, 2, 0, 1}) == Bytes{3, 2, 0, 1});
    // 16: write two; 3: read them
    CHECK(client.ask({16, 0, 5, 0, 2, 4, 0x42, 0x48, 0, 0}) == Bytes{16, 0, 5, 0, 2});
    CHECK(client.ask({3, 0, 5, 0, 2}) == Bytes{3, 4, 0x42, 0x48, 0, 0});
    // 22: and 0x00F2, or 0x0025, on 0x0012: the specification's own example gives 0x0017
    CHECK(client.ask({6, 0, 0, 0, 0x12}) == Bytes{6, 0, 0, 0, 0x12});
    CHECK(client.ask({22, 0, 0, 0, 0xF2, 0, 0x25}) == Bytes{22, 0, 0, 0, 0xF2, 0, 0x25});
    CHECK(client.ask({3, 0, 0, 0, 1}) == Bytes{3, 2, 0, 0x17});
    // 23: write 1 to 0, and read 0 to 1 back afterwards
    CHECK(client.ask({23, 0, 0, 0, 2, 0, 0, 0, 1, 2, 0xAB, 0xCD}) == Bytes{23, 4, 0xAB, 0xCD, 0, 0});
}

TEST_CASE("Illegal functions, values and addresses get their exceptions and change nothing", "[BRG-020]") {
    Bench bench;
    const raw::Client client(bench.server.port());
    for (unsigned function = 0; function < 128; ++function) {
        if (function == 3 || function == 4 || function == 6 || function == 16 || function == 22 || function == 23) continue;
        CAPTURE(function);
        const auto code = static_cast<std::uint8_t>(function);
        CHECK(client.ask({code, 0, 0, 0, 1}) == exception(code, 1));
    }
    // addresses: one past the end, across the end, in the hole, wrapping around
    CHECK(client.ask({4, 0, 20, 0, 1}) == exception(4, 2));
    CHECK(client.ask({4, 0, 19, 0, 2}) == exception(4, 2));
    CHECK(client.ask({4, 0xFF, 0xFF, 0, 2}) == exception(4, 2));
    CHECK(client.ask({3, 0, 11, 0, 2}) == exception(3, 2));
    CHECK(client.ask({3, 0, 50, 0, 1}) == exception(3, 2));
    CHECK(client.ask({6, 0, 12, 0, 1}) == exception(6, 2));
    CHECK(client.ask({16, 0, 11, 0, 2, 4, 0, 1, 0, 1}) == exception(16, 2));
    CHECK(client.ask({22, 0, 60, 0, 0, 0, 0}) == exception(22, 2));
    CHECK(client.ask({23, 0, 99, 0, 1, 0, 0, 0, 1, 2, 0, 7}) == exception(23, 2));
    CHECK(client.ask({23, 0, 0, 0, 1, 0, 99, 0, 1, 2, 0, 7}) == exception(23, 2));
    // counts and lengths
    CHECK(client.ask({4, 0, 0, 0, 0}) == exception(4, 3));
    CHECK(client.ask({4, 0, 0, 0, 126}) == exception(4, 3));
    CHECK(client.ask({4, 0, 0, 0, 125}) == exception(4, 2));
    CHECK(client.ask({4, 0, 0, 0}) == exception(4, 3));
    CHECK(client.ask({4, 0, 0, 0, 1, 0}) == exception(4, 3));
    CHECK(client.ask({6, 0, 0, 0}) == exception(6, 3));
    CHECK(client.ask({16, 0, 0, 0, 0, 0}) == exception(16, 3));
    CHECK(client.ask({16, 0, 0, 0, 2, 4, 0, 1}) == exception(16, 3));
    CHECK(client.ask({16, 0, 0, 0, 1, 4, 0, 1, 0, 1}) == exception(16, 3));
    CHECK(client.ask({16, 0}) == exception(16, 3));
    CHECK(client.ask({22, 0, 0}) == exception(22, 3));
    CHECK(client.ask({23, 0, 0, 0, 0, 0, 0, 0, 1, 2, 0, 7}) == exception(23, 3));
    CHECK(client.ask({23, 0, 0, 0, 1, 0, 0, 0, 2, 2, 0, 7}) == exception(23, 3));
    CHECK(client.ask({23}) == exception(23, 3));

    CHECK(client.ask({3, 0, 0, 0, 12}) == Bytes{3, 24, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    CHECK(bench.server.counters().broken == 0);
}

TEST_CASE("Nothing but the watchdog takes effect before commit, everything does at it", "[BRG-020]") {
    Bench bench;
    const raw::Client client(bench.server.port());
    const auto wrote = [&](const Bytes& pdu) { return client.ask(pdu).size() == 5; };
    REQUIRE(wrote({6, 0, 2, 0, 1}));
    REQUIRE(wrote({16, 0, 5, 0, 2, 4, 0x42, 0x48, 0, 0}));  // 50 m/s
    REQUIRE(wrote({6, 0, 0, 0, 9}));
    REQUIRE(eventually([&] { return at(bench.exchange().commanded, Commanded::bridge_watchdog) == 9.0; }));
    CHECK(at(bench.exchange().commanded, Commanded::sledge_advance) == 0.0);
    CHECK(at(bench.exchange().commanded, Commanded::flywheel_speed_mps) == 0.0);

    REQUIRE(wrote({6, 0, 11, 0, 7}));
    REQUIRE(eventually([&] { return at(bench.exchange().commanded, Commanded::commit) == 7.0; }));
    CHECK(at(bench.exchange().commanded, Commanded::sledge_advance) == 1.0);
    CHECK(at(bench.exchange().commanded, Commanded::flywheel_speed_mps) == 50.0);

    // The same number again, and 0, commit nothing; nor does 0 make the old number new.
    REQUIRE(wrote({6, 0, 2, 0, 0}));
    REQUIRE(wrote({6, 0, 11, 0, 7}));
    REQUIRE(wrote({6, 0, 11, 0, 0}));
    REQUIRE(wrote({6, 0, 11, 0, 7}));
    REQUIRE(wrote({6, 0, 0, 0, 10}));
    REQUIRE(eventually([&] { return at(bench.exchange().commanded, Commanded::bridge_watchdog) == 10.0; }));
    CHECK(at(bench.exchange().commanded, Commanded::sledge_advance) == 1.0);

    // Values and commit in one request, and what no range holds: the PLC's business.
    REQUIRE(wrote({16, 0, 5, 0, 7, 14, 0x7F, 0xC0, 0, 0, 0xC7, 0xC3, 0x50, 0, 0, 0, 0, 0, 0, 8}));
    REQUIRE(eventually([&] { return at(bench.exchange().commanded, Commanded::commit) == 8.0; }));
    CHECK(std::isnan(at(bench.exchange().commanded, Commanded::flywheel_speed_mps)));
    CHECK(at(bench.exchange().commanded, Commanded::load_base_N) == -100000.0);
    CHECK(at(bench.exchange().commanded, Commanded::sledge_advance) == 0.0);
}

TEST_CASE("Interlocks can be forced open, at once and bit by bit", "[BRG-020]") {
    Bench bench;
    const raw::Client client(bench.server.port());
    CHECK(bench.exchange().open_interlocks == 0);
    REQUIRE(client.ask({6, 0, 100, 0xFF, 0b0110}).size() == 5);
    REQUIRE(eventually([&] { return bench.exchange().open_interlocks == 0b0110; }));
    REQUIRE(client.ask({6, 0, 100, 0, 0}).size() == 5);
    REQUIRE(eventually([&] { return bench.exchange().open_interlocks == 0; }));
}

TEST_CASE("The map version is the map's own, NaN leaves a register as it was", "[BRG-020]") {
    Bench bench;
    at(bench.measured, Measured::map_version) = 99.0;
    at(bench.measured, Measured::flywheel_speed_mps) = std::numeric_limits<double>::quiet_NaN();
    bench.exchange();
    const raw::Client client(bench.server.port());
    CHECK(client.ask({4, 0, 0, 0, 1}) == Bytes{4, 2, 0, 1});
    CHECK(client.ask({4, 0, 10, 0, 2}) == Bytes{4, 4, 0x3F, 0x80, 0, 0});
}

TEST_CASE("A hang begins with the next request, lasts its time, and ends with the late answer", "[BRG-020]") {
    Bench bench;
    const raw::Client client(bench.server.port());
    const raw::Client other(bench.server.port());
    REQUIRE(client.ask({6, 0, 101, 0, 30}).size() == 5);  // 0.3 s
    const auto begin = std::chrono::steady_clock::now();
    client.send({0, 1, 0, 0, 0, 6, 1, 4, 0, 0, 0, 1});
    REQUIRE(eventually([&] { return bench.server.counters().hangs == 1; }));
    other.send({0, 2, 0, 0, 0, 6, 1, 4, 0, 0, 0, 1});
    bench.exchange();  // the plant is not held up
    CHECK(client.receive() == Bytes{0, 1, 0, 0, 0, 5, 1, 4, 2, 0, 1});
    CHECK(std::chrono::steady_clock::now() - begin >= 300ms);
    CHECK(other.receive() == Bytes{0, 2, 0, 0, 0, 5, 1, 4, 2, 0, 1});
    CHECK(client.ask({3, 0, 101, 0, 1}) == Bytes{3, 2, 0, 0});
    CHECK(bench.server.counters().hangs == 1);
}

TEST_CASE("A server that hangs can be ended", "[BRG-020]") {
    const auto begin = std::chrono::steady_clock::now();
    {
        Bench bench;
        const raw::Client client(bench.server.port());
        REQUIRE(client.ask({6, 0, 101, 0xEA, 0x60}).size() == 5);  // 600 s
        client.send({0, 1, 0, 0, 0, 6, 1, 4, 0, 0, 0, 1});
        REQUIRE(eventually([&] { return bench.server.counters().hangs == 1; }));
    }
    CHECK(std::chrono::steady_clock::now() - begin < 300s);
}

TEST_CASE("Frames that are none close their connection and no other", "[BRG-020]") {
    Bench bench;
    const raw::Client good(bench.server.port());
    const Bytes frames[] = {
        {0, 1, 0, 1, 0, 6, 1, 4, 0, 0, 0, 1},    // protocol 1
        {0, 1, 0, 0, 0, 1, 1, 4, 0, 0, 0, 1},    // no room for a function code
        {0, 1, 0, 0, 0, 0, 1},                   // nor for the unit
        {0, 1, 0, 0, 0, 255, 1, 4, 0, 0, 0, 1},  // longer than any frame
        {0, 1, 0, 0, 255, 255, 1, 4, 0, 0, 0, 1},
        {'G', 'E', 'T', ' ', '/', ' ', 'H', 'T', 'T', 'P'},
    };
    std::uint64_t broken = 0;
    for (const auto& frame : frames) {
        const raw::Client bad(bench.server.port());
        bad.send(frame);
        CHECK(bad.receive().empty());  // closed: the wait ends at once
        CHECK(bench.server.counters().broken == ++broken);
        CHECK(good.ask({4, 0, 0, 0, 1}) == Bytes{4, 2, 0, 1});
    }
}

TEST_CASE("Requests may come in pieces, or several at once; half a request holds nobody up", "[BRG-020]") {
    Bench bench;
    const raw::Client slow(bench.server.port());
    const raw::Client good(bench.server.port());
    const Bytes request{0, 1, 0, 0, 0, 6, 1, 4, 0, 0, 0, 1};
    for (const std::uint8_t byte : request) {
        CHECK(good.ask({4, 0, 0, 0, 1}) == Bytes{4, 2, 0, 1});
        slow.send({byte});
    }
    CHECK(slow.receive() == Bytes{0, 1, 0, 0, 0, 5, 1, 4, 2, 0, 1});

    Bytes three;
    for (std::uint8_t i = 0; i < 3; ++i) {
        Bytes one(request);
        one[1] = i;
        three.insert(three.end(), one.begin(), one.end());
    }
    slow.send(three);
    Bytes answers;
    REQUIRE(eventually([&] {
        const Bytes part = slow.receive();
        answers.insert(answers.end(), part.begin(), part.end());
        return answers.size() >= 33;
    }));
    CHECK(answers == Bytes{0, 0, 0, 0, 0, 5, 1, 4, 2, 0, 1, 0, 1, 0, 0, 0, 5, 1, 4, 2, 0, 1, 0, 2, 0, 0, 0, 5, 1, 4, 2, 0, 1});
}

TEST_CASE("The number of clients is bounded; a place that becomes free is given away", "[BRG-020]") {
    const auto map = stub::shipped_map();
    const rig::modbus::ModbusServer server(map, {.clients = 2});
    auto first = std::make_unique<raw::Client>(server.port());
    CHECK(first->ask({4, 0, 0, 0, 1}).size() == 4);
    const raw::Client second(server.port());
    CHECK(second.ask({4, 0, 0, 0, 1}).size() == 4);
    const raw::Client third(server.port());
    CHECK(third.receive().empty());  // closed
    first.reset();
    REQUIRE(eventually([&] { return server.counters().clients == 1; }));
    const raw::Client fourth(server.port());
    CHECK(fourth.ask({4, 0, 0, 0, 1}).size() == 4);
}

TEST_CASE("Clients that only connect, or send half a request, keep nobody out", "[BRG-020]") {
    const auto map = stub::shipped_map();
    const rig::modbus::ModbusServer server(map, {.clients = 3, .idle = 50ms});
    const raw::Client working(server.port());
    const raw::Client silent(server.port());
    const raw::Client slow(server.port());
    slow.send({0, 1, 0, 0, 0, 6, 1, 4});  // half of it
    REQUIRE(eventually([&] { return server.counters().clients == 3; }));
    // One place after the other is given away, never that of the client that asks.
    std::vector<std::unique_ptr<raw::Client>> kept;
    CHECK(eventually([&] {
        CHECK(working.ask({4, 0, 0, 0, 1}).size() == 4);
        auto next = std::make_unique<raw::Client>(server.port());
        const bool served = next->ask({4, 0, 0, 0, 1}).size() == 4;
        if (served) kept.push_back(std::move(next));
        return kept.size() == 2;
    }));
    CHECK(silent.receive().empty());
    CHECK(slow.receive().empty());
    CHECK(server.counters().idle == 2);
    CHECK(working.ask({4, 0, 0, 0, 1}).size() == 4);
    // While all of them ask, one more is closed as it comes.
    const rig::modbus::ModbusServer busy(map, {.clients = 1, .idle = 1h});
    const raw::Client first(busy.port());
    CHECK(first.ask({4, 0, 0, 0, 1}).size() == 4);
    CHECK(raw::Client(busy.port()).receive().empty());
    CHECK(busy.counters().idle == 0);
}

TEST_CASE("An address that cannot be served is named with the reason", "[BRG-020]") {
    const auto map = stub::shipped_map();
    const rig::modbus::ModbusServer server(map, {});
    const std::string port = std::to_string(server.port());
    CHECK_THROWS_WITH(rig::modbus::ModbusServer(map, {.port = server.port()}), ContainsSubstring("127.0.0.1:" + port) && ContainsSubstring("in use"));
    CHECK_THROWS_WITH(rig::modbus::ModbusServer(map, {.address = "localhost"}), ContainsSubstring("numeric IPv4"));
    CHECK_THROWS_WITH(rig::modbus::ModbusServer(map, {.address = "192.0.2.1"}), ContainsSubstring("192.0.2.1"));
}

TEST_CASE("A port is free again when its server has gone, clients or not", "[BRG-020]") {
    const auto map = stub::shipped_map();
    auto server = std::make_unique<rig::modbus::ModbusServer>(map, rig::modbus::ServerOptions{});
    const auto port = server->port();
    const raw::Client client(port);
    CHECK(client.ask({4, 0, 0, 0, 1}).size() == 4);
    server.reset();
    server = std::make_unique<rig::modbus::ModbusServer>(map, rig::modbus::ServerOptions{.port = port});
    CHECK(raw::Client(port).ask({4, 0, 0, 0, 1}).size() == 4);
}

TEST_CASE("A peer that is not on the list is closed unheard and named once; one that is, is served", "[BRG-020]") {
    const rig::RegisterMap map = stub::shipped_map();
    std::mutex mutex;
    std::vector<std::string> rejected;
    const rig::modbus::ServerOptions options{.allow = {"127.0.0.1", "127.0.0.3"}, .on_rejected = [&](const std::string& peer) {
                                                 const std::lock_guard lock(mutex);
                                                 rejected.push_back(peer);
                                             }};
    rig::modbus::ModbusServer server(map, options);
    static_cast<void>(server.exchange({}));
    for (int i = 0; i < 3; ++i) {
        const raw::Client stranger(server.port(), "127.0.0.2");
        CHECK(stranger.ask({6, 0, 2, 0, 1}).empty());
    }
    CHECK(server.counters().rejected == 3);
    CHECK(server.counters().requests == 0);
    const raw::Client guest(server.port(), "127.0.0.3");
    CHECK(guest.ask({3, 0, 2, 0, 1}) == Bytes{3, 2, 0, 0});  // what the stranger wrote did not arrive
    const raw::Client other(server.port());
    CHECK(other.ask({3, 0, 2, 0, 1}) == Bytes{3, 2, 0, 0});
    const std::lock_guard lock(mutex);
    CHECK(rejected == std::vector<std::string>{"127.0.0.2"});
}

TEST_CASE("Unless told otherwise only this machine's own address is served; no list, nobody", "[BRG-020]") {
    const rig::RegisterMap map = stub::shipped_map();
    const rig::modbus::ModbusServer usual(map, {.address = "0.0.0.0"});
    CHECK(raw::Client(usual.port(), "127.0.0.2").receive().empty());
    CHECK(eventually([&] { return usual.counters().rejected == 1; }));
    const rig::modbus::ModbusServer closed(map, {.allow = {}});
    CHECK(raw::Client(closed.port()).receive().empty());
    CHECK_THROWS_WITH(rig::modbus::ModbusServer(map, {.allow = {"plc.local"}}), ContainsSubstring("plc.local") && ContainsSubstring("numeric IPv4"));
}
