/// A PLC and a bus that say what the test tells them.
#pragma once

#include <vector>

#include "firmware/can/load_layout.hpp"
#include "rig_bridge/bridge/node.hpp"

namespace bridge_test {

using antiskid::can::Time;
using namespace std::chrono_literals;

inline antiskid::can::Layout layout() {
    return antiskid::can::load_layout("config/antiskid.dbc", "config/antiskid_binding.toml");
}

/// Everything fresh and good, at rest.
inline rig::modbus::Snapshot good_plc() {
    rig::modbus::Snapshot plc;
    plc.values.fill(0.0);
    plc.quality.fill(rig::ValueQuality::good);
    plc.age_s.fill(0.01);
    plc.link = rig::modbus::LinkState::connected;
    plc.command = rig::modbus::CommandState::applied;
    rig::at(plc.values, rig::Measured::interlocks) = 15.0;
    rig::at(plc.values, rig::Measured::brake_temperature_C) = 20.0;
    return plc;
}

/// Everybody heard at `now`, the controller in standby.
inline rig::bridge::BusNow good_bus(Time now) {
    rig::bridge::BusNow bus;
    bus.up = true;
    bus.valid_at = now;
    bus.view.wheel.received = bus.view.flywheel.received = bus.view.pressure.received = now;
    bus.view.controller.status_received = now;
    bus.view.controller.state = antiskid::control::State::standby;
    return bus;
}

class FakePlc final : public rig::bridge::Plc {
  public:
    void command(const rig::CommandedValues& wanted) override { commands.push_back(wanted); }
    [[nodiscard]] rig::modbus::Snapshot snapshot() const override { return now; }

    rig::modbus::Snapshot now = good_plc();
    std::vector<rig::CommandedValues> commands;
};

class FakeFeed final : public rig::bridge::BusFeed {
  public:
    [[nodiscard]] rig::bridge::BusNow now() const override { return bus; }

    rig::bridge::BusNow bus = good_bus(1s);
};

class FakeBus final : public antiskid::can::Bus {
  public:
    std::size_t receive(std::span<antiskid::can::Frame>) override { return 0; }
    bool send(const antiskid::can::Frame& frame) override {
        sent.push_back(frame);
        return true;
    }
    bool wait(Time) override { return false; }
    [[nodiscard]] antiskid::can::LinkStatus status() const override { return {.up = up}; }

    bool up = true;
    std::vector<antiskid::can::Frame> sent;
};

}  // namespace bridge_test
