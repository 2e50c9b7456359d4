/// The served rig on the in-process bus, with a clock that only waiting moves and a controller that answers each SYNC.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <span>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/can/loopback.hpp"
#include "firmware/can/roles.hpp"
#include "plant_sim/virtual_rig/serve_node.hpp"
#include "tests/catch.hpp"
#include "tests/plc/operator.hpp"

namespace serve_test {

using antiskid::can::Frame;
using antiskid::can::Role;
using antiskid::control::Time;
using plc::Bench;

inline constexpr Time kMillisecond{1'000'000};
inline constexpr Time kSecond = 1000 * kMillisecond;

class FakeClock final : public antiskid::host::Clock {
  public:
    Time now() override { return now_; }
    void sleep_until(Time deadline) override {
        now_ = std::max(now_, deadline);
        if (on_time) on_time(now_);
    }
    void pass(Time time) {
        now_ += time;
        if (on_time) on_time(now_);
    }
    std::function<void(Time)> on_time;

  private:
    Time now_{};
};

/// Time passes while the rig waits in vain.
class WaitingBus final : public antiskid::can::Bus {
  public:
    WaitingBus(antiskid::can::Loopback::End& near, FakeClock& clock) : near_(near), clock_(clock) {}
    std::size_t receive(std::span<Frame> frames) override { return near_.receive(frames); }
    bool send(const Frame& frame) override {
        const bool sent = near_.send(frame);
        if (sent) on_send(frame);
        return sent;
    }
    bool wait(Time timeout) override {
        const bool there = near_.wait(timeout);
        if (!there) clock_.pass(std::min(timeout, kMillisecond));
        return there;
    }
    [[nodiscard]] antiskid::can::LinkStatus status() const override { return near_.status(); }
    std::function<void(const Frame&)> on_send = [](const Frame&) {};

  private:
    antiskid::can::Loopback::End& near_;
    FakeClock& clock_;
};

/// A served rig with a controller on the far end that answers each SYNC with a constant current, while `answers` says so.
struct Stand {
    Stand()
        : layout(antiskid::can::load_layout("config/antiskid.dbc", "config/antiskid_binding.toml")),
          op(Bench::endurance),
          near(hub.connect()),
          far(hub.connect()),
          bus(near, clock),
          node(op.rig, layout, bus, clock, kMillisecond, [this](plc::ServedRig& rig) { exchange(rig); }) {
        bus.on_send = [this](const Frame& frame) { received(frame); };
    }

    void exchange(plc::ServedRig& rig) {
        if (++exchanges % 50 == 1) rig::at(op.registers, rig::Commanded::bridge_watchdog) += 1.0;
        rig.command(op.registers);
        if (on_period) on_period();
        if (rig.time_s() >= end_s) stop = true;
    }
    void received(const Frame& frame) {
        const auto role = [&] {
            for (std::size_t i = 0; i < antiskid::can::kRoleCount; ++i) {
                const auto& message = layout[static_cast<Role>(i)];
                if (message.bound && message.id == frame.id) return i;
            }
            return antiskid::can::kRoleCount;
        }();
        REQUIRE(role < antiskid::can::kRoleCount);
        ++sent[role];
        if (static_cast<Role>(role) == Role::sync && answers) answer();
    }
    void answer() { (void)far.send(controller.valve_command(static_cast<float>(current_mA))); }
    [[nodiscard]] std::uint64_t count(Role role) const { return sent[static_cast<std::size_t>(role)]; }

    antiskid::can::Layout layout;
    plc_test::Operator op;
    FakeClock clock;
    antiskid::can::Loopback hub;
    antiskid::can::Loopback::End& near;
    antiskid::can::Loopback::End& far;
    WaitingBus bus;
    antiskid::can::ControllerPort controller{layout, kMillisecond};
    plant_sim::ServeNode node;
    std::array<std::uint64_t, antiskid::can::kRoleCount> sent{};
    std::atomic<bool> stop{false};
    bool answers = true;
    double current_mA = 0.0;
    double end_s = 1.0;
    long exchanges = 0;
    std::function<void()> on_period;
};

}  // namespace serve_test
