// Steps by the sensors' frame, on a bus whose frames come when the test says.
#include <map>

#include "tests/catch.hpp"
#include "tests/host/loop_bench.hpp"

using namespace host_test;

namespace {

/// Frames that come at their time, which passes in waits and sleeps only.
class TimedBus final : public can::Bus {
  public:
    explicit TimedBus(StepClock& clock) : clock_(clock) {}
    void arrives(const Time at, can::Frame frame) {
        frame.received = at;
        coming_.emplace(at, frame);
    }
    std::size_t receive(const std::span<can::Frame> frames) override {
        std::size_t count = 0;
        for (; count < frames.size() && is_there(); ++count) {
            frames[count] = coming_.begin()->second;
            coming_.erase(coming_.begin());
        }
        return count;
    }
    bool send(const can::Frame&) override { return true; }
    bool wait(const Time timeout) override {
        const Time until = clock_.now() + std::max(timeout, Time{0});
        clock_.sleep_until(coming_.empty() ? until : std::min(until, coming_.begin()->first));
        return is_there();
    }
    [[nodiscard]] can::LinkStatus status() const override { return {}; }

  private:
    [[nodiscard]] bool is_there() { return !coming_.empty() && coming_.begin()->first <= clock_.now(); }

    StepClock& clock_;
    std::multimap<Time, can::Frame> coming_;
};

struct PacerBench {
    /// A period's sensors as a bus of 1 Mbit/s brings them, the last one at `at`.
    void sensors(const Time at) {
        const can::RigSample sample;
        std::array<can::Frame, can::RigPort::kMaxFrames> frames;
        const std::size_t count = rig.due_frames(sample, frames);
        for (const can::Frame& frame : std::span(frames).first(count)) {
            if (frame.id == setup.layout[can::Role::wheel].id) bus.arrives(at - 260us, frame);
            if (frame.id == setup.layout[can::Role::flywheel].id) bus.arrives(at - 130us, frame);
            if (frame.id == setup.layout[can::Role::pressure].id) bus.arrives(at, frame);
        }
    }
    host::Wake next() {
        const auto wake = pacer.next(stop);
        REQUIRE(wake);
        return *wake;
    }

    controller::ControllerSetup setup = default_setup();
    StepClock clock;
    Time start = clock.now();
    TimedBus bus{clock};
    can::ControllerPort port{setup.layout, setup.period};
    can::RigPort rig{setup.layout, setup.period};
    host::FrameIntake intake{bus, port};
    host::SensorPacer pacer{clock, setup.period, can::Role::pressure, bus, port, intake};
    std::atomic<bool> stop{false};
};

}  // namespace

TEST_CASE("the message to go by is the last of the sensors' that comes once a period", "[RT-045]") {
    const controller::ControllerSetup ours = default_setup();
    CHECK(host::SensorPacer::message(ours.layout, 1ms) == can::Role::pressure);
    CHECK_FALSE(host::SensorPacer::message(ours.layout, 2ms));
    controller::Options options;
    options.layout.dbc = "config/foreign.dbc";
    options.layout.binding = "config/foreign_binding.toml";
    CHECK(host::SensorPacer::message(controller::load_setup(options).layout, 1ms) == can::Role::wheel);
}

TEST_CASE("a step for each period of the sensors, when their last frame is there", "[RT-045]") {
    PacerBench bench;
    // A rig whose clock is 100 ppm slow and whose frames jitter by 0.2 ms.
    std::vector<Time> sent;
    for (int period = 1; period <= 2000; ++period) {
        sent.push_back(bench.start + period * 1000100ns + (period * 7919 % 200 - 400) * 1us);
        bench.sensors(sent.back());
    }
    for (const Time at : sent) {
        const host::Wake wake = bench.next();
        REQUIRE(wake.now == at);
        REQUIRE(wake.woke == at);
        REQUIRE(wake.latency == 0ms);
        REQUIRE(wake.skipped == 0);
        REQUIRE(wake.taken.frames == 3);
        REQUIRE_FALSE(wake.by_timer);
        REQUIRE(bench.port.sensors().pressure.received == at);
    }
}

TEST_CASE("a frame that is lost costs no step: the timer makes it half a period later", "[RT-045]") {
    PacerBench bench;
    for (const int period : {1, 2, 4, 5}) bench.sensors(bench.start + period * 1ms);
    for (const Time at : {1000us, 2000us, 3500us, 4000us, 5000us}) {
        const host::Wake wake = bench.next();
        CHECK(wake.now - bench.start == at);
        CHECK(wake.by_timer == (at == 3500us));
        CHECK(wake.skipped == 0);
    }
}

TEST_CASE("a damaged frame keeps the rig's time", "[RT-045]") {
    PacerBench bench;
    bench.sensors(bench.start + 1ms);
    can::Frame damaged = bench.rig.pressure(0.0F);
    damaged.data[0] ^= 0x10U;
    bench.bus.arrives(bench.start + 2ms, damaged);
    bench.sensors(bench.start + 3ms);
    for (const int period : {1, 2, 3}) {
        const host::Wake wake = bench.next();
        CHECK(wake.now - bench.start == period * 1ms);
        CHECK_FALSE(wake.by_timer);
    }
}

TEST_CASE("without the sensors the timer makes every step, until they are there", "[RT-045]") {
    PacerBench bench;
    bench.sensors(bench.start + 10400us);
    for (int period = 1; period <= 10; ++period) {
        // Other frames wake nobody up.
        bench.bus.arrives(bench.start + period * 1ms - 300us, bench.rig.heartbeat());
        const host::Wake wake = bench.next();
        CHECK(wake.now - bench.start == period * 1ms);
        CHECK(wake.by_timer);
        CHECK(wake.latency == 0ms);
    }
    const host::Wake back = bench.next();
    CHECK_FALSE(back.by_timer);
    CHECK(back.now - bench.start == 10500us);  // half a period after the timer's
    bench.sensors(bench.start + 11400us);
    CHECK(bench.next().now - bench.start == 11400us);
}

TEST_CASE("frames that come at once make one step, and none sooner than half a period after the last", "[RT-045]") {
    PacerBench bench;
    for (const Time at : {1000us, 1050us, 1100us, 2000us}) bench.sensors(bench.start + at);
    CHECK(bench.next().now - bench.start == 1000us);
    CHECK(bench.next().now - bench.start == 1500us);
    CHECK(bench.next().now - bench.start == 2000us);
}

TEST_CASE("a loop that is held up steps once, with the newest, and says how many periods it missed", "[RT-045]") {
    PacerBench bench;
    for (int period = 1; period <= 6; ++period) bench.sensors(bench.start + period * 1ms);
    CHECK(bench.next().skipped == 0);
    bench.clock.advance(3300us);
    const host::Wake late = bench.next();
    CHECK(late.now - bench.start == 4300us);
    CHECK(late.skipped == 2);
    CHECK(late.latency == 2300us);
    CHECK(late.taken.frames == 9);
    const host::Wake next = bench.next();
    CHECK(next.now - bench.start == 5000us);
    CHECK(next.skipped == 0);

    bench.clock.advance(6700us);  // the rig is gone after 6 ms
    const host::Wake alone = bench.next();
    CHECK(alone.now - bench.start == 11700us);
    CHECK(alone.skipped == 5);
    const host::Wake timer = bench.next();
    CHECK(timer.by_timer);
    CHECK(timer.skipped == 0);
    CHECK(timer.now - bench.start == 12200us);
    CHECK(bench.next().now - bench.start == 13200us);
}

TEST_CASE("the pacer ends when it is told to", "[RT-045]") {
    PacerBench bench;
    bench.stop = true;
    CHECK_FALSE(bench.pacer.next(bench.stop));
    bench.stop = false;
    bench.clock.on_sleep = [&](Time) { bench.stop = true; };
    CHECK(bench.next().by_timer);
    CHECK_FALSE(bench.pacer.next(bench.stop));
}

TEST_CASE("by the sensors the loop answers at once, by the timer when that comes", "[RT-045]") {
    const bool by_sensors = GENERATE(false, true);
    LoopBench bench(by_sensors ? controller::ClockSource::sensors : controller::ClockSource::timer);
    if (by_sensors)
        bench.plan_sensors(500, [&](int) { bench.rig_period(at_rest()); });
    else
        bench.plan_timer(500, [&](int) { bench.rig_period(at_rest()); });
    bench.run();
    CHECK(bench.statistics().steps >= 500);
    CHECK(bench.statistics().by_timer <= 1);
    CHECK(bench.statistics().faults_seen.empty());
    CHECK(bench.statistics().edge_to_command.count() >= 500);
    CHECK(bench.statistics().edge_to_command.percentile(0.99) == (by_sensors ? 0ms : 1ms));
    CHECK(bench.statistics().period.percentile(0.5) >= 1ms);
}

TEST_CASE("in lockstep the answer is counted from SYNC", "[RT-045]") {
    LoopBench bench(controller::ClockSource::sync);
    bench.run_sync(100, [&](int) {
        bench.rig_period(at_rest());
        bench.rig_sync();
        bench.clock.advance(70us);
    });
    CHECK(bench.statistics().edge_to_command.count() == 100 / host::ControlLoop::kTimedSteps + 1);
    CHECK(bench.statistics().edge_to_command.minimum() == 70us);
    CHECK(bench.statistics().edge_to_command.maximum() == 70us);
}
