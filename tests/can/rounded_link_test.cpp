#include "firmware/can/rounded_link.hpp"

#include <array>
#include <bit>
#include <limits>
#include <random>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using namespace antiskid;
using namespace antiskid::can;
using control::Time;

namespace {

bool same(float a, float b) {
    return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

bool same(const control::SpeedInput& a, const control::SpeedInput& b) {
    return a.received == b.received && a.rejected == b.rejected && a.source == b.source && a.edge_count == b.edge_count &&
           a.edge_time == b.edge_time && same(a.speed_radps, b.speed_radps);
}

bool same(const control::Sensors& a, const control::Sensors& b) {
    const control::ManeuverInput& m = a.maneuver;
    const control::ManeuverInput& n = b.maneuver;
    return same(a.wheel, b.wheel) && same(a.flywheel, b.flywheel) && a.pressure.received == b.pressure.received &&
           a.pressure.rejected == b.pressure.rejected && same(a.pressure.pressure_Pa, b.pressure.pressure_Pa) && m.received == n.received &&
           m.rejected == n.rejected && m.law == n.law && m.arm == n.arm && m.weight_on_wheels == n.weight_on_wheels &&
           same(m.demand_Pa, n.demand_Pa) && same(m.slip_reference, n.slip_reference) && same(m.deceleration_mps2, n.deceleration_mps2) &&
           same(m.current_mA, n.current_mA) && a.rig_heartbeat_received == b.rig_heartbeat_received && a.emergency_stop == b.emergency_stop &&
           a.bus_off == b.bus_off && a.missed_periods == b.missed_periods;
}

/// Draws that reach the ends of every range, and beyond.
class Draw {
  public:
    explicit Draw(unsigned seed) : random_(seed) {}
    unsigned below(unsigned n) { return std::uniform_int_distribution<unsigned>(0, n - 1)(random_); }
    float value(float max) {
        switch (below(12)) {
            case 0:
                return -max * fraction();
            case 1:
                return max * 1e6F * fraction();
            case 2:
                return std::numeric_limits<float>::quiet_NaN();
            case 3:
                return std::numeric_limits<float>::infinity() * (below(2) == 0 ? 1.0F : -1.0F);
            case 4:
                return std::numeric_limits<float>::denorm_min();
            default:
                return max * fraction();
        }
    }
    std::uint32_t edges() { return below(20) == 0 ? below(1U << 31U) : below(10); }
    std::int64_t nanoseconds() { return std::uniform_int_distribution<std::int64_t>(0, below(50) == 0 ? 400'000'000'000 : 3'000'000)(random_); }

  private:
    float fraction() { return std::uniform_real_distribution<float>(0.0F, 1.5F)(random_); }
    std::mt19937 random_;
};

void advance(SpeedSample& speed, Draw& draw) {
    speed.edge_count += draw.edges();
    speed.edge_time += Time{draw.nanoseconds()};
    speed.speed_radps = draw.value(400.0F);
}

void advance(RigSample& sample, Draw& draw) {
    advance(sample.wheel, draw);
    advance(sample.flywheel, draw);
    sample.pressure_Pa = draw.value(3.3e7F);
    sample.maneuver = {.law = static_cast<control::Law>(draw.below(4)),
                       .arm = draw.below(2) == 1,
                       .weight_on_wheels = draw.below(2) == 1,
                       .demand_Pa = draw.value(3.3e7F),
                       .slip_reference = draw.value(1.0F),
                       .deceleration_mps2 = draw.value(20.0F),
                       .current_mA = draw.value(50.0F)};
    sample.emergency_stop = draw.below(10) == 0;
}

}  // namespace

TEST_CASE("the short cut without bytes gives the controller exactly what the frames give it", "[CAN-070]") {
    for (const Layout* layout : {&can_test::ours(), &can_test::foreign()}) {
        for (const Time step : {Time{1'000'000}, Time{2'000'000}, Time{5'000'000}}) {
            Draw draw(70);
            RigPort rig(*layout, step);
            ControllerPort port(*layout, step);
            RoundedLink link(*layout, step);
            RigSample sample;
            sample.wheel.edge_count = 0xFFFF'FFF0U;
            sample.flywheel.edge_time = Time{-5'000'000'000};
            std::array<Frame, RigPort::kMaxFrames> frames;
            std::size_t differences = 0;
            for (int i = 0; i < 100'000; ++i) {
                advance(sample, draw);
                const Time now = i * step;
                port.clear_one_shots();
                const std::size_t count = rig.due_frames(sample, frames);
                for (std::size_t k = 0; k < count; ++k) {
                    frames[k].received = now;
                    port.accept(frames[k]);
                }
                differences += same(port.sensors(), link.sense(sample, now)) ? 0 : 1;
            }
            CHECK(differences == 0);
            CHECK(port.stats(Role::wheel).accepted == 100'000);
        }
    }
}

TEST_CASE(
    "the short cut keeps the layout's periods, and refuses what the frames would carry and the controller "
    "refuse",
    "[CAN-070][CAN-201]") {
    Layout slow = can_test::ours();
    slow[Role::wheel].period = Time{3'000'000};
    const Time step{1'000'000};
    RigPort rig(slow, step);
    ControllerPort port(slow, step);
    RoundedLink link(slow, step);
    RigSample sample;
    sample.maneuver.law = static_cast<control::Law>(control::kLawCount);
    std::array<Frame, RigPort::kMaxFrames> frames;
    for (int i = 0; i < 60; ++i) {
        const std::size_t count = rig.due_frames(sample, frames);
        for (std::size_t k = 0; k < count; ++k) {
            frames[k].received = i * step;
            port.accept(frames[k]);
        }
        REQUIRE(same(port.sensors(), link.sense(sample, i * step)));
    }
    CHECK(port.stats(Role::wheel).accepted == 20);
    CHECK(port.sensors().maneuver.rejected == 3);
    CHECK(port.sensors().maneuver.received == control::kNever);
}

TEST_CASE("the rig applies the same current with and without bytes", "[CAN-070]") {
    for (const Layout* layout : {&can_test::ours(), &can_test::foreign()}) {
        Draw draw(71);
        const Time step{1'000'000};
        RigPort rig(*layout, step);
        ControllerPort port(*layout, step);
        const RoundedLink link(*layout, step);
        std::size_t differences = 0;
        for (int i = 0; i < 300'000; ++i) {
            control::Command command;
            command.current_mA = draw.value(50.0F);
            rig.accept(port.valve_command(command.current_mA));
            differences += same(rig.controller().current_mA, link.current_mA(command)) ? 0 : 1;
        }
        CHECK(differences == 0);
        CHECK(rig.stats(Role::valve).accepted == 300'000);
    }
}

TEST_CASE("what the rig does not ask for is not asked for, and sources and times are the rig's", "[CAN-070]") {
    for (const Layout* layout : {&can_test::ours(), &can_test::foreign()}) {
        RoundedLink link(*layout, Time{1'000'000});
        RigSample sample;
        const Time now{7'000'000};
        const control::Sensors idle = link.sense(sample, now);
        CHECK_FALSE(idle.maneuver.arm);
        CHECK_FALSE(idle.maneuver.weight_on_wheels);
        CHECK(idle.maneuver.received == now);
        CHECK(idle.wheel.source == layout->wheel.source);
        sample.maneuver.arm = true;
        RoundedLink armed(*layout, Time{1'000'000});
        CHECK(armed.sense(sample, now).maneuver.arm);
        CHECK_FALSE(armed.sense(sample, now).maneuver.weight_on_wheels);
    }
    CHECK(RigPort(can_test::ours(), Time{1'000'000}).controller().speed_mps == 0.0F);
    CHECK(ControllerPort(can_test::ours(), Time{1'000'000}).sensors().wheel.speed_radps == 0.0F);
}
