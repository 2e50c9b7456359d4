/// The rig's side of the bus, against the real controller loop's counterpart on the in-process bus.
#include "plant_sim/virtual_rig/rig_node.hpp"

#include "firmware/can/controller_port.hpp"
#include "firmware/can/loopback.hpp"
#include "firmware/control/controller.hpp"
#include "tests/catch.hpp"
#include "tests/study/scenarios.hpp"

namespace {

using antiskid::can::Frame;
using antiskid::control::Time;

/// Time that passes only when somebody sleeps or waits.
class FakeClock final : public antiskid::host::Clock {
  public:
    Time now() override { return now_; }
    void sleep_until(Time deadline) override { now_ = std::max(now_, deadline); }
    void pass(Time time) { now_ += time; }

  private:
    Time now_{};
};

/// A bus whose far end answers as a program would, whenever the rig waits for it.
class AnsweringBus final : public antiskid::can::Bus {
  public:
    AnsweringBus(antiskid::can::Loopback::End& near, FakeClock& clock, std::function<void()> far)
        : near_(near), clock_(clock), far_(std::move(far)) {}
    std::size_t receive(std::span<Frame> frames) override { return near_.receive(frames); }
    bool send(const Frame& frame) override { return near_.send(frame); }
    bool wait(Time timeout) override {
        far_();
        const bool there = near_.wait(timeout);
        if (!there) clock_.pass(timeout);
        return there;
    }
    [[nodiscard]] antiskid::can::LinkStatus status() const override { return near_.status(); }

  private:
    antiskid::can::Loopback::End& near_;
    FakeClock& clock_;
    std::function<void()> far_;
};

struct Bench {
    explicit Bench(const plant_sim::StopOptions& options)
        : scenario(plant_sim::load_scenario(options)),
          step(std::llround(scenario.session.period_s * 1e9)),
          near(hub.connect()),
          far(hub.connect()),
          controller(scenario.controller),
          port(scenario.layout, step),
          session(scenario.plant.rig, scenario.session) {}

    /// One step for each SYNC, as antiskid-controller --clock sync does it.
    void answer() {
        std::array<Frame, 64> frames{};
        const std::size_t count = far.receive(frames);
        for (std::size_t i = 0; i < count; ++i) {
            frames[i].received = step * syncs;
            const auto before = port.sync_count();
            port.accept(frames[i]);
            if (port.sync_count() == before || (dies_at >= 0 && syncs >= dies_at)) continue;
            const auto command = controller.step(port.sensors(), step * syncs++);
            port.clear_one_shots();
            std::array<Frame, antiskid::can::ControllerPort::kMaxFrames> out{};
            const std::size_t due = port.due_frames(command, out);
            for (std::size_t k = 0; k < due; ++k) (void)far.send(out[k]);
        }
    }

    plant_sim::StopInputs scenario;
    Time step;
    FakeClock clock;
    antiskid::can::Loopback hub;
    antiskid::can::Loopback::End& near;
    antiskid::can::Loopback::End& far;
    antiskid::control::Controller controller;
    antiskid::can::ControllerPort port;
    study::RigSession session;
    std::int64_t syncs = 0;
    std::int64_t dies_at = -1;
    std::atomic<bool> stop{false};
};

constexpr Time kSecond{1'000'000'000};

}  // namespace

TEST_CASE("lockstep over a bus gives the figures of the run in process", "[STUDY-010]") {
    const auto options = scenarios::options({"wet_asphalt", "medium_b"});
    Bench bench(options);
    AnsweringBus bus(bench.near, bench.clock, [&bench] { bench.answer(); });
    plant_sim::RigNode node(bench.session, bench.scenario.layout, bus, bench.clock, bench.step);
    const auto result = node.run_lockstep(kSecond, kSecond, bench.stop, [](const auto&, const auto&, double) {});
    CHECK(result.ending == plant_sim::Ending::done);
    CHECK(result.frames_lost == 0);
    const auto in_process = scenarios::run(options, study::Link::frames);
    CHECK(bench.session.figures().stop_distance_m == in_process.figures.stop_distance_m);
    CHECK(bench.session.figures().j_mu == in_process.figures.j_mu);
    CHECK(result.frames_sent == in_process.frames_sent);
    CHECK(result.frames_received == in_process.frames_received);
}

TEST_CASE("a controller that falls silent ends the run, and the message says who and when", "[STUDY-051]") {
    Bench bench(scenarios::options({"wet_asphalt", "light"}));
    bench.dies_at = 1000;
    AnsweringBus bus(bench.near, bench.clock, [&bench] { bench.answer(); });
    plant_sim::RigNode node(bench.session, bench.scenario.layout, bus, bench.clock, bench.step);
    const auto result = node.run_lockstep(kSecond, 10 * kSecond, bench.stop, [](const auto&, const auto&, double) {});
    CHECK(result.ending == plant_sim::Ending::silent);
    CHECK_THAT(result.reason, ContainsSubstring("antiskid-controller did not answer SYNC 1000"));
}

TEST_CASE("a controller that is never there ends the run after the patience", "[STUDY-051]") {
    Bench bench(scenarios::options({"wet_asphalt", "light"}));
    AnsweringBus bus(bench.near, bench.clock, [] {});
    plant_sim::RigNode lockstep(bench.session, bench.scenario.layout, bus, bench.clock, bench.step);
    CHECK(lockstep.run_lockstep(kSecond, 3 * kSecond, bench.stop, [](const auto&, const auto&, double) {}).ending == plant_sim::Ending::silent);
    CHECK(bench.clock.now() >= 3 * kSecond);
    plant_sim::RigNode realtime(bench.session, bench.scenario.layout, bus, bench.clock, bench.step);
    CHECK(realtime.run_realtime(kSecond, bench.stop, [](const auto&, const auto&, double) {}).ending == plant_sim::Ending::silent);
}

TEST_CASE("the interface going down ends the run with its reason", "[STUDY-051]") {
    Bench bench(scenarios::options({"wet_asphalt", "light"}));
    AnsweringBus bus(bench.near, bench.clock, [&bench] {
        if (bench.syncs < 500)
            bench.answer();
        else
            bench.near.set_link(false, false);
    });
    plant_sim::RigNode node(bench.session, bench.scenario.layout, bus, bench.clock, bench.step);
    const auto result = node.run_lockstep(kSecond, kSecond, bench.stop, [](const auto&, const auto&, double) {});
    CHECK(result.ending == plant_sim::Ending::link_down);
    CHECK_THAT(result.reason, ContainsSubstring("interface went down"));
}
