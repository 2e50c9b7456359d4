/// The bridge without its threads: main loop, client and listener, turn by turn on a clock that is handed in.
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "firmware/can/bus.hpp"
#include "rig_bridge/bridge/bridge_setup.hpp"
#include "rig_bridge/bridge/bus_listener.hpp"
#include "rig_bridge/bridge/node.hpp"

namespace plant_sim::simulation {

class BridgeProgram {
  public:
    /// `sends` and `hears` are its two sockets; all references must outlive it.
    BridgeProgram(const rig::bridge::BridgeSetup& setup, antiskid::can::Bus& sends, antiskid::can::Bus& hears,
                  std::unique_ptr<rig::modbus::PlcLine> line, std::function<antiskid::can::Time()> now);

    /// What the client's thread does at each poll.
    void poll() { plc_.client.round(); }
    /// As step() does; a mistake where nobody steps.
    void prove_alive() { plc_.client.alive(); }
    const rig::bridge::Moment& step(rig::Sequencer* sequencer, const rig::bridge::Node::Wishes& wishes);

  private:
    struct Client final : rig::bridge::Plc {
        Client(const rig::RegisterMap& map, std::unique_ptr<rig::modbus::PlcLine> line, std::function<antiskid::can::Time()> now)
            : client(map, rig::modbus::TcpServer{}, std::move(now), rig::modbus::Polling::turns, std::move(line)) {}
        void command(const rig::CommandedValues& wanted) override { client.command(wanted); }
        [[nodiscard]] rig::modbus::Snapshot snapshot() const override { return client.snapshot(); }
        rig::modbus::ModbusClient client;
    };
    struct Feed final : rig::bridge::BusFeed {
        [[nodiscard]] rig::bridge::BusNow now() const override { return heard; }
        rig::bridge::BusNow heard;
    };

    antiskid::can::Bus& hears_;
    std::function<antiskid::can::Time()> now_;
    rig::bridge::BusListener listener_;
    Client plc_;
    Feed feed_;
    rig::bridge::Node node_;
};

}  // namespace plant_sim::simulation
