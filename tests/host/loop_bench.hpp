/// The real loop on the in-process bus, with a rig at the other end and a clock that only moves when somebody sleeps on it.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "firmware/can/load_layout.hpp"
#include "firmware/can/loopback.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/controller/session.hpp"
#include "firmware/host/controller_config.hpp"

namespace host_test {

using namespace std::chrono_literals;
namespace can = antiskid::can;
namespace control = antiskid::control;
namespace host = antiskid::host;
namespace controller = antiskid::controller;
using control::Time;

/// Time passes in sleeps only; the test may act in each.
class StepClock final : public host::Clock {
  public:
    Time now() override { return now_; }
    void sleep_until(const Time deadline) override {
        if (on_sleep) on_sleep(deadline);
        if (deadline > now_) now_ = deadline;
    }
    void advance(const Time by) { now_ += by; }

    std::function<void(Time deadline)> on_sleep;

  private:
    Time now_ = 100s;
};

/// The controller's end of the bus. Waiting on it asks the test for frames; if there are none, time passes.
class WaitingBus final : public can::Bus {
  public:
    WaitingBus(can::Bus& end, StepClock& clock) : end_(end), clock_(clock) {}
    std::size_t receive(const std::span<can::Frame> frames) override { return end_.receive(frames); }
    bool send(const can::Frame& frame) override { return !(rejects && rejects(frame)) && end_.send(frame); }
    bool wait(const Time timeout) override {
        if (on_wait) on_wait();
        if (end_.wait(timeout)) return true;
        clock_.advance(timeout);
        return false;
    }
    [[nodiscard]] can::LinkStatus status() const override { return end_.status(); }

    std::function<void()> on_wait;
    std::function<bool(const can::Frame&)> rejects;  ///< a full queue

  private:
    can::Bus& end_;
    StepClock& clock_;
};

inline controller::ControllerSetup default_setup() {
    controller::Options options;
    return controller::load_setup(options);
}

struct LoopBench {
    explicit LoopBench(const controller::ClockSource source, const controller::ControllerSetup& with = default_setup())
        : setup(with), controller_end(hub.connect()), rig_end(hub.connect()), bus(controller_end, clock), rig(setup.layout, setup.period) {
        controller::Options options;
        options.clock = source;
        session = std::make_unique<controller::Session>(setup, options, bus, clock);
    }

    /// What the rig sends in a period, before SYNC; it also takes in what came from the controller since.
    void rig_period(const can::RigSample& sample) {
        collect();
        hub.set_time(clock.now());
        std::array<can::Frame, can::RigPort::kMaxFrames> frames;
        const std::size_t count = rig.due_frames(sample, frames);
        for (const can::Frame& frame : std::span(frames).first(count)) rig_end.send(frame);
    }
    void rig_sync() { rig_end.send(rig.sync(syncs++)); }

    /// Takes in what the controller has sent so far.
    void collect() {
        std::array<can::Frame, 64> batch;
        for (std::size_t n = rig_end.receive(batch); n > 0; n = rig_end.receive(batch))
            for (const can::Frame& frame : std::span(batch).first(n)) {
                rig.accept(frame);
                received.push_back(frame);
            }
    }

    /// From now on `before` is called in each of `periods` of the timer, then the loop is told to stop.
    void plan_timer(const int periods, std::function<void(int period)> before) {
        clock.on_sleep = [this, periods, before = std::move(before), period = 0](Time) mutable {
            if (stop) return;  // the closing commands sleep, too
            before(period++);
            stop = period == periods;
        };
    }
    /// The same by the sensors: `before` is called in each wait, when the period is over.
    void plan_sensors(const int periods, std::function<void(int period)> before) {
        bus.on_wait = [this, periods, before = std::move(before), period = 0]() mutable {
            clock.advance(setup.period);
            if (period < periods) before(period++);
            stop = period == periods;
        };
    }
    /// The same for lockstep: `before` is called each time the controller has nothing left to do.
    void plan_sync(const int periods, std::function<void(int period)> before) {
        bus.on_wait = [this, periods, before = std::move(before), period = 0]() mutable {
            if (period == periods) {
                stop = true;
                return;
            }
            before(period++);
        };
    }
    void run() {
        session->loop().run(stop);
        collect();
    }
    void run_timer(const int periods, std::function<void(int period)> before) {
        plan_timer(periods, std::move(before));
        run();
    }
    void run_sync(const int periods, std::function<void(int period)> before) {
        plan_sync(periods, std::move(before));
        run();
    }

    [[nodiscard]] const host::LoopStatistics& statistics() const { return session->loop().statistics(); }
    [[nodiscard]] std::uint16_t id(const can::Role role) const { return setup.layout[role].id; }

    controller::ControllerSetup setup;
    StepClock clock;
    can::Loopback hub;
    can::Loopback::End& controller_end;
    can::Loopback::End& rig_end;
    WaitingBus bus;
    can::RigPort rig;
    std::unique_ptr<controller::Session> session;
    std::atomic<bool> stop{false};
    std::uint32_t syncs = 0;
    std::vector<can::Frame> received;  ///< by the rig, in order
};

/// A rig at rest: nothing turns, no pressure, disarmed.
inline can::RigSample at_rest() {
    return {};
}

}  // namespace host_test
