// The real loop, controller and frames on the in-process bus. The truth is what the rig at the other end hears.
#include <algorithm>
#include <cstring>
#include <random>

#include "tests/catch.hpp"
#include "tests/host/loop_bench.hpp"
#include "tests/host/toy_rig.hpp"

using namespace host_test;
using controller::ClockSource;

namespace {

bool same_bytes(const std::vector<can::Frame>& a, const std::vector<can::Frame>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const can::Frame& x, const can::Frame& y) { return x.id == y.id && x.length == y.length && x.data == y.data; });
}

/// A landing in lockstep; `noise` moves the machine's clock by random amounts.
std::vector<can::Frame> landing(const int periods, const std::uint64_t noise, control::State* last = nullptr, control::FaultSet* faults = nullptr) {
    LoopBench bench(ClockSource::sync);
    ToyRig rig(bench.setup.control, control::Law::open_loop);
    std::mt19937_64 random(noise);
    bench.run_sync(periods, [&](int) {
        bench.clock.advance(Time{noise == 0 ? 0 : static_cast<std::int64_t>(random() % 700'000)});
        bench.rig_period(rig.sample());
        bench.rig_sync();
        rig.advance(static_cast<double>(bench.rig.controller().current_mA), 1e-3);
    });
    if (last != nullptr) *last = bench.statistics().last_state;
    if (faults != nullptr) *faults = bench.statistics().faults_seen;
    return bench.received;
}

}  // namespace

TEST_CASE("lockstep: one valve command for each SYNC, and it is the last frame of its cycle", "[RT-030]") {
    LoopBench bench(ClockSource::sync);
    std::size_t heard_before = 0;
    bench.run_sync(1000, [&](const int period) {
        bench.collect();
        const auto fresh = std::span(bench.received).subspan(heard_before);
        heard_before = bench.received.size();
        if (period == 0) {
            REQUIRE(fresh.empty());
        } else {
            REQUIRE_FALSE(fresh.empty());
            REQUIRE(fresh.back().id == bench.id(can::Role::valve));
            REQUIRE(std::count_if(fresh.begin(), fresh.end(), [&](const can::Frame& f) { return f.id == bench.id(can::Role::valve); }) == 1);
        }
        bench.rig_period(at_rest());
        bench.rig_sync();
    });
    const auto count = [&](const can::Role role) {
        return std::count_if(bench.received.begin(), bench.received.end(), [&](const can::Frame& f) { return f.id == bench.id(role); });
    };
    CHECK(bench.statistics().steps == 1000);
    CHECK(count(can::Role::valve) == 1000 + host::ControlLoop::kSafeCommands);
    CHECK(count(can::Role::status) == 100);
    CHECK(count(can::Role::faults) == 100);
    CHECK(count(can::Role::controller_heartbeat) == 10);
    CHECK(bench.rig.stats(can::Role::valve).rejected() == 0);
    CHECK(bench.rig.stats(can::Role::valve).lost == 0);
}

TEST_CASE("by the timer the valve command goes first", "[RT-045]") {
    LoopBench bench(ClockSource::timer);
    std::size_t heard_before = 0;
    bench.run_timer(500, [&](const int period) {
        bench.collect();
        const auto fresh = std::span(bench.received).subspan(heard_before);
        heard_before = bench.received.size();
        if (period > 0) REQUIRE(fresh.front().id == bench.id(can::Role::valve));
        bench.rig_period(at_rest());
    });
    CHECK(bench.statistics().steps == 500);
    CHECK(bench.statistics().overruns == 0);
    CHECK(bench.statistics().faults_seen.empty());
    CHECK(bench.statistics().last_state == control::State::standby);
    CHECK(bench.statistics().period.minimum() == 1ms);
    CHECK(bench.statistics().period.maximum() == 1ms);
}

TEST_CASE("a landing in lockstep brakes, and ends with the safe current as the last commands", "[RT-032]") {
    LoopBench bench(ClockSource::sync);
    ToyRig rig(bench.setup.control, control::Law::open_loop);
    float braking_mA = 0.0F;
    bench.run_sync(2500, [&](int) {
        bench.rig_period(rig.sample());
        bench.rig_sync();
        braking_mA = bench.rig.controller().current_mA;
        rig.advance(static_cast<double>(braking_mA), 1e-3);
    });
    INFO("faults " << bench.statistics().faults_seen.bits());
    CHECK(bench.statistics().faults_seen.empty());
    REQUIRE(bench.statistics().last_state == control::State::braking);
    REQUIRE(braking_mA == Approx(12.0F).margin(0.1));

    REQUIRE(bench.statistics().safe_commands_sent == host::ControlLoop::kSafeCommands);
    const auto tail = std::span(bench.received).last(host::ControlLoop::kSafeCommands);
    can::RigPort listener(bench.setup.layout, bench.setup.period);
    for (const can::Frame& frame : tail) {
        CHECK(frame.id == bench.id(can::Role::valve));
        listener.accept(frame);
        CHECK(listener.controller().current_mA == Approx(bench.setup.control.valve.safe_current_mA).margin(1e-6));
    }
    CHECK(listener.stats(can::Role::valve).accepted == host::ControlLoop::kSafeCommands);
    CHECK(bench.rig.stats(can::Role::valve).rejected() == 0);
    CHECK(bench.rig.stats(can::Role::valve).lost == 0);
}

TEST_CASE("by the timer, too, stopping while braking ends with the safe current", "[RT-032]") {
    LoopBench bench(ClockSource::timer);
    ToyRig rig(bench.setup.control, control::Law::open_loop);
    float braking_mA = 0.0F;
    bench.run_timer(2500, [&](int) {
        bench.rig_period(rig.sample());
        braking_mA = bench.rig.controller().current_mA;
        rig.advance(static_cast<double>(braking_mA), 1e-3);
    });
    REQUIRE(braking_mA == Approx(12.0F).margin(0.1));
    CHECK(bench.received.back().id == bench.id(can::Role::valve));
    CHECK(bench.rig.controller().current_mA == Approx(bench.setup.control.valve.safe_current_mA).margin(1e-6));
}

TEST_CASE("the safe current is tried until it gets through, but not for ever", "[RT-032]") {
    SECTION("the link stays down") {
        LoopBench late(ClockSource::timer);
        late.run_timer(50, [&](const int period) {
            late.rig_period(at_rest());
            if (period == 49) late.controller_end.set_link(false, false);
        });
        CHECK(late.statistics().safe_commands_sent == 0);
    }
    SECTION("a queue that is full for a while") {
        LoopBench late(ClockSource::timer);
        int period = 0;
        int closing = 0;
        Time stopped_at{};
        late.clock.on_sleep = [&](Time) {
            if (late.stop) {
                if (++closing == 10) late.controller_end.set_link(true, false);
                return;
            }
            late.rig_period(at_rest());
            if (++period < 50) return;
            late.controller_end.set_link(false, false);
            stopped_at = late.clock.now();
            late.stop = true;
        };
        late.session->loop().run(late.stop);
        CHECK(late.clock.now() - stopped_at >= 12 * late.setup.period);  // one period apart, not all at once
        late.collect();
        CHECK(late.statistics().safe_commands_sent == 3);
        CHECK(closing == 13);
        CHECK(late.received.back().id == late.id(can::Role::valve));
    }
}

TEST_CASE("missed periods reach the controller: many in quick succession are a fault, one is not", "[RT-034]") {
    LoopBench bench(ClockSource::timer);
    const int stalls = GENERATE(0, 1, 40);
    bench.run_timer(700, [&](const int period) {
        bench.rig_period(at_rest());
        if (period >= 400 && period < 400 + stalls) bench.clock.advance(2500us);
    });
    CHECK(bench.statistics().overruns == static_cast<std::uint64_t>(stalls));
    CHECK(bench.statistics().missed_periods >= static_cast<std::uint64_t>(stalls));
    CHECK(bench.statistics().overrun.count() == static_cast<std::uint64_t>(stalls));
    CHECK(bench.statistics().faults_seen.contains(control::Fault::overrun) == (stalls == 40));
    const auto in_safe = bench.statistics().steps_in_state[static_cast<std::size_t>(control::State::safe)];
    CHECK((in_safe > 0) == (stalls == 40));
}

TEST_CASE("nothing is sent before the first SYNC", "[RT-030]") {
    LoopBench bench(ClockSource::sync);
    bench.run_sync(200, [&](int) { bench.rig_period(at_rest()); });  // 4 s of waiting, sensors but no SYNC
    CHECK(bench.statistics().steps == 0);
    CHECK(bench.received.size() == host::ControlLoop::kSafeCommands);  // the closing ones
}

TEST_CASE("a SYNC that fails to come: stepping goes on, what is missing is named, the valve is safe", "[RT-030]") {
    LoopBench bench(ClockSource::sync);
    ToyRig rig(bench.setup.control, control::Law::open_loop);
    float braking_mA = 0.0F;
    const Time silent_from = bench.clock.now();
    bench.run_sync(2500 + 800, [&](const int wait) {
        if (wait >= 2500) return;  // the rig has died; each wait lets time pass
        bench.rig_period(rig.sample());
        bench.rig_sync();
        braking_mA = bench.rig.controller().current_mA;
        rig.advance(static_cast<double>(braking_mA), 1e-3);
    });
    REQUIRE(braking_mA > 5.0F);
    CHECK(bench.clock.now() - silent_from >= 1s);
    CHECK(bench.statistics().unsynchronised > 400);
    for (const auto fault : {control::Fault::wheel_lost, control::Fault::flywheel_lost, control::Fault::pressure_lost, control::Fault::maneuver_lost,
                             control::Fault::heartbeat_lost})
        CHECK(bench.statistics().faults_seen.contains(fault));
    CHECK(bench.statistics().last_state == control::State::safe);
    // Not before the time-out: until then nobody can know.
    CHECK(bench.statistics().first_seen[static_cast<std::size_t>(control::Fault::wheel_lost)] >= 2500ms);
    CHECK(bench.rig.controller().current_mA == Approx(bench.setup.control.valve.safe_current_mA).margin(1e-6));
}

TEST_CASE("a rig that goes on sending, but no SYNC, is found out all the same", "[RT-030]") {
    LoopBench bench(ClockSource::sync);
    bench.run_sync(5000, [&](const int wait) {
        if (wait >= 500) bench.clock.advance(1ms);
        bench.rig_period(at_rest());
        if (wait < 500) bench.rig_sync();
    });
    CHECK(bench.statistics().unsynchronised > 100);
}

TEST_CASE("SYNC that comes back takes over again", "[RT-030]") {
    LoopBench bench(ClockSource::sync);
    std::uint64_t unsynchronised = 0;
    bench.run_sync(2000, [&](const int wait) {
        if (wait >= 500 && wait < 700) return;
        if (wait == 701) unsynchronised = bench.statistics().unsynchronised;
        bench.rig_period(at_rest());
        bench.rig_sync();
    });
    CHECK(unsynchronised > 0);
    CHECK(bench.statistics().unsynchronised == unsynchronised);
}

TEST_CASE("a gap in the SYNC numbers counts as a missed period", "[RT-030]") {
    LoopBench bench(ClockSource::sync);
    bench.run_sync(400, [&](const int period) {
        bench.rig_period(at_rest());
        if (period == 100 || period == 200) ++bench.syncs;
        bench.rig_sync();
    });
    CHECK(bench.statistics().steps == 400);
    CHECK(bench.statistics().overruns == 2);
}

TEST_CASE("the numbers of SYNC may roll over", "[RT-030]") {
    LoopBench bench(ClockSource::sync);
    bench.syncs = static_cast<std::uint32_t>(bench.setup.layout.sync_counter.mask()) - 100;
    bench.run_sync(400, [&](int) {
        bench.rig_period(at_rest());
        bench.rig_sync();
    });
    CHECK(bench.statistics().overruns == 0);
}

TEST_CASE("same inputs, same bytes: the machine's clock has no part in lockstep", "[RT-030]") {
    control::State last{};
    const auto quiet = landing(2500, 0, &last);
    REQUIRE(last == control::State::braking);
    REQUIRE(quiet.size() > 2500);
    CHECK(same_bytes(quiet, landing(2500, 0)));
    CHECK(same_bytes(quiet, landing(2500, 1)));
    CHECK(same_bytes(quiet, landing(2500, 99)));
}

TEST_CASE("foreign and damaged frames change nothing but their counts", "[RT-034]") {
    const auto run = [](const bool disturbed) {
        LoopBench bench(ClockSource::sync);
        ToyRig rig(bench.setup.control, control::Law::open_loop);
        std::mt19937_64 random(7);
        bench.run_sync(2500, [&](int) {
            bench.rig_period(rig.sample());
            for (int i = 0; disturbed && i < 20; ++i) {
                can::Frame frame{.id = static_cast<std::uint32_t>(random() % 2048), .length = 8, .data = {}, .received = {}};
                const std::uint64_t bits = random();
                std::memcpy(frame.data.data(), &bits, 8);
                // A right CRC by chance is not the subject here, and SYNC has none.
                const bool ours = std::any_of(bench.setup.layout.messages.begin(), bench.setup.layout.messages.end(),
                                              [&](const can::Message& m) { return m.bound && m.id == frame.id; });
                if (!ours) bench.rig_end.send(frame);
            }
            bench.rig_sync();
            rig.advance(static_cast<double>(bench.rig.controller().current_mA), 1e-3);
        });
        if (disturbed) CHECK(bench.session->port().unknown_ids() > 40'000);
        return bench.received;
    };
    CHECK(same_bytes(run(false), run(true)));
}

TEST_CASE("a link that goes down is named, counted and survived", "[RT-040]") {
    LoopBench bench(ClockSource::timer);
    const bool bus_off = GENERATE(false, true);
    bench.run_timer(600, [&](const int period) {
        if (period == 200) bench.controller_end.set_link(false, bus_off);
        if (period == 250) bench.controller_end.set_link(true, false);
        bench.rig_period(at_rest());
    });
    CHECK(bench.statistics().steps == 600);
    CHECK(bench.statistics().link_outages == 1);
    CHECK(bench.statistics().frames_unsent >= 50);
    CHECK(bench.statistics().faults_seen.contains(control::Fault::bus_off));
    CHECK(bench.rig.controller().faults.contains(control::Fault::bus_off));
    CHECK(bench.statistics().safe_commands_sent == 3);
}

TEST_CASE("a valve command that the bus did not take is not taken for sent", "[RT-034]") {
    const auto source = GENERATE(ClockSource::timer, ClockSource::sync);
    LoopBench bench(source);
    std::vector<bool> unsent;
    bench.bus.rejects = [&](const can::Frame& frame) {
        const auto period = unsent.size();
        if (period > 200 && period <= 203) return true;
        return period > 300 && period <= 400 && frame.id != bench.id(can::Role::valve);
    };
    const auto before = [&](int) {
        unsent.push_back(bench.session->port().sensors().command_unsent);
        bench.rig_period(at_rest());
        bench.rig_sync();
    };
    if (source == ClockSource::timer)
        bench.run_timer(500, before);
    else
        bench.run_sync(500, before);
    REQUIRE(unsent.size() == 500);
    // Of a status frame that was refused the valve command before it, by the timer, knows nothing.
    for (std::size_t period = 0; period < 300; ++period) {
        INFO("period " << period);
        CHECK(unsent[period] == (period > 200 && period <= 203));
    }
    const auto later = std::count(unsent.begin() + 300, unsent.end(), true);
    CHECK((later > 0) == (source == ClockSource::sync));
    CHECK(bench.statistics().frames_unsent > 20);
}

TEST_CASE("every step leaves a record, and the ring gives them in order", "[RT-073]") {
    LoopBench bench(ClockSource::sync);
    bench.run_sync(1000, [&](int) {
        bench.rig_period(at_rest());
        bench.rig_sync();
    });
    host::CycleRecord record;
    for (std::uint64_t step = 1; step <= 1000; ++step) {
        REQUIRE(bench.session->ring().pop(record));
        REQUIRE(record.step == step);
        REQUIRE(record.now == (step - 1) * 1ms);
        REQUIRE(record.received >= 4);
        REQUIRE(record.synchronised);
    }
    CHECK_FALSE(bench.session->ring().pop(record));
    CHECK(bench.session->ring().dropped() == 0);
}
