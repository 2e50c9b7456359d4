// Client and server on a serial line.
#include "rig_bridge/modbus/client.hpp"

#include <fcntl.h>

#include "rig_bridge/rig/lockstep_turn.hpp"
#include "tests/catch.hpp"
#include "tests/modbus/client_commands.hpp"
#include "tests/modbus/fake_plc.hpp"
#include "tests/modbus/plc_stub.hpp"
#include "tests/modbus/raw_tcp.hpp"

using namespace std::chrono_literals;
using rig::at;
using rig::Commanded;
using rig::Measured;
using rig::modbus::CommandState;
using stub::eventually;
using namespace client_test;

TEST_CASE("The client speaks RTU to the server's pseudo-terminal", "[BRG-020]") {
    auto map = stub::shipped_map();
    map.link.response_timeout = 500ms;
    stub::Plc plc(map, {.rtu = true});
    plc.set(Measured::vertical_load_N, 43609.5);
    CHECK_THAT(plc.server().rtu_path(), ContainsSubstring("/dev/pts/"));
    rig::modbus::ModbusClient client(map, rig::modbus::SerialDevice{plc.server().rtu_path()});
    REQUIRE(commanding(client, landing(50.0), [&] { return client.snapshot().command == CommandState::applied; }));
    CHECK(client.snapshot().value(Measured::vertical_load_N) == 43609.5);
    CHECK(at(plc.commands().commanded, Commanded::load_base_N) == 43609.5);
    // The same registers over TCP at the same time.
    rig::modbus::ModbusClient tcp(map, at_port(plc.server().port()));
    REQUIRE(eventually([&] { return tcp.snapshot().value(Measured::vertical_load_N) == 43609.5; }));
}

TEST_CASE("The server's RTU side ignores other units, noise and broken frames", "[BRG-020]") {
    const auto map = stub::shipped_map();
    const rig::modbus::ModbusServer server(map, {.port = std::nullopt, .rtu = true});
    CHECK(server.port() == 0);
    const settings::FileDescriptor line(::open(server.rtu_path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    REQUIRE(line.is_open());
    const auto answer = [&](const raw::Bytes& request, int timeout_ms) {
        fake::RtuPlc::write(line.get(), request);
        raw::Bytes all;
        pollfd event{.fd = line.get(), .events = POLLIN, .revents = 0};
        while (::poll(&event, 1, timeout_ms) > 0) {
            std::array<std::uint8_t, 512> bytes{};
            const auto got = ::read(line.get(), bytes.data(), bytes.size());
            all.insert(all.end(), bytes.begin(), bytes.begin() + got);
            if (all.size() > 4 && fake::crc16(all) == 0) break;  // of a frame with its checksum
        }
        return all;
    };
    const auto good = fake::with_crc({1, 4, 0, 0, 0, 1});
    const auto expected = fake::with_crc({1, 4, 2, 0, 1});
    CHECK(answer(good, 60'000) == expected);
    CHECK(answer(fake::with_crc({2, 4, 0, 0, 0, 1}), 50).empty());
    CHECK(answer(good, 60'000) == expected);
    auto broken = good;
    broken[3] ^= 1;
    CHECK(answer(broken, 50).empty());
    CHECK(answer(good, 60'000) == expected);
    CHECK(answer({good.begin(), good.begin() + 5}, 400).empty());  // cut off: forgotten after 200 ms
    CHECK(answer(good, 60'000) == expected);
    CHECK(answer(fake::with_crc({1, 4, 0, 99, 0, 1}), 60'000) == fake::with_crc({1, 0x84, 2}));
    // A broadcast is obeyed and never answered, not even by an exception.
    CHECK(answer(fake::with_crc({0, 6, 0, 4, 0, 1}), 50).empty());
    CHECK(answer(fake::with_crc({0, 6, 0, 50, 0, 1}), 50).empty());
    CHECK(answer(fake::with_crc({1, 3, 0, 4, 0, 1}), 60'000) == fake::with_crc({1, 3, 2, 0, 1}));
    CHECK(server.counters().broken >= 2);
}

TEST_CASE("A map that a serial line cannot carry safely is refused", "[BRG-034]") {
    auto map = stub::shipped_map();
    map.measured[static_cast<std::size_t>(Measured::wheel_on_rim)].address = 500;
    CHECK_THROWS_WITH(rig::modbus::ModbusClient(map, rig::modbus::SerialDevice{"/dev/ttyS9"}), ContainsSubstring("groups of two"));
}
