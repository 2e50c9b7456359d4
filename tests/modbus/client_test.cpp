// The client against the real server: values, commands, watchdogs, reconnection.
#include "rig_bridge/modbus/client.hpp"

#include <cmath>
#include <limits>

#include "tests/catch.hpp"
#include "tests/modbus/plc_stub.hpp"

using namespace std::chrono_literals;
using rig::at;
using rig::Commanded;
using rig::CommandState;
using rig::LinkState;
using rig::Measured;
using stub::eventually;

namespace {

rig::CommandedValues landing(double speed_mps) {
    rig::CommandedValues wanted{};
    at(wanted, Commanded::drive_enable) = 1.0;
    at(wanted, Commanded::flywheel_speed_mps) = speed_mps;
    at(wanted, Commanded::load_base_N) = 43609.5;
    at(wanted, Commanded::load_lift_Ns2pm2) = 3.625;
    return wanted;
}

rig::TcpServer at_port(std::uint16_t port) {
    return {"127.0.0.1", port};
}

/// Calls `client.command` as a bridge does until `done`.
template <typename Condition>
bool commanding(rig::ModbusClient& client, const rig::CommandedValues& wanted, const Condition& done) {
    return eventually([&] {
        client.command(wanted);
        return done();
    });
}

}  // namespace

TEST_CASE("Measured values arrive in SI with their age and quality", "[BRG-030]") {
    const auto map = stub::shipped_map();
    stub::Plc plc(map);
    plc.set(Measured::flywheel_speed_mps, 61.25);
    plc.set(Measured::brake_temperature_C, -12.34);
    plc.set(Measured::hydraulic_pressure_Pa, 20.996e6);
    plc.set(Measured::interlocks, 0b1101);
    const rig::ModbusClient client(map, at_port(plc.server().port()));
    REQUIRE(eventually([&] { return client.snapshot().value(Measured::flywheel_speed_mps) == 61.25; }));
    const auto now = client.snapshot();
    CHECK(now.link == LinkState::connected);
    CHECK(now.value(Measured::brake_temperature_C) == Approx(-12.3).margin(1e-9));
    CHECK(now.value(Measured::hydraulic_pressure_Pa) == Approx(21.00e6).margin(1.0));
    CHECK(now.value(Measured::interlocks) == 13.0);
    CHECK(now.value(Measured::map_version) == 1.0);
    for (std::size_t i = 0; i < rig::kMeasuredCount; ++i) {
        CHECK(now.quality[i] == rig::ValueQuality::good);
        CHECK(std::isfinite(now.age_s[i]));
    }
}

TEST_CASE("A command is applied whole and confirmed by its number", "[BRG-031]") {
    const auto map = stub::shipped_map();
    stub::Plc plc(map);
    rig::ModbusClient client(map, at_port(plc.server().port()));
    CHECK(client.snapshot().command == CommandState::none);
    const auto wanted = landing(50.0);
    REQUIRE(commanding(client, wanted, [&] { return client.snapshot().command == CommandState::applied; }));
    const auto orders = plc.orders().commanded;
    CHECK(at(orders, Commanded::drive_enable) == 1.0);
    CHECK(at(orders, Commanded::flywheel_speed_mps) == 50.0);
    CHECK(at(orders, Commanded::load_base_N) == 43609.5);
    CHECK(at(orders, Commanded::load_lift_Ns2pm2) == 3.625);
    CHECK(at(orders, Commanded::commit) == client.snapshot().commit);
    CHECK(client.snapshot().pending_s == 0.0);
}
