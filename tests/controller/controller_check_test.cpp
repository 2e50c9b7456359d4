// antiskid-controller --check as a whole, against a rig in process and a machine that is told.
#include "firmware/controller/controller_check.hpp"

#include <stdexcept>

#include "firmware/can/observer.hpp"
#include "tests/controller/results.hpp"
#include "tests/controller/rig_at_rest.hpp"
#include "tests/controller/sound_link.hpp"

using namespace controller_test;
using namespace std::chrono_literals;

namespace {

/// The rig's end of the bus, as an object that may be owned.
class Ear final : public can::Bus {
  public:
    explicit Ear(can::Bus& bus) : bus_(bus) {}
    std::size_t receive(std::span<can::Frame> frames) override { return bus_.receive(frames); }
    bool send(const can::Frame& frame) override { return bus_.send(frame); }
    bool wait(can::Time timeout) override { return bus_.wait(timeout); }
    [[nodiscard]] can::LinkStatus status() const override { return bus_.status(); }

  private:
    can::Bus& bus_;
};

controller::MachineFacts sound_machine() {
    controller::MachineFacts facts;
    facts.realtime_kernel = facts.fifo_granted = facts.memory_locked = facts.pinned = true;
    facts.isolated = std::string("1");
    facts.clock_source = std::string("tsc");
    facts.clock_resolution_s = 1e-9;
    facts.clock_synchronised = true;
    facts.record_free_bytes = 1e9;
    return facts;
}

struct CheckBench {
    CheckBench() {
        options.interface = std::string("can0");  // GCC 12 warns falsely of text that is assigned
        options.realtime.cpu = 1;
        options.check = controller::CheckRequest{};
        options.check->timing_s = 1;
    }
    controller::Report run() {
        const controller::CheckContext context{.machine = [](const auto&) { return sound_machine(); },
                                               .link = [](const auto&) { return controller_test::sound_link(); },
                                               .open = [this](std::span<const std::uint16_t>) -> std::unique_ptr<can::Bus> {
                                                   if (!rejection.empty()) throw std::runtime_error(rejection);
                                                   return std::make_unique<Ear>(rig.ear);
                                               },
                                               .clock = rig.clock,
                                               .on_loop_thread = [](control::Time, const std::function<void()>& work) { work(); }};
        return controller::controller_report(options, context, stop);
    }
    [[nodiscard]] std::vector<float> commands() const {
        can::Observer observer(rig.setup.layout);
        std::vector<float> currents;
        for (const can::Frame& frame : rig.reception)
            if (observer.accept(frame) == can::Role::valve) currents.push_back(observer.view().controller.current_mA);
        return currents;
    }

    RigAtRest rig;
    controller::Options options;
    std::string rejection;
    std::atomic<bool> stop{false};
};

}  // namespace

TEST_CASE("a sound machine and a rig at rest: fit, nothing sent, the valve step not counted as passed", "[RT-130]") {
    CheckBench bench;
    const controller::Report report = bench.run();
    CHECK(wrong(report.checks).empty());
    CHECK(passed(report));
    CHECK(report.config_hash == bench.rig.setup.config_hash);
    CHECK(named(report.checks, "valve step").verdict == controller::CheckResult::skipped);
    CHECK(bench.rig.reception.empty());
}

TEST_CASE("the valve step moves the valve by a little, and the safe current is the last on the bus", "[RT-130]") {
    CheckBench bench;
    bench.options.check->valve_step = true;
    const controller::Report report = bench.run();
    CAPTURE(named(report.checks, "valve step").measured);
    CHECK(named(report.checks, "valve step").verdict == controller::CheckResult::pass);
    CHECK(bench.rig.largest_Pa > 0.9e6F);
    CHECK(bench.rig.largest_Pa < 1.2e6F);
    const std::vector<float> commands = bench.commands();
    REQUIRE(commands.size() > 500);
    for (std::size_t i = commands.size() - 3; i < commands.size(); ++i) CHECK(commands[i] == 0.0F);
}

TEST_CASE("the valve is not touched unless everything stands, is released, is heard and nobody else commands", "[RT-130]") {
    CheckBench bench;
    bench.options.check->valve_step = true;
    const char* why = "";
    SECTION("wheel") {
        bench.rig.each = [&](int period) {
            if (period % 10 != 0) return;
            ++bench.rig.sample.wheel.edge_count;
            bench.rig.sample.wheel.edge_time = bench.rig.clock.now();
        };
        why = "the wheel turns";
    }
    SECTION("flywheel") {
        bench.rig.each = [&](int period) {
            if (period % 10 != 0) return;
            ++bench.rig.sample.flywheel.edge_count;
            bench.rig.sample.flywheel.edge_time = bench.rig.clock.now();
        };
        why = "the flywheel turns";
    }
    SECTION("pressure") {
        bench.rig.pressure_offset_Pa = 0.6e6F;
        why = "there is pressure";
    }
    SECTION("emergency stop") {
        bench.rig.sample.emergency_stop = true;
        why = "the emergency stop is pressed";
    }
    SECTION("a sensor that is not heard") {
        bench.rig.disturb = [&](const can::Frame& f) { return f.id != bench.rig.setup.layout[can::Role::pressure].id; };
        why = "no pressure frames";
    }
    SECTION("a sensor that is damaged") {
        bench.rig.disturb = [&](can::Frame& f) {
            static_cast<void>(f.id == bench.rig.setup.layout[can::Role::wheel].id && (f.data[3] ^= 1U));
            return true;
        };
        why = "no wheel frames";
    }
    SECTION("no bus") {
        bench.rejection = std::string("CAN interface 'can0' is down");
        why = "no bus";
    }
    const controller::Report report = bench.run();
    const controller::Check step = named(report.checks, "valve step");
    CHECK(step.verdict == controller::CheckResult::fail);
    CHECK(step.measured == std::string("refused, valve untouched: ") + why);
    CHECK(bench.rig.reception.empty());
}

TEST_CASE("a wheel that begins to turn during the step, and the operator, end it with the safe current", "[RT-130]") {
    CheckBench bench;
    bench.options.check->valve_step = true;
    SECTION("wheel") {
        bench.rig.each = [&](int period) {
            if (period == 1200) ++bench.rig.sample.wheel.edge_count;
        };
        CHECK_THAT(named(bench.run().checks, "valve step").measured, ContainsSubstring("the wheel turns"));
    }
    SECTION("operator") {
        bench.rig.each = [&](int period) { bench.stop = period >= 1200; };
        CHECK_THAT(named(bench.run().checks, "valve step").measured, ContainsSubstring("ended by a signal"));
    }
    const std::vector<float> commands = bench.commands();
    REQUIRE(commands.size() > 100);
    CHECK(commands.size() < 250);
    CHECK(commands[commands.size() - 5] > 5.0F);
    for (std::size_t i = commands.size() - 3; i < commands.size(); ++i) CHECK(commands[i] == 0.0F);
}

TEST_CASE("a bus that cannot be opened fails by its reason; the loop is timed all the same", "[RT-130]") {
    CheckBench bench;
    bench.rejection = std::string("CAN interface 'can0' is down");
    const auto checks = bench.run().checks;
    CHECK(wrong(checks) == Wrong{"CAN socket: fail"});
    CHECK(named(checks, "CAN socket").measured == bench.rejection);
    CHECK(named(checks, "wheel frames").verdict == controller::CheckResult::skipped);
    CHECK(named(checks, "loop latency").verdict == controller::CheckResult::pass);
}

TEST_CASE("a configuration that is refused, or is not the expected one, is a check that failed", "[RT-130]") {
    CheckBench bench;
    SECTION("rejected") {
        bench.options.controller = "config/no_such.toml";
        const controller::Report report = bench.run();
        CHECK(report.config_hash.empty());
        CHECK(wrong(report.checks) == Wrong{"configuration: fail"});
        CHECK_THAT(named(report.checks, "configuration").measured, ContainsSubstring("config/no_such.toml"));
        CHECK_FALSE(passed(report));
    }
    SECTION("another hash") {
        bench.options.check->expect_hash = std::string(32, '0');
        CHECK(wrong(bench.run().checks) == Wrong{"configuration: fail"});
    }
    SECTION("the expected hash") {
        bench.options.check->expect_hash = bench.rig.setup.config_hash;
        CHECK(wrong(bench.run().checks).empty());
    }
}
