/// Faults do to frames and values what their kinds say.
#include "tests/catch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/can/rig_port.hpp"
#include "plant_sim/model/encoder.hpp"
#include "plant_sim/study/faults/frame_fault.hpp"
#include "plant_sim/study/faults/machine_fault.hpp"
#include "plant_sim/study/faults/value_fault.hpp"
#include "plant_sim/study/faults/valve_driver.hpp"
#include "plant_sim/study/faults/valve_fault.hpp"

namespace {

using antiskid::can::Frame;
using antiskid::can::Role;
using faults::Fault;
using faults::Kind;
using faults::Signal;

constexpr double kPeriod_s = 1e-3;

const antiskid::can::Layout& layout() {
    static const auto loaded = antiskid::can::load_layout("config/antiskid.dbc", "config/antiskid_binding.toml");
    return loaded;
}

Fault fault(Signal signal, Kind kind, double strength = 0.5, double share = 1.0, bool negative = false) {
    return {.what = {signal, kind}, .strength = strength, .share = share, .negative = negative, .lasts_s = Fault::kForGood};
}

struct Reception {
    std::vector<std::int64_t> periods;
    std::vector<float> pressures_Pa;
    antiskid::can::MessageStats stats;
};

/// A thousand pressure frames, one a period, 500 Pa higher each, through a fault that acts from the first on.
Reception through(const Fault& f) {
    antiskid::can::RigPort rig(layout(), std::chrono::milliseconds{1});
    antiskid::can::ControllerPort port(layout(), std::chrono::milliseconds{1});
    faults::FrameFault bus(f, layout(), Role::pressure);
    rig::Random random(7);
    Reception reception;
    for (std::int64_t period = 0; period < 1300; ++period) {
        if (period < 1000) bus.send(rig.pressure(500.0F * static_cast<float>(period)), true, period, random);
        while (const auto frame = bus.receive(period)) {
            const std::uint32_t before = port.stats(Role::pressure).accepted;
            port.accept(*frame);
            reception.periods.push_back(period);
            if (port.stats(Role::pressure).accepted != before) reception.pressures_Pa.push_back(port.sensors().pressure.pressure_Pa);
        }
    }
    reception.stats = port.stats(Role::pressure);
    return reception;
}

/// An encoder of 60 teeth at 100 rad/s for a second behind a fault that acts in the second half of it; the speed it shows over the last
/// 0.4 s.
double shown_radps(const Fault& f) {
    faults::EncoderFault encoder(f, 60.0, 400.0);
    rig::Random random(7);
    plant::Encoder truth({.teeth = 60.0});
    antiskid::can::SpeedSample early;
    antiskid::can::SpeedSample late;
    for (int i = 1; i <= 1000; ++i) {
        const double now_s = i * kPeriod_s;
        truth.advance(100.0 * now_s, 100.0, 100.0, now_s, kPeriod_s, random);
        const antiskid::can::SpeedSample sample{
            .edge_count = truth.edge_count(), .edge_time = antiskid::control::Time{std::llround(truth.edge_time_s() * 1e9)}, .speed_radps = 100.0F};
        late = encoder.apply(sample, 100.0, now_s, kPeriod_s, i > 500, random);
        if (i == 600) early = late;
    }
    const auto edges = static_cast<std::int32_t>(late.edge_count - early.edge_count);
    const double took_s = std::chrono::duration<double>(late.edge_time - early.edge_time).count();
    return took_s > 0.0 ? edges * 2.0 * std::numbers::pi / 60.0 / took_s : 0.0;
}

}  // namespace

TEST_CASE("fault campaign: frames are lost, late, twice or out of order", "[RIG-700]") {
    CHECK(through(fault(Signal::pressure, Kind::drop)).periods.empty());
    const Reception some = through(fault(Signal::pressure, Kind::drop, 0.5, 0.3));
    CHECK(some.periods.size() > 620);
    CHECK(some.periods.size() < 780);

    const Reception late = through(fault(Signal::pressure, Kind::delay, 0.5));  // 20 periods
    REQUIRE(late.periods.size() == 1000);
    CHECK(late.periods.front() == 20);
    CHECK(late.stats.accepted == 1000);

    const Reception jitter = through(fault(Signal::pressure, Kind::jitter, 1.0));  // up to 50
    REQUIRE(jitter.periods.size() == 1000);
    CHECK(std::is_sorted(jitter.pressures_Pa.begin(), jitter.pressures_Pa.end()));
    CHECK(jitter.stats.accepted == 1000);
    CHECK(jitter.periods.back() <= 999 + 50);

    const Reception twice = through(fault(Signal::pressure, Kind::duplicated));
    CHECK(twice.periods.size() == 2000);
    CHECK(twice.stats.wrong_counter == 1000);

    const Reception swapped = through(fault(Signal::pressure, Kind::reordered));
    CHECK(swapped.periods.size() == 1000);
    CHECK(swapped.stats.wrong_counter > 0);
    CHECK_FALSE(std::is_sorted(swapped.periods.begin(), swapped.periods.end(), std::less_equal<>()));
}

TEST_CASE("fault campaign: corrupt frames fail their check value, wrong counters have a right one", "[RIG-700]") {
    const Reception corrupt = through(fault(Signal::pressure, Kind::corrupt));
    CHECK(corrupt.stats.wrong_crc > 900);
    const Reception counter = through(fault(Signal::pressure, Kind::wrong_counter));
    CHECK(counter.stats.wrong_crc == 0);
    CHECK(counter.stats.wrong_counter > 500);
    const Reception standing = through(fault(Signal::pressure, Kind::wrong_counter, 0.5, 1.0, true));
    CHECK(standing.stats.accepted == 1);
    CHECK(standing.stats.wrong_counter == 999);
    const Reception old = through(fault(Signal::pressure, Kind::replayed, 0.5, 0.5));
    CHECK(old.stats.wrong_counter > 100);
    CHECK_FALSE(std::is_sorted(old.pressures_Pa.begin(), old.pressures_Pa.end()));
}

TEST_CASE("fault campaign: an encoder's faults show in its speed", "[RIG-700]") {
    CHECK(shown_radps(fault(Signal::wheel, Kind::drop)) == Approx(100.0).epsilon(0.01));
    CHECK(shown_radps(fault(Signal::wheel, Kind::freeze)) == 0.0);
    CHECK(shown_radps(fault(Signal::wheel, Kind::bias, 1.0)) == Approx(150.0).epsilon(0.01));
    CHECK(shown_radps(fault(Signal::wheel, Kind::bias, 1.0, 1.0, true)) == Approx(50.0).epsilon(0.01));
    CHECK(shown_radps(fault(Signal::wheel, Kind::saturation, 0.0)) == Approx(20.0).epsilon(0.01));
    CHECK(shown_radps(fault(Signal::wheel, Kind::saturation, 0.0, 1.0, true)) == Approx(400.0).epsilon(0.01));
    CHECK(shown_radps(fault(Signal::wheel, Kind::wrong_sign)) == Approx(-100.0).epsilon(0.01));
    // 6.4 turns in 0.4 s, one tooth less in each.
    CHECK(shown_radps(fault(Signal::wheel, Kind::missing_tooth, 0.0)) == Approx(100.0 * 59.0 / 60.0).epsilon(0.005));
    CHECK(shown_radps(fault(Signal::wheel, Kind::clock_step)) == Approx(100.0).epsilon(0.01));
}

TEST_CASE("fault campaign: values and switches", "[RIG-700]") {
    rig::Random random(7);
    const faults::Scale scale{.min_bias = 1.0, .max_bias = 100.0, .full = 50.0};
    const auto value = [&](Kind kind, double x, bool negative = false) {
        faults::ValueFault f(fault(Signal::pressure, kind, 0.5, 1.0, negative), scale);
        CHECK(f.apply(x, false, random) == x);
        return f.apply(x, true, random);
    };
    CHECK(value(Kind::bias, 5.0) == Approx(15.0));
    CHECK(value(Kind::bias, 5.0, true) == Approx(-5.0));
    CHECK(value(Kind::spike, 5.0) == Approx(15.0));
    CHECK(value(Kind::saturation, 30.0) == Approx(25.0));
    CHECK(value(Kind::saturation, 5.0, true) == Approx(50.0));
    CHECK(value(Kind::wrong_sign, 5.0) == Approx(-5.0));
    CHECK(value(Kind::noise, 5.0) != 5.0);
    faults::ValueFault frozen(fault(Signal::pressure, Kind::freeze), scale);
    CHECK(frozen.apply(3.0, true, random) == 3.0);
    CHECK(frozen.apply(4.0, true, random) == 3.0);
    CHECK(frozen.apply(4.0, false, random) == 4.0);

    faults::SwitchFault turned(fault(Signal::arm, Kind::wrong_sign));
    CHECK(turned.apply(true, false, random));
    CHECK_FALSE(turned.apply(true, true, random));
}

TEST_CASE("fault campaign: valve and machine", "[RIG-700]") {
    rig::Random random(7);
    const auto valve = [&](Kind kind, bool negative = false) {
        faults::ValveFault f(fault(Signal::valve, kind, 0.5, 1.0, negative), kPeriod_s);
        CHECK(f.apply(20.0, false, random) == 20.0);
        return f.apply(0.0, true, random);
    };
    CHECK(valve(Kind::stuck) == 20.0);
    CHECK(valve(Kind::slow) > 19.0);
    CHECK(valve(Kind::slow) < 20.0);
    CHECK(valve(Kind::leaking) == 0.0);
    CHECK(valve(Kind::leaking, true) > 3.0);

    faults::MachineFault stalls(fault(Signal::controller, Kind::overrun));
    CHECK_FALSE(stalls.effect(false, random).misses_period);
    CHECK(stalls.effect(true, random).misses_period);
    faults::MachineFault off(fault(Signal::controller, Kind::bus_off));
    CHECK(off.effect(true, random).bus_off);
    faults::MachineFault leap(fault(Signal::controller, Kind::clock_step));
    CHECK(leap.effect(true, random).clock.count() > 0);
    CHECK(leap.effect(false, random).clock.count() > 0);  // a clock does not jump back
    faults::MachineFault stamps(fault(Signal::controller, Kind::clock_step, 0.5, 0.3, true));
    CHECK(stamps.effect(true, random).stamps.count() < 0);
}

TEST_CASE("fault campaign: the valve's driver", "[RIG-700]") {
    using antiskid::control::Time;
    faults::ValveDriver driver;
    antiskid::can::ControllerView view;
    antiskid::can::MessageStats stats;
    driver.update(view, stats, Time{0});
    CHECK(driver.current_mA() == 0.0);
    view.command_received = Time{0};
    view.current_mA = 12.0F;
    ++stats.accepted;
    driver.update(view, stats, Time{20'000'000});
    CHECK(driver.current_mA() == 12.0);
    driver.update(view, stats, Time{21'000'000});
    CHECK_FALSE(driver.has_command());
    CHECK(driver.current_mA() == 0.0);
    // Three of four are refused, the fourth is fresh.
    int reception = 0;
    for (int i = 0; i < 100; ++i) {
        const Time now{22'000'000 + i * 1'000'000};
        if (i % 4 == 0) {
            ++stats.accepted;
            view.command_received = now;
        } else {
            ++stats.wrong_counter;
        }
        driver.update(view, stats, now);
        if (driver.has_command()) ++reception;
    }
    CHECK(reception > 20);
    CHECK(reception < 60);
    CHECK(driver.current_mA() == 0.0);
}
