// What of preflight refuses the start of a maneuver or campaign.
#include "rig_bridge/bridge/start_checks.hpp"

#include <chrono>
#include <span>
#include <stdexcept>

#include "tests/bridge/fakes.hpp"
#include "tests/catch.hpp"
#include "tests/controller/results.hpp"
#include "tests/controller/sound_link.hpp"

using antiskid::can::Role;
using controller_test::wrong;
using controller_test::Wrong;

namespace {

struct StartBench {
    StartBench() { facts.machine.record_free_bytes = 1e9; }
    antiskid::controller::Checks run() { return start_checks(facts, "can0", "runs/brake7"); }

    rig::bridge::StartFacts facts{.link = controller_test::sound_link(), .machine = {}, .bus = {}};
};

class Millisecond final : public antiskid::host::Clock {
  public:
    antiskid::can::Time now() override { return now_ += std::chrono::milliseconds(1); }
    void sleep_until(antiskid::can::Time) override {}

  private:
    antiskid::can::Time now_{};
};

/// There is always one more frame.
class EndlessBus final : public antiskid::can::Bus {
  public:
    std::size_t receive(std::span<antiskid::can::Frame> frames) override {
        if (++reads > 1000) throw std::logic_error("read for ever");
        frames[0] = {.id = 0x191, .length = 8};
        return 1;
    }
    bool send(const antiskid::can::Frame&) override { throw std::logic_error("sends"); }
    bool wait(antiskid::can::Time) override { return true; }
    [[nodiscard]] antiskid::can::LinkStatus status() const override { return {}; }

    int reads = 0;
};

}  // namespace

TEST_CASE("The look at the bus ends in time where frames come as fast as they are read", "[BRG-150]") {
    const antiskid::can::Layout layout = bridge_test::layout();
    EndlessBus bus;
    Millisecond clock;
    const rig::bridge::BusReception heard = rig::bridge::listen_to_bus(layout, bus, clock, std::chrono::milliseconds(300));
    CHECK(heard.until == std::chrono::milliseconds(301));
    CHECK(bus.reads > 200);
}

TEST_CASE("A start is refused by each cheap check alone, with its next step", "[BRG-150]") {
    StartBench bench;
    CHECK(wrong(bench.run()).empty());
    SECTION("another bridge on the bus") {
        bench.facts.bus.stats[static_cast<std::size_t>(Role::maneuver)].wrong_counter = 3;
        CHECK(wrong(bench.run()) == Wrong{"only bridge: fail"});
        CHECK_THAT(rig::bridge::NotFit(bench.run()).what(), ContainsSubstring("not started\n  only bridge: another one sent 3 commands; required: no "
                                                                              "other. Next: end the other bridge first"));
    }
    SECTION("two controllers") {
        bench.facts.bus.two_controllers = std::string("counter; two senders of 0x180, at counters 3 and 9");
        CHECK(wrong(bench.run()) == Wrong{"only controller: fail"});
        CHECK_THAT(rig::bridge::NotFit(bench.run()).what(), ContainsSubstring("at counters 3 and 9; required: one. Next: end one of them"));
    }
    SECTION("interface down") {
        bench.facts.link.up = false;
        CHECK(wrong(bench.run()) == Wrong{"CAN interface: fail"});
    }
    SECTION("bus-off") {
        bench.facts.link.state = 3;
        CHECK(wrong(bench.run()) == Wrong{"CAN state: fail"});
    }
    SECTION("no room for one maneuver") {
        bench.facts.machine.record_free_bytes = 9e6;
        CHECK(wrong(bench.run()) == Wrong{"disk of the record: fail"});
    }
}

TEST_CASE("What is only a warning, and another bit rate than preflight's default, starts", "[BRG-150]") {
    StartBench bench;
    bench.facts.link.state = 1;
    bench.facts.link.bitrate = 500'000;
    CHECK(wrong(bench.run()) == Wrong{"CAN state: warn"});
}
