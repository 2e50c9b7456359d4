/// What the tests of the client command.
#pragma once

#include <cstdint>

#include "rig_bridge/modbus/client.hpp"
#include "rig_bridge/modbus/modbus_context.hpp"
#include "tests/catch.hpp"
#include "tests/modbus/plc_stub.hpp"

namespace client_test {

using rig::at;
using rig::Commanded;
using stub::eventually;

inline rig::CommandedValues landing(double speed_mps) {
    rig::CommandedValues wanted{};
    at(wanted, Commanded::drive_enable) = 1.0;
    at(wanted, Commanded::flywheel_speed_mps) = speed_mps;
    at(wanted, Commanded::load_base_N) = 43609.5;
    at(wanted, Commanded::load_lift_Ns2pm2) = 3.625;
    return wanted;
}

inline rig::modbus::TcpServer at_port(std::uint16_t port) {
    return {"127.0.0.1", port};
}

/// Calls `client.command` as a bridge does until `done`.
template <typename Condition>
inline bool commanding(rig::modbus::ModbusClient& client, const rig::CommandedValues& wanted, const Condition& done) {
    return eventually([&] {
        client.command(wanted);
        return done();
    });
}

/// 75 m/s under commit 4711, in one request.
inline void other_master_commands(const rig::RegisterMap& map, std::uint16_t port) {
    const rig::modbus::ModbusContext other(modbus_new_tcp("127.0.0.1", port));
    REQUIRE(modbus_connect(other.get()) == 0);
    modbus_set_slave(other.get(), map.unit_id);
    rig::RegisterImage image(map.commanded, map.word_order);
    REQUIRE(image.write(map.field(Commanded::flywheel_speed_mps), 75.0));
    REQUIRE(image.write(map.field(Commanded::drive_enable), 1.0));
    REQUIRE(image.write(map.field(Commanded::commit), 4711.0));
    const auto words = image.words(1, 11);  // all but the watchdog
    REQUIRE(modbus_write_registers(other.get(), 1, 11, words.data()) == 11);
    modbus_close(other.get());
}

}  // namespace client_test
