// The loop over a real CAN socket allocates nothing, takes no lock, prints nothing, throws nothing. Run by `./rig vcan --`.
#include <array>
#include <memory>
#include <span>

#include "firmware/can/roles.hpp"
#include "firmware/can/socket_can.hpp"
#include "firmware/host/supervised_can.hpp"
#include "tests/catch.hpp"
#include "tests/host/loop_bench.hpp"
#include "tests/host/toy_rig.hpp"
#include "tests/host/traps.hpp"

using namespace host_test;

namespace {

/// The rig's end: a socket of its own.
class RigEnd {
  public:
    explicit RigEnd(const controller::ControllerSetup& setup)
        : port_(setup.layout, setup.period),
          socket_("vcan0", can::ids(setup.layout, can::kToRig).span()),
          toy_(setup.control, control::Law::wheel_slip) {}

    void period(const bool with_sync) {
        const traps::Disarmed disarmed;
        std::array<can::Frame, 32> frames;
        for (std::size_t n = socket_.receive(frames); n > 0; n = socket_.receive(frames))
            for (const can::Frame& frame : std::span(frames).first(n)) port_.accept(frame);
        toy_.advance(static_cast<double>(port_.controller().current_mA), 1e-3);
        const std::size_t count = port_.due_frames(toy_.sample(), frames);
        for (const can::Frame& frame : std::span(frames).first(count)) REQUIRE(socket_.send(frame));
        if (with_sync) REQUIRE(socket_.send(port_.sync(syncs_++)));
    }

    [[nodiscard]] const can::RigPort& port() const { return port_; }

  private:
    can::RigPort port_;
    can::SocketCan socket_;
    ToyRig toy_;
    std::uint32_t syncs_ = 0;
};

}  // namespace

TEST_CASE("over a real socket the loop does nothing forbidden", "[RT-050]") {
    constexpr int kPeriods = 10'000;
    const auto source = GENERATE(controller::ClockSource::sync, controller::ClockSource::timer);
    const controller::ControllerSetup setup = default_setup();
    host::SupervisedCan socket([&setup] { return std::make_unique<can::SocketCan>("vcan0", can::ids(setup.layout, can::kToController).span()); });
    RigEnd rig(setup);
    StepClock clock;
    WaitingBus bus(socket, clock);
    controller::Options options;
    options.clock = source;
    const auto session = std::make_unique<controller::Session>(setup, options, bus, clock);
    std::atomic<bool> stop{false};
    int period = 0;
    if (source == controller::ClockSource::sync) {
        bus.on_wait = [&] {
            if (period++ < kPeriods)
                rig.period(true);
            else
                stop = true;
        };
    } else {
        clock.on_sleep = [&](Time) {
            if (stop) return;
            rig.period(false);
            stop = ++period == kPeriods;
        };
    }
    traps::clear();
    {
        const traps::Armed armed;
        session->loop().run(stop);
    }
    for (std::size_t call = 0; call < traps::kCalls; ++call) {
        INFO(traps::kNames[call]);
        CHECK(traps::caught(static_cast<traps::Call>(call)) == 0);
    }
    const host::LoopStatistics& statistics = session->loop().statistics();
    CHECK(statistics.steps == kPeriods);
    CHECK(statistics.frames_unsent == 0);
    CHECK(session->port().stats(can::Role::wheel).accepted == kPeriods);
    CHECK(rig.port().stats(can::Role::valve).rejected() == 0);
    if (source == controller::ClockSource::sync) CHECK(statistics.steps_in_state[static_cast<std::size_t>(control::State::braking)] > 1000);
}

TEST_CASE("by the machine's own clock, too", "[RT-050]") {
    const controller::ControllerSetup setup = default_setup();
    host::SupervisedCan socket([&setup] { return std::make_unique<can::SocketCan>("vcan0", can::ids(setup.layout, can::kToController).span()); });
    host::MonotonicClock clock;
    controller::Options options;
    options.clock = GENERATE(controller::ClockSource::sensors, controller::ClockSource::timer);
    const auto session = std::make_unique<controller::Session>(setup, options, socket, clock);
    std::atomic<bool> stop{false};
    std::thread stopper([&] {
        clock.sleep_until(clock.now() + 500ms);
        stop = true;
    });
    traps::clear();
    {
        const traps::Armed armed;
        session->loop().run(stop);
    }
    stopper.join();
    CHECK(traps::caught() == 0);
    CHECK(session->loop().statistics().steps > 0);
}
