// The client against the real server: values, commands, watchdogs, reconnection.
#include "rig_bridge/modbus/client.hpp"

#include <cmath>

#include "rig_bridge/rig/lockstep_turn.hpp"
#include "tests/catch.hpp"
#include "tests/modbus/client_commands.hpp"
#include "tests/modbus/plc_stub.hpp"
#include "tests/modbus/raw_tcp.hpp"

using namespace std::chrono_literals;
using rig::at;
using rig::Commanded;
using rig::Measured;
using rig::modbus::CommandState;
using rig::modbus::LinkState;
using stub::eventually;
using namespace client_test;

TEST_CASE("Measured values arrive in SI with their age and quality", "[BRG-030]") {
    const auto map = stub::shipped_map();
    stub::Plc plc(map);
    plc.set(Measured::flywheel_speed_mps, 61.25);
    plc.set(Measured::brake_temperature_C, -12.34);
    plc.set(Measured::hydraulic_pressure_Pa, 20.996e6);
    plc.set(Measured::interlocks, 0b1101);
    const rig::modbus::ModbusClient client(map, at_port(plc.server().port()));
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

TEST_CASE("A command is applied whole and confirmed by its number", "[BRG-030]") {
    const auto map = stub::shipped_map();
    stub::Plc plc(map);
    rig::modbus::ModbusClient client(map, at_port(plc.server().port()));
    CHECK(client.snapshot().command == CommandState::none);
    const auto wanted = landing(50.0);
    REQUIRE(commanding(client, wanted, [&] { return client.snapshot().command == CommandState::applied; }));
    const auto commands = plc.commands().commanded;
    CHECK(at(commands, Commanded::drive_enable) == 1.0);
    CHECK(at(commands, Commanded::flywheel_speed_mps) == 50.0);
    CHECK(at(commands, Commanded::load_base_N) == 43609.5);
    CHECK(at(commands, Commanded::load_lift_Ns2pm2) == 3.625);
    CHECK(at(commands, Commanded::commit) == client.snapshot().commit);
    CHECK(client.snapshot().pending_s == 0.0);
}

TEST_CASE("A second master's command is seen, and the client's own restored", "[BRG-136]") {
    const auto map = stub::shipped_map();
    stub::Plc plc(map);
    rig::modbus::ModbusClient client(map, at_port(plc.server().port()));
    const auto wanted = landing(49.0);
    REQUIRE(commanding(client, wanted, [&] { return client.snapshot().command == CommandState::applied; }));
    CHECK(client.snapshot().foreign_commands == 0);

    other_master_commands(map, plc.server().port());
    REQUIRE(commanding(client, wanted, [&] { return client.snapshot().foreign_commands == 1; }));
    CHECK(client.snapshot().foreign_commit == 4711);
    REQUIRE(commanding(client, wanted, [&] {
        return at(plc.commands().commanded, Commanded::flywheel_speed_mps) == 49.0 && client.snapshot().command == CommandState::applied;
    }));
    CHECK(at(plc.commands().commanded, Commanded::load_base_N) == 43609.5);
}

TEST_CASE("A second master's command is seen, though the client's next one takes its place before the PLC looks", "[BRG-136]") {
    const auto map = stub::shipped_map();
    stub::Plc plc(map);
    rig::modbus::ModbusClient client(map, at_port(plc.server().port()));
    REQUIRE(commanding(client, landing(49.0), [&] { return client.snapshot().command == CommandState::applied; }));

    plc.freeze(true);
    other_master_commands(map, plc.server().port());
    const std::uint16_t before = client.snapshot().commit;
    REQUIRE(commanding(client, landing(48.0), [&] { return client.snapshot().commit != before; }));
    plc.freeze(false);
    REQUIRE(commanding(client, landing(48.0), [&] { return client.snapshot().command == CommandState::applied; }));
    CHECK(client.snapshot().foreign_commands == 1);
    CHECK(client.snapshot().foreign_commit == 4711);
}

TEST_CASE("A refused command is told, and so is one that cannot be sent", "[BRG-030]") {
    const auto map = stub::shipped_map();
    stub::Plc plc(map);
    plc.reject(true);
    rig::modbus::ModbusClient client(map, at_port(plc.server().port()));
    REQUIRE(commanding(client, landing(50.0), [&] { return client.snapshot().command == CommandState::rejected; }));
    CHECK(client.snapshot().value(Measured::rejected_commit) == client.snapshot().commit);
    plc.reject(false);
    REQUIRE(commanding(client, landing(51.0), [&] { return client.snapshot().command == CommandState::applied; }));
    client.command(landing(1e6));
    CHECK(client.snapshot().command == CommandState::unsendable);
    CHECK_THAT(client.snapshot().command_error, ContainsSubstring("flywheel_speed"));
    CHECK(at(plc.commands().commanded, Commanded::flywheel_speed_mps) == 51.0);
}

TEST_CASE("Many commands in a row: each as it was wanted, the last one applied", "[BRG-030]") {
    auto map = stub::shipped_map();
    map.link.poll = 1ms;
    stub::Plc plc(map);
    rig::modbus::ModbusClient client(map, at_port(plc.server().port()));
    rig::CommandedValues wanted{};
    int k = 0;
    REQUIRE(eventually([&] {
        k = k % 100 + 1;
        at(wanted, Commanded::flywheel_speed_mps) = k;
        at(wanted, Commanded::load_base_N) = k;
        at(wanted, Commanded::load_lift_Ns2pm2) = k / 2.0;
        client.command(wanted);
        return plc.commits().size() >= 50;
    }));
    REQUIRE(commanding(client, wanted, [&] { return client.snapshot().command == CommandState::applied; }));
    double before = 0.0;
    for (const auto& commit : plc.commits()) {
        CHECK(at(commit, Commanded::load_base_N) == at(commit, Commanded::flywheel_speed_mps));
        CHECK(at(commit, Commanded::load_lift_Ns2pm2) == at(commit, Commanded::flywheel_speed_mps) / 2.0);
        CHECK(at(commit, Commanded::commit) > before);
        before = at(commit, Commanded::commit);
    }
    CHECK(at(plc.commands().commanded, Commanded::flywheel_speed_mps) == k);
}

TEST_CASE("A server that was killed and restarted gets the newest command again", "[BRG-030]") {
    auto map = stub::shipped_map();
    map.link.backoff_min = 1ms;
    map.link.backoff_max = 20ms;
    auto plc = std::make_unique<stub::Plc>(map);
    const auto port = plc->server().port();
    rig::modbus::ModbusClient client(map, at_port(port));
    const auto applied = [&] { return client.snapshot().command == CommandState::applied; };
    REQUIRE(commanding(client, landing(50.0), applied));
    const auto first = client.snapshot();

    plc.reset();
    REQUIRE(eventually([&] { return client.snapshot().counters.failed_connects >= 3; }));
    CHECK(client.snapshot().link == LinkState::lost);
    CHECK_FALSE(client.snapshot().error.empty());
    CHECK(std::isinf(client.snapshot().plc_watchdog_age_s));
    const auto wanted = landing(30.0);
    client.command(wanted);
    CHECK(client.snapshot().command == CommandState::pending);

    plc = std::make_unique<stub::Plc>(map, rig::modbus::ServerOptions{.port = port});
    REQUIRE(commanding(client, wanted, applied));
    CHECK(at(plc->commands().commanded, Commanded::flywheel_speed_mps) == 30.0);
    CHECK(client.snapshot().commit > first.commit);
    CHECK(client.snapshot().counters.connects == 2);
    CHECK(client.snapshot().link == LinkState::connected);
    CHECK(plc->commits().size() == 1);
}

TEST_CASE("A PLC with another map version is refused by number and left alone", "[BRG-030]") {
    auto other = stub::shipped_map();
    other.version = 2;
    auto plc = std::make_unique<stub::Plc>(other);
    const auto port = plc->server().port();
    auto map = stub::shipped_map();
    map.link.backoff_min = 1ms;
    map.link.backoff_max = 20ms;
    rig::modbus::ModbusClient client(map, at_port(port));
    REQUIRE(commanding(client, landing(50.0), [&] { return client.snapshot().link == LinkState::map_rejected; }));
    REQUIRE(commanding(client, landing(50.0), [&] { return plc->server().counters().requests >= 5; }));
    const auto now = client.snapshot();
    CHECK_THAT(now.error, ContainsSubstring("version 2") && ContainsSubstring("bridge's is 1"));
    CHECK(now.counters.polls == 0);
    CHECK(now.command == CommandState::pending);
    CHECK(std::isnan(now.value(Measured::plc_state)));
    CHECK(plc->commits().empty());
    CHECK(at(plc->commands().commanded, Commanded::bridge_watchdog) == 0.0);

    plc.reset();
    plc = std::make_unique<stub::Plc>(map, rig::modbus::ServerOptions{.port = port});
    REQUIRE(commanding(client, landing(50.0), [&] { return client.snapshot().command == CommandState::applied; }));
}

TEST_CASE("The watchdog moves only while the bridge's thread calls", "[BRG-030]") {
    const auto map = stub::shipped_map();
    stub::Plc plc(map);
    std::atomic<std::int64_t> now_ms{1000};
    rig::modbus::ModbusClient client(map, at_port(plc.server().port()),
                                     [&] { return rig::modbus::ClockTime(std::chrono::milliseconds(now_ms.load())); });
    const auto watchdog = [&] { return at(plc.commands().commanded, Commanded::bridge_watchdog); };
    const auto polled = [&](std::uint64_t more) {
        const auto goal = client.snapshot().counters.polls + more;
        return eventually([&] { return client.snapshot().counters.polls >= goal; });
    };
    // Nobody has called yet.
    REQUIRE(polled(5));
    CHECK(watchdog() == 0.0);
    // alive() and command() both keep it moving, every fifth of the PLC's time.
    for (const bool commands : {false, true}) {
        const double before = watchdog();
        REQUIRE(eventually([&] {
            now_ms += 20;
            if (commands) {
                client.command(landing(40.0));
            } else {
                client.alive();
            }
            return watchdog() >= before + 5.0;
        }));
    }
    REQUIRE(commanding(client, landing(40.0), [&] { return client.snapshot().command == CommandState::applied; }));
    // The caller hangs: polling goes on, the watchdog does not.
    now_ms += 101;
    REQUIRE(polled(1));
    const double last = watchdog();
    for (int i = 0; i < 10; ++i) {
        now_ms += 100;
        REQUIRE(polled(1));
    }
    CHECK(watchdog() == last);
    CHECK(client.snapshot().link == LinkState::connected);
    // And comes back.
    REQUIRE(eventually([&] {
        now_ms += 20;
        client.alive();
        return watchdog() >= last + 3.0;
    }));
}

TEST_CASE("Commands wait until the PLC has seen the watchdog move", "[BRG-030]") {
    const auto map = stub::shipped_map();
    stub::Plc plc(map);
    plc.freeze(true);
    rig::modbus::ModbusClient client(map, at_port(plc.server().port()));
    REQUIRE(commanding(client, landing(40.0), [&] { return client.snapshot().counters.polls >= 10; }));
    CHECK(client.snapshot().commit == 0);
    CHECK(client.snapshot().command == CommandState::pending);
    CHECK(std::isinf(client.snapshot().plc_watchdog_age_s));
    plc.freeze(false);
    REQUIRE(commanding(client, landing(40.0), [&] { return client.snapshot().command == CommandState::applied; }));
    CHECK(std::isfinite(client.snapshot().plc_watchdog_age_s));
}

TEST_CASE("A PLC that hangs is seen by the age of its watchdog, though it answers", "[BRG-034]") {
    const auto map = stub::shipped_map();
    stub::Plc plc(map);
    rig::modbus::ModbusClient client(map, at_port(plc.server().port()));
    REQUIRE(eventually([&] { return std::isfinite(client.snapshot().plc_watchdog_age_s); }));
    plc.freeze(true);
    REQUIRE(eventually([&] { return client.snapshot().plc_watchdog_age_s > 0.3; }));
    CHECK(client.snapshot().link == LinkState::connected);
}

TEST_CASE("A server that hangs after the request loses the link and gets it back", "[BRG-034]") {
    auto map = stub::shipped_map();
    map.link.response_timeout = 50ms;
    map.link.backoff_max = 100ms;
    stub::Plc plc(map);
    rig::modbus::ModbusClient client(map, at_port(plc.server().port()));
    REQUIRE(commanding(client, landing(50.0), [&] { return client.snapshot().command == CommandState::applied; }));
    const auto timeouts = client.snapshot().counters.timeouts;
    const raw::Client other(plc.server().port());
    REQUIRE(other.ask({6, 0, 101, 0, 50}).size() == 5);  // 0.5 s
    REQUIRE(commanding(client, landing(50.0), [&] { return client.snapshot().counters.timeouts > timeouts; }));
    REQUIRE(commanding(client, landing(50.0), [&] {
        const auto now = client.snapshot();
        return now.link == LinkState::connected && now.command == CommandState::applied;
    }));
    CHECK(plc.server().counters().hangs == 1);
}

TEST_CASE("Little word order and scattered registers work as well", "[BRG-030]") {
    auto map = stub::shipped_map();
    map.word_order = rig::WordOrder::little;
    map.measured[static_cast<std::size_t>(Measured::wheel_on_rim)].address = 500;
    map.measured[static_cast<std::size_t>(Measured::brake_torque_Nm)].address = 65534;
    map.commanded[static_cast<std::size_t>(Commanded::load_lift_Ns2pm2)].address = 3000;
    map.interlock_bit = {15, 14, 1, 0};
    stub::Plc plc(map);
    plc.set(Measured::brake_torque_Nm, -1234.5);
    plc.set(Measured::wheel_on_rim, 1.0);
    plc.set(Measured::interlocks, 0b0011);
    rig::modbus::ModbusClient client(map, at_port(plc.server().port()));
    REQUIRE(commanding(client, landing(50.0), [&] { return client.snapshot().command == CommandState::applied; }));
    REQUIRE(eventually([&] { return client.snapshot().value(Measured::brake_torque_Nm) == -1234.5; }));
    CHECK(client.snapshot().value(Measured::wheel_on_rim) == 1.0);
    CHECK(client.snapshot().value(Measured::interlocks) == 3.0);
    CHECK(at(plc.commands().commanded, Commanded::load_lift_Ns2pm2) == 3.625);
}

TEST_CASE("Turn by turn the PLC is read and told on the caller's thread, by the caller's time", "[BRG-465]") {
    auto map = stub::shipped_map();
    map.link.response_timeout = 60s;  // a busy host may stop the server for longer than a PLC would take
    rig::modbus::ModbusServer server(map, {});
    rig::MeasuredValues measured{};
    rig::modbus::ClockTime now{};
    std::uint16_t turn = 0;
    {
        rig::modbus::ModbusClient client(
            map, at_port(server.port()), [&] { return now; }, rig::modbus::Polling::turns);
        CHECK(client.snapshot().link == LinkState::connecting);
        client.read_all();
        client.write_turn(rig::kJoined);
        // The answer may leave before the server's own view of its registers follows.
        CHECK(eventually([&] { return server.bridge_turn() == rig::kJoined; }));
        CHECK(client.snapshot().link == LinkState::connected);
        const auto polls = client.snapshot().counters.polls;
        rig::modbus::PlcCommands commands;
        while (at(commands.commanded, Commanded::flywheel_speed_mps) != 61.0 && turn < 20) {
            now += 10ms;
            at(measured, Measured::plc_watchdog) += 1.0;
            at(measured, Measured::flywheel_speed_mps) = 0.5 * turn;
            (void)server.exchange(measured);
            client.read_all();
            client.command(landing(61.0));
            client.write_turn(++turn);
            CHECK(eventually([&] { return server.bridge_turn() == turn; }));
            CHECK(client.snapshot().value(Measured::flywheel_speed_mps) == 0.5 * (turn - 1));
            CHECK(client.snapshot().counters.polls == polls + turn);
            commands = server.exchange(measured);
        }
        // Told as soon as the PLC has seen the bridge's watchdog move.
        CHECK(turn == 3);
        now += 400ms;
        CHECK(client.snapshot().age_s[static_cast<std::size_t>(Measured::flywheel_speed_mps)] == Approx(0.4));
    }
    CHECK(eventually([&] { return server.bridge_turn() == rig::kNoTurns; }));
}
