/// Every abort cause in every phase, and random inputs: the outputs are safe in the same step, whatever happens.
#include <cmath>
#include <iterator>
#include <limits>
#include <string>

#include "rig_bridge/rig/random.hpp"
#include "tests/catch.hpp"
#include "tests/rig/rig_model.hpp"

using namespace sequencer_test;
using rig::Abort;
using rig::Sequencer;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// One way in which a cause shows in the inputs.
struct Mishap {
    const char* what;
    Abort cause;
    void (*strike)(Inputs&);
};

const Mishap kMishaps[] = {
    {"user", Abort::requested, [](Inputs& in) { in.abort_requested = true; }},
    {"emergency stop", Abort::emergency_stop, [](Inputs& in) { in.emergency_stop_clear = false; }},
    {"guard", Abort::guard_open, [](Inputs& in) { in.guard_closed = false; }},
    {"hydraulics", Abort::hydraulics_lost, [](Inputs& in) { in.hydraulics_ready = false; }},
    {"drive", Abort::drive_fault, [](Inputs& in) { in.drive_healthy = false; }},
    {"stale registers", Abort::plc_silent, [](Inputs& in) { in.plc_fresh = false; }},
    {"speed is no number", Abort::plc_silent, [](Inputs& in) { in.flywheel_mps = kNan; }},
    {"sledge is no number", Abort::plc_silent, [](Inputs& in) { in.sledge_m = kNan; }},
    {"load is no number", Abort::plc_silent, [](Inputs& in) { in.load_N = kNan; }},
    {"load is infinite", Abort::plc_silent, [](Inputs& in) { in.load_N = INFINITY; }},
    {"temperature is no number", Abort::plc_silent, [](Inputs& in) { in.brake_temperature_C = kNan; }},
    {"tripped", Abort::plc_tripped, [](Inputs& in) { in.plc_ready = false; }},
    {"rejected", Abort::command_rejected, [](Inputs& in) { in.commit_rejected = true; }},
    {"not confirmed", Abort::command_rejected, [](Inputs& in) { in.commit_late = true; }},
    {"somebody else's command", Abort::foreign_command, [](Inputs& in) { in.foreign_command = true; }},
    {"too fast", Abort::overspeed, [](Inputs& in) { in.flywheel_mps = in.rim_mps = 52.3; }},
    {"two senders", Abort::two_senders, [](Inputs& in) { in.two_senders = true; }},
    {"two senders, none of them good", Abort::two_senders,
     [](Inputs& in) {
         in.two_senders = true;
         in.controller_fresh = in.sensors_fresh = false;
     }},
    {"stale status", Abort::controller_silent, [](Inputs& in) { in.controller_fresh = false; }},
    {"safe state", Abort::controller_fault,
     [](Inputs& in) {
         in.controller_safe = true;
         in.controller_armed = in.controller_standby = false;
     }},
    {"bus", Abort::bus_lost, [](Inputs& in) { in.bus_up = in.sensors_fresh = in.controller_fresh = false; }},
    {"bus not read", Abort::bus_unread, [](Inputs& in) { in.bus_read = in.sensors_fresh = in.controller_fresh = false; }},
    {"stale sensors", Abort::sensors_lost, [](Inputs& in) { in.sensors_fresh = false; }},
    {"rim is no number", Abort::sensors_lost, [](Inputs& in) { in.rim_mps = kNan; }},
    {"wheel's encoder is no number", Abort::sensors_lost, [](Inputs& in) { in.wheel_radps = kNan; }},
    {"wheel is no number", Abort::sensors_lost, [](Inputs& in) { in.wheel_rim_mps = kNan; }},
    {"pressure is no number", Abort::sensors_lost, [](Inputs& in) { in.pressure_Pa = kNan; }},
};

/// From aborting to the end on a rig that obeys.
void check_end(Reached& r, Abort cause) {
    const Outputs end = run(r.sequencer, r.rig, r.now_s, [&](const Outputs& out) {
        REQUIRE(safe(out));
        return r.sequencer.over();
    });
    CHECK(end.phase == Phase::aborted);
    CHECK(end.abort == cause);
    CHECK_FALSE(end.emergency_stop);
    CHECK(r.rig.inputs.sledge_m <= 0.01);
    CHECK(r.rig.inputs.pressure_Pa == 0.0);
    CHECK(r.sequencer.safe_end_seen());
}

}  // namespace

TEST_CASE("what a second controller did to the first is named after it, once it is told from it", "[BRG-460]") {
    for (const Mishap& mishap : kMishaps) {
        CAPTURE(mishap.what);
        Reached r(Phase::braking);
        Inputs in = r.rig.inputs;
        mishap.strike(in);
        REQUIRE(r.next(in).abort == mishap.cause);
        in.two_senders = true;
        const bool its = mishap.cause == Abort::controller_silent || mishap.cause == Abort::controller_fault;
        const Outputs out = r.next(in);
        CHECK(out.abort == (its ? Abort::two_senders : mishap.cause));
        CHECK((!its || out.emergency_stop));
        in.two_senders = false;
        CHECK(r.next(in).abort == out.abort);
    }
}

TEST_CASE("a second sender that is told only after the safe end is still the cause", "[BRG-460]") {
    Reached r(Phase::spin_up);
    Inputs in = r.rig.inputs;
    in.controller_safe = true;
    in.controller_armed = in.controller_standby = false;
    REQUIRE(r.next(in).abort == Abort::controller_fault);
    check_end(r, Abort::controller_fault);
    in = r.rig.inputs;
    in.two_senders = true;
    const Outputs out = r.next(in);
    CHECK(out.abort == Abort::two_senders);
    CHECK(out.phase == Phase::aborted);
    CHECK(safe(out));
}

TEST_CASE("every cause in every phase: safe in the same step, and a safe end", "[BRG-110]") {
    for (const Phase phase : kActive) {
        for (const Mishap& mishap : kMishaps) {
            INFO(rig::name(phase) << ", " << mishap.what);
            Reached r(phase);
            Inputs in = r.rig.inputs;
            mishap.strike(in);
            const Outputs out = r.next(in);
            CHECK(out.phase == Phase::aborting);
            CHECK(out.abort == mishap.cause);
            CHECK(safe(out));
            CHECK(out.emergency_stop == rig::stops_controller(mishap.cause));
            check_end(r, mishap.cause);
        }
    }
}

TEST_CASE("in idle a cause keeps the maneuver from starting, and is named when idle's limit passes", "[BRG-110]") {
    for (const Mishap& mishap : kMishaps) {
        INFO(mishap.what);
        Sequencer s(landing());
        RigModel rig;
        mishap.strike(rig.inputs);
        double now = 0.0;
        Outputs out;
        for (; now < 29.9; now += kStep_s) {
            out = s.step(rig.inputs, now);
            REQUIRE(safe(out));
            REQUIRE_FALSE(out.emergency_stop);
            if (mishap.cause == Abort::requested) break;
            REQUIRE(out.phase == Phase::idle);
        }
        while (out.phase == Phase::idle) out = s.step(rig.inputs, now += kStep_s);
        CHECK(out.phase == Phase::aborting);
        CHECK(out.abort == mishap.cause);
        CHECK(now < 30.1);
    }
    SECTION("and when it goes, the maneuver starts") {
        Sequencer s(landing());
        Inputs in = healthy();
        in.guard_closed = false;
        CHECK(s.step(in, 0.0).phase == Phase::idle);
        CHECK(s.step(healthy(), 1.0).phase == Phase::spin_up);
    }
    SECTION("a hot brake waits, too") {
        Sequencer s(landing());
        Inputs in = healthy();
        in.brake_temperature_C = 301.0;
        CHECK(s.step(in, 0.0).phase == Phase::idle);
        const Outputs out = s.step(in, 31.0);
        CHECK(out.abort == Abort::brake_hot);
    }
}

TEST_CASE("before brake-on a brake above its limit ends the maneuver, after it not", "[BRG-110]") {
    for (const Phase phase : kActive) {
        INFO(rig::name(phase));
        Reached r(phase);
        Inputs in = r.rig.inputs;
        in.brake_temperature_C = 300.1;
        const Outputs out = r.next(in);
        if (phase == Phase::spin_up || phase == Phase::touchdown || phase == Phase::settling) {
            CHECK(out.abort == Abort::brake_hot);
            CHECK(safe(out));
            CHECK_FALSE(out.emergency_stop);
        } else {
            CHECK(out.abort == Abort::none);
        }
    }
}

TEST_CASE("while braking the load stays in its band and the wheel on the rim", "[BRG-110]") {
    const auto mishap = GENERATE(0, 1, 2);
    Reached r(Phase::braking);
    Inputs in = r.rig.inputs;
    const double law_N = 30e3 - 3.0 * in.flywheel_mps * in.flywheel_mps;
    in.load_N = law_N * 1.49;
    CHECK(r.next(in).phase == Phase::braking);
    if (mishap == 0) in.load_N = law_N * 0.49;
    if (mishap == 1) in.load_N = law_N * 1.51;
    if (mishap == 2) {
        in.load_N = law_N;
        in.wheel_on_rim = false;
    }
    const Outputs out = r.next(in);
    CHECK(out.abort == Abort::load_lost);
    CHECK(safe(out));
    CHECK(out.emergency_stop);
    check_end(r, Abort::load_lost);
}

TEST_CASE("a controller that has lost its permission ends the maneuver", "[BRG-110]") {
    for (const Phase phase : {Phase::touchdown, Phase::settling, Phase::braking, Phase::standstill}) {
        INFO(rig::name(phase));
        Reached r(phase);
        Inputs in = r.rig.inputs;
        in.controller_armed = false;  // e.g. restarted: in self-test, neither standby nor safe
        in.controller_standby = false;
        const Outputs out = r.next(in);
        CHECK(out.abort == Abort::controller_fault);
        CHECK(safe(out));
    }
}

TEST_CASE("the drive does not pull while the sledge is out", "[BRG-100]") {
    Reached r(Phase::spin_up);
    Inputs in = r.rig.inputs;
    SECTION("sledge") {
        in.sledge_m = 0.05;
    }
    SECTION("wheel") {
        in.wheel_on_rim = true;
    }
    const Outputs out = r.next(in);
    CHECK(out.abort == Abort::command_rejected);
    CHECK(safe(out));
}

TEST_CASE("of several causes the one nearest to the root is named, and the first stays", "[BRG-110]") {
    Reached r(Phase::braking);
    Inputs in = r.rig.inputs;
    for (const Mishap& mishap : kMishaps) {
        if (std::string(mishap.what) != "stale registers" && mishap.cause != Abort::plc_silent) mishap.strike(in);
    }
    CHECK(r.next(in).abort == Abort::emergency_stop);
    in.plc_fresh = false;
    CHECK(r.next(in).abort == Abort::emergency_stop);
}

TEST_CASE("worse news on the way to the safe end stops the controller, too", "[BRG-110]") {
    Reached r(Phase::braking);
    Inputs in = r.rig.inputs;
    in.abort_requested = true;
    CHECK_FALSE(r.next(in).emergency_stop);
    in.guard_closed = false;
    const Outputs out = r.next(in);
    CHECK(out.emergency_stop);
    CHECK(out.abort == Abort::requested);
}

TEST_CASE("a rig that does not reach its safe end is given up after the limit, and said so", "[BRG-110]") {
    const auto mishap = GENERATE(0, 1, 2, 3);
    Reached r(Phase::braking);
    Inputs in = r.rig.inputs;
    in.abort_requested = true;
    in.sledge_m = 0.0;
    in.wheel_on_rim = false;
    in.pressure_Pa = 0.0;
    if (mishap == 0) in.sledge_m = 0.25;
    if (mishap == 1) in.pressure_Pa = 5e6;
    if (mishap == 2) in.plc_fresh = false;
    if (mishap == 3) in.sensors_fresh = false;
    const double from = r.now_s;
    Outputs out;
    while (!r.sequencer.over() && r.now_s < from + 700.0) {
        out = r.sequencer.step(in, r.now_s += 0.1);
        REQUIRE(safe(out));
    }
    CHECK(out.phase == Phase::aborted);
    CHECK(r.now_s - from == Approx(600.0).margin(1.0));
    CHECK_FALSE(r.sequencer.safe_end_seen());
}

TEST_CASE("a clock that stands, falls or is no number breaks nothing", "[BRG-110]") {
    Reached r(Phase::braking);
    const Inputs in = r.rig.inputs;
    for (const double t : {double{r.now_s}, r.now_s - 1e6, kNan, -std::numeric_limits<double>::infinity()}) {
        const Outputs out = r.sequencer.step(in, t);
        CHECK(out.phase == Phase::braking);
        CHECK(std::isfinite(out.current_mA));
    }
    Inputs stop = in;
    stop.abort_requested = true;
    CHECK(safe(r.sequencer.step(stop, kNan)));
}

namespace {

/// Inputs that are good for most of the time and any nonsense for the rest.
Inputs disturbed(Inputs in, rig::Random& random, unsigned one_in) {
    const auto hit = [&] { return random.bits() % one_in == 0; };
    const auto number = [&](double& value) {
        if (!hit()) return;
        constexpr double kInfinite = std::numeric_limits<double>::infinity();
        const double nonsense[] = {kNan, kInfinite, -kInfinite, 0.0, -1.0, 1e9, 1e-320, 50.0};
        value = nonsense[random.bits() % 8];
    };
    for (bool* flag :
         {&in.plc_fresh, &in.plc_ready, &in.commit_rejected, &in.commit_late, &in.foreign_command, &in.two_senders, &in.emergency_stop_clear,
          &in.guard_closed, &in.hydraulics_ready, &in.drive_healthy, &in.wheel_on_rim, &in.bus_up, &in.bus_read, &in.sensors_fresh,
          &in.controller_fresh, &in.controller_standby, &in.controller_armed, &in.controller_safe, &in.abort_requested}) {
        if (hit()) *flag = !*flag;
    }
    for (double* value :
         {&in.flywheel_mps, &in.sledge_m, &in.load_N, &in.brake_temperature_C, &in.rim_mps, &in.wheel_radps, &in.wheel_rim_mps, &in.pressure_Pa})
        number(*value);
    return in;
}

bool danger(const Inputs& in) {
    return in.abort_requested || !in.plc_fresh || !in.plc_ready || in.commit_rejected || in.commit_late || !in.emergency_stop_clear ||
           !in.guard_closed || !in.hydraulics_ready || !in.drive_healthy || in.foreign_command || in.two_senders || in.flywheel_mps > 60.0 ||
           !in.bus_up || !in.bus_read || !in.sensors_fresh || !in.controller_fresh || in.controller_safe || !std::isfinite(in.rim_mps) ||
           !std::isfinite(in.wheel_radps) || !std::isfinite(in.flywheel_mps) || !std::isfinite(in.sledge_m) || !std::isfinite(in.load_N) ||
           !std::isfinite(in.brake_temperature_C) || !std::isfinite(in.wheel_rim_mps) || !std::isfinite(in.pressure_Pa);
}

/// What holds for any outputs.
void check_always(const Outputs& out, const Inputs& in, Phase before) {
    const bool drives = out.drive_enable, advances = out.sledge_advance, brakes = out.demand_Pa > 0.0;
    REQUIRE_FALSE((drives && (advances || out.load_enable || brakes || out.weight_on_wheels)));
    REQUIRE_FALSE((out.load_enable && !advances));
    REQUIRE_FALSE((brakes && !(out.arm && advances)));
    REQUIRE_FALSE((out.weight_on_wheels && !in.wheel_on_rim));
    REQUIRE_FALSE((out.current_mA > 0.0 && !brakes));
    REQUIRE((std::isfinite(out.demand_Pa) && std::isfinite(out.current_mA) && std::isfinite(out.load_base_N)));
    if (danger(in) || out.phase >= Phase::finished) REQUIRE(safe(out));
    if (brakes) REQUIRE((out.phase == Phase::braking || out.phase == Phase::standstill));
    // One phase forward, or to the abort; never back, never out of an end.
    const auto from = static_cast<int>(before), to = static_cast<int>(out.phase);
    const bool stays = to == from, goes_on = to == from + 1 && out.phase != Phase::aborting;
    const bool aborts = out.phase == Phase::aborting && before < Phase::finished;
    const bool ends = before == Phase::aborting && out.phase == Phase::aborted;
    REQUIRE((stays || goes_on || aborts || ends));
    REQUIRE((out.abort != Abort::none) == (out.phase >= Phase::aborting));
}

}  // namespace

TEST_CASE("random inputs on a rig that obeys: nothing unsafe, never", "[BRG-110]") {
    const unsigned one_in = GENERATE(20U, 2000U, 100'000U);
    rig::Random random(one_in);
    std::array<int, rig::kPhaseCount> left_for_abort{};
    int finished = 0;
    for (int maneuver = 0; maneuver < 60; ++maneuver) {
        Plan plan = landing();
        plan.abort_limit_s = 20.0;
        if (maneuver % 2 == 1) {
            plan.law = rig::BrakeLaw::open_loop;
            plan.current = {{0.0, 5.0}, {1.0, 20.0}};
        }
        Sequencer s(plan);
        RigModel rig;
        double now = 0.0;
        Phase before = Phase::idle;
        for (int i = 0; i < 20'000 && !s.over(); ++i) {
            const Inputs in = disturbed(rig.inputs, random, one_in);
            const Outputs out = s.step(in, now);
            check_always(out, in, before);
            if (out.phase == Phase::aborting && before != Phase::aborting) ++left_for_abort[static_cast<std::size_t>(before)];
            before = out.phase;
            rig.advance(out, kStep_s);
            now += kStep_s * static_cast<double>(1U + random.bits() % 10U);  // 10 to 100 ms apart
        }
        CHECK(s.over());
        finished += s.phase() == Phase::finished ? 1 : 0;
    }
    // The disturbances are such that all of it is seen.
    if (one_in == 2000U) CHECK(left_for_abort[static_cast<std::size_t>(Phase::spin_up)] > 0);
    if (one_in == 100'000U) CHECK(finished > 0);
}

TEST_CASE("inputs that are nothing but noise: nothing unsafe, never", "[BRG-110]") {
    rig::Random random(7);
    for (int run_number = 0; run_number < 300; ++run_number) {
        const Phase start = kActive[static_cast<std::size_t>(run_number) % std::size(kActive)];
        Reached r(start);
        Phase before = start;
        for (int i = 0; i < 50; ++i) {
            const Inputs in = disturbed(r.rig.inputs, random, 2);
            const Outputs out = r.next(in);
            check_always(out, in, before);
            before = out.phase;
        }
        CHECK(before >= Phase::aborting);
    }
}
