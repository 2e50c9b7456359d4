/// The bridge's main loop with its Modbus client, the served rig behind its Modbus server, and somebody else with libmodbus. By the machine's
/// clock, with limits that a machine that stands still does not reach; what is asserted is who did what, never when.
#include <modbus/modbus.h>

#include <chrono>
#include <thread>

#include "plant_sim/plc/load_served_rig.hpp"
#include "rig_bridge/bridge/node.hpp"
#include "rig_bridge/modbus/modbus_context.hpp"
#include "rig_bridge/modbus/server.hpp"
#include "rig_bridge/rig/scenario.hpp"
#include "tests/bridge/fakes.hpp"
#include "tests/catch.hpp"

using namespace std::chrono_literals;
using bridge_test::FakeBus;
using bridge_test::FakeFeed;
using rig::Abort;
using rig::Commanded;
using rig::Phase;

namespace {

rig::RegisterMap patient_map() {
    rig::RegisterMap map = rig::load_register_map("config/registers.toml");
    map.link.response_timeout = 10s;
    map.link.user_timeout = 30s;
    return map;
}

class ClientPlc final : public rig::bridge::Plc {
  public:
    ClientPlc(const rig::RegisterMap& map, std::uint16_t port) : client_(map, rig::modbus::TcpServer{"127.0.0.1", port}) {}
    void command(const rig::CommandedValues& wanted) override { client_.command(wanted); }
    [[nodiscard]] rig::modbus::Snapshot snapshot() const override { return client_.snapshot(); }

  private:
    rig::modbus::ModbusClient client_;
};

/// A light landing, 49 m/s, from rest.
struct BridgeAtPlc {
    rig::Scenario scenario = rig::load_scenario("config/scenarios/light.toml");
    rig::RegisterMap map = patient_map();
    antiskid::can::Layout layout = bridge_test::layout();
    rig::modbus::ModbusServer server{map, {}};
    plc::ServedRig served = [this] {
        plc::ServedRigOptions options = plc::load_served_rig("config", plc::Bench::landing);
        options.watchdog_s = 30.0;
        return plc::ServedRig(scenario.rig, options, 1);
    }();
    ClientPlc client{map, server.port()};
    FakeFeed feed;
    FakeBus bus;
    rig::bridge::Node node{layout, 1e-3, {.registers_s = 30.0, .commit_s = 30.0, .watchdog_s = 30.0}, client, feed, bus};
    rig::Sequencer sequencer{rig::plan(scenario, 1, 1)};
    bridge_test::Time now = 1s;
    double encoder_scale = 1.0;  ///< of the flywheel's encoder on the bus
    double fastest_mps = 0.0;    ///< that the rim was

    /// 10 ms of rig time.
    void step() {
        served.command(server.exchange(served.measured()).commanded);
        for (int i = 0; i < 10; ++i) served.advance(0.0);
        now += rig::bridge::Node::kStep;
        feed.bus = bridge_test::good_bus(now);
        const double rim_mps = served.rig().wheel().v_mps;
        feed.bus.rim_mps = encoder_scale * rim_mps;
        fastest_mps = std::max(fastest_mps, rim_mps);
        (void)node.step(&sequencer, {}, now);
        // The rig's time passes with the link's: the client has asked, whatever the machine does meanwhile.
        const std::uint64_t asked = server.counters().requests;
        for (int i = 0; i < 1000 && server.counters().requests < asked + 2; ++i) std::this_thread::sleep_for(1ms);
    }
    template <typename Done>
    [[nodiscard]] bool until(const Done& done, int steps = 6000) {
        for (; steps > 0 && !done(); --steps) step();
        return done();
    }
};

class SecondMaster {
  public:
    explicit SecondMaster(const BridgeAtPlc& bench) : map_(bench.map), context_(modbus_new_tcp("127.0.0.1", bench.server.port())) {
        modbus_set_slave(context_.get(), map_.unit_id);
        REQUIRE(modbus_connect(context_.get()) == 0);
    }
    ~SecondMaster() { modbus_close(context_.get()); }
    SecondMaster(const SecondMaster&) = delete;
    SecondMaster& operator=(const SecondMaster&) = delete;

    void spin_up(double speed_mps, std::uint16_t commit) {
        rig::RegisterImage image(map_.commanded, map_.word_order);
        REQUIRE((image.write(map_.field(Commanded::drive_enable), 1.0) && image.write(map_.field(Commanded::flywheel_speed_mps), speed_mps) &&
                 image.write(map_.field(Commanded::commit), commit)));
        const std::uint16_t first = map_.field(Commanded::drive_enable).address;
        const auto count = static_cast<std::size_t>(map_.field(Commanded::commit).address - first) + 1U;
        REQUIRE(modbus_write_registers(context_.get(), first, static_cast<int>(count), image.words(first, count).data()) == static_cast<int>(count));
    }

  private:
    const rig::RegisterMap& map_;
    rig::modbus::ModbusContext context_;
};

}  // namespace

TEST_CASE("A second master that commands 75 m/s in the spin-up of a 49 m/s landing ends it, and commands nothing", "[BRG-136]") {
    BridgeAtPlc b;
    SecondMaster other(b);
    REQUIRE(b.until([&] { return b.served.plc().commands().drive && b.fastest_mps > 1.0; }));
    REQUIRE(b.sequencer.phase() == Phase::spin_up);
    CHECK(b.served.plc().commands().speed_mps == Approx(49.0).margin(0.5));
    other.spin_up(75.0, 4711);
    REQUIRE(b.until([&] { return b.sequencer.over(); }));
    CHECK(b.sequencer.abort() == Abort::foreign_command);
    REQUIRE(b.until([&] { return !b.served.plc().commands().drive; }));
    // It insists: the bridge, whose maneuver is over, still holds the rig at its safe end.
    for (std::uint16_t commit = 5000; commit < 5003; ++commit) {
        other.spin_up(75.0, commit);
        REQUIRE(b.until([&] { return b.node.moment().plc.foreign_commit == commit; }));
        REQUIRE(b.until([&] { return !b.served.plc().commands().drive; }));
    }
    CHECK(b.fastest_mps < 49.0);
}

TEST_CASE("An encoder with a wrong number of teeth ends the spin-up before the speed is wrong by much", "[BRG-136]") {
    BridgeAtPlc b;
    b.encoder_scale = 0.75;
    REQUIRE(b.until([&] { return b.sequencer.over(); }));
    CHECK(b.sequencer.abort() == Abort::speed_mismatch);
    CHECK(b.fastest_mps > 8.0);   // 2 m/s apart
    CHECK(b.fastest_mps < 16.0);  // half a second and a slow link later
}
