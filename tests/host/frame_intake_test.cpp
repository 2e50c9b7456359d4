#include "firmware/host/frame_intake.hpp"

#include "tests/catch.hpp"
#include "tests/host/loop_bench.hpp"

using namespace host_test;
using host::FrameIntake;

namespace {

/// Never runs out of frames.
class FloodBus final : public can::Bus {
  public:
    explicit FloodBus(const can::Frame& frame) : frame_(frame) {}
    std::size_t receive(const std::span<can::Frame> frames) override {
        for (can::Frame& frame : frames) frame = frame_;
        given += frames.size();
        return frames.size();
    }
    bool send(const can::Frame&) override { return true; }
    bool wait(Time) override { return true; }
    [[nodiscard]] can::LinkStatus status() const override { return {}; }

    std::size_t given = 0;

  private:
    can::Frame frame_;
};

}  // namespace

TEST_CASE("a flood of frames takes a bounded share of a period", "[RT-034]") {
    const controller::ControllerSetup setup = default_setup();
    can::ControllerPort port(setup.layout, setup.period);
    FloodBus bus({.id = 0x7FF, .length = 8, .data = {}, .received = {}});
    FrameIntake intake(bus, port);
    const auto drained = intake.drain(1s);
    CHECK(drained.frames == FrameIntake::kMax);
    CHECK(drained.full);
    CHECK(bus.given <= FrameIntake::kMax + 32);
    const auto taken = intake.take_until_sync(1s);
    CHECK(taken.frames == FrameIntake::kMax);
    CHECK(taken.full);
    CHECK_FALSE(taken.sync);
}

TEST_CASE("frames behind SYNC belong to the next cycle", "[RT-030]") {
    const controller::ControllerSetup setup = default_setup();
    can::ControllerPort port(setup.layout, setup.period);
    can::RigPort rig(setup.layout, setup.period);
    can::Loopback hub;
    auto& there = hub.connect();
    auto& here = hub.connect();
    FrameIntake intake(here, port);
    hub.set_time(77s);  // the machine's clock at reception, which must not show in lockstep

    there.send(rig.pressure(1e6F));
    there.send(rig.sync(0));
    there.send(rig.pressure(2e6F));
    there.send(rig.heartbeat());
    const auto first = intake.take_until_sync(10ms);
    CHECK(first.sync);
    CHECK(first.frames == 2);
    CHECK(first.sync_received == 77s);
    CHECK(port.sensors().pressure.pressure_Pa == Approx(1e6).margin(1e3));
    CHECK(port.sensors().pressure.received == 10ms);
    CHECK(port.sensors().rig_heartbeat_received == control::kNever);

    const auto rest = intake.take_until_sync(11ms);
    CHECK_FALSE(rest.sync);
    CHECK(rest.frames == 2);
    CHECK(port.sensors().pressure.pressure_Pa == Approx(2e6).margin(1e3));
    CHECK(port.sensors().pressure.received == 11ms);

    there.send(rig.sync(1));
    CHECK(intake.take_until_sync(11ms).sync);
    CHECK(port.sync_number() == 1);
}

TEST_CASE("by the timer a frame keeps its time of reception, but never lies ahead of the step", "[RT-045]") {
    const controller::ControllerSetup setup = default_setup();
    can::ControllerPort port(setup.layout, setup.period);
    can::RigPort rig(setup.layout, setup.period);
    can::Loopback hub;
    auto& there = hub.connect();
    FrameIntake intake(hub.connect(), port);
    there.send(rig.sync(0));  // without meaning for the timer
    hub.set_time(5s);
    there.send(rig.pressure(1e6F));
    hub.set_time(7s);
    there.send(rig.heartbeat());
    const auto taken = intake.drain(6s);
    CHECK(taken.frames == 3);
    CHECK_FALSE(taken.full);
    CHECK(port.sensors().pressure.received == 5s);
    CHECK(port.sensors().rig_heartbeat_received == 6s);
}
