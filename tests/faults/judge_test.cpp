/// The criteria of the fault campaign, each by a made-up run that just meets and just misses it.
#include "tests/catch.hpp"

#include "plant_sim/study/faults/judge.hpp"

namespace {

using Named = antiskid::control::Fault;
using antiskid::control::State;
using faults::Hazard;
using faults::Outcome;

constexpr double kStep_s = 1e-3;
constexpr double kSound_m = 100.0;

faults::Observation braking(double distance_m) {
    return {.period_s = kStep_s,
            .distance_m = distance_m,
            .v_mps = 30.0,
            .slip = 0.2,
            .pressure_Pa = 5e6,
            .asked_Pa = 20e6,
            .driver_mA = 12.0,
            .state = State::braking,
            .named = {}};
}

faults::Observation safe(double distance_m) {
    faults::Observation o = braking(distance_m);
    o.state = State::safe;
    o.driver_mA = 0.0;
    o.named.insert(Named::wheel_lost);
    return o;
}

faults::Judge judge(bool changed_wish = false, bool emergency_stop = false) {
    return {{}, {.sound_distance_m = kSound_m, .safe_mA = 0.0, .changed_wish = changed_wish, .emergency_stop = emergency_stop}};
}

/// `count` periods of one kind, then the end.
faults::Judgement after(faults::Judge j, const faults::Observation& seen, int count, bool stood = true) {
    for (int i = 0; i < count; ++i) j.observe(seen);
    return j.verdict(stood);
}

faults::Judgement stopped_after(double distance_m, State state = State::braking, bool stood = true) {
    faults::Judge j = judge();
    j.observe(braking(0.0));
    faults::Observation end = braking(distance_m);
    end.state = state;
    j.observe(end);
    return j.verdict(stood);
}

}  // namespace

TEST_CASE("fault campaign: loss of braking without a name is judged by its distance", "[RIG-700]") {
    CHECK(stopped_after(100.0).outcome == Outcome::handled);
    CHECK(stopped_after(115.9).outcome == Outcome::handled);
    CHECK(stopped_after(116.1).hazard == Hazard::silent_loss);
    CHECK(stopped_after(116.1).outcome == Outcome::unsafe);
    CHECK(stopped_after(100.0, State::braking, false).hazard == Hazard::silent_loss);
    // The lock protection's state says that it works.
    CHECK(stopped_after(150.9, State::locked_wheel).outcome == Outcome::degraded);
    CHECK(stopped_after(151.1, State::locked_wheel).hazard == Hazard::silent_loss);
    CHECK(stopped_after(130.0).distance_share == Approx(1.3));
}

TEST_CASE("fault campaign: distance counts from where the fault began", "[RIG-700]") {
    faults::Judge j = judge();
    j.observe(braking(90.0));
    j.observe(braking(104.0));
    CHECK(j.verdict(true).hazard == Hazard::silent_loss);
    CHECK(j.verdict(true).distance_share == Approx(1.4));
}

TEST_CASE("fault campaign: a changed wish may be obeyed, but not by a locked wheel", "[RIG-700]") {
    faults::Judge obeyed = judge(true);
    obeyed.observe(braking(0.0));
    obeyed.observe(braking(500.0));
    CHECK(obeyed.verdict(false).outcome == Outcome::handled);
    faults::Observation locked = braking(0.0);
    locked.slip = 0.96;
    CHECK(after(judge(true), locked, 300).hazard == Hazard::locked_wheel);
}

TEST_CASE("fault campaign: a named fault with the valve safe is safe, and the time to its name is told", "[RIG-700]") {
    faults::Judge j = judge();
    j.observe(braking(0.0));
    j.observe(braking(0.0));
    j.observe(safe(0.0));
    const faults::Judgement v = j.verdict(false);
    CHECK(v.outcome == Outcome::safe);
    CHECK(v.named.contains(Named::wheel_lost));
    CHECK(v.named_after_s == Approx(3e-3));
}

TEST_CASE("fault campaign: permission that was never given is safe by the state that says so", "[RIG-700]") {
    faults::Observation rejected = braking(0.0);
    rejected.state = State::standby;
    rejected.driver_mA = 0.0;
    rejected.pressure_Pa = 0.0;
    CHECK(after(judge(), rejected, 1000, false).outcome == Outcome::safe);
    faults::Judge withdrawn = judge();
    withdrawn.observe(braking(0.0));
    CHECK(after(withdrawn, rejected, 1000, false).hazard == Hazard::silent_loss);
}

TEST_CASE("fault campaign: a driver that keeps its current under a safe controller is unsafe", "[RIG-700]") {
    faults::Observation late = safe(0.0);
    late.driver_mA = 1.0;
    CHECK(after(judge(), late, 21).outcome == Outcome::safe);
    CHECK(after(judge(), late, 22).hazard == Hazard::late_safe);
}

TEST_CASE("fault campaign: pressure that nobody asks for", "[RIG-700]") {
    faults::Observation o = braking(0.0);
    o.asked_Pa = 3.9e6;
    CHECK(after(judge(), o, 249).outcome == Outcome::handled);
    CHECK(after(judge(), o, 252).hazard == Hazard::unasked_pressure);
    CHECK(after(judge(), o, 252).max_uncommanded_Pa == Approx(1.1e6));
    o.asked_Pa = 4.1e6;
    CHECK(after(judge(), o, 1000).outcome == Outcome::handled);
    // Told to release, and why: what the hydraulics still do is not in the controller's hands.
    faults::Observation stuck = safe(0.0);
    stuck.asked_Pa = 0.0;
    CHECK(after(judge(), stuck, 1000).outcome == Outcome::safe);
}

TEST_CASE("fault campaign: a locked wheel counts under pressure and at speed", "[RIG-700]") {
    faults::Observation o = braking(0.0);
    o.slip = 0.96;
    CHECK(after(judge(), o, 249).outcome == Outcome::handled);
    CHECK(after(judge(), o, 252).hazard == Hazard::locked_wheel);
    faults::Observation released = o;
    released.pressure_Pa = 0.4e6;
    CHECK(after(judge(), released, 1000).longest_lock_s == 0.0);
    faults::Observation slow = o;
    slow.v_mps = 5.9;
    CHECK(after(judge(), slow, 1000).outcome == Outcome::handled);
}

TEST_CASE("fault campaign: an emergency stop is to be heard within half a second", "[RIG-700]") {
    CHECK(after(judge(false, true), braking(0.0), 499).hazard == Hazard::none);
    CHECK(after(judge(false, true), braking(0.0), 502).hazard == Hazard::stop_not_heard);
    faults::Observation reception = safe(0.0);
    reception.named.insert(Named::emergency_stop);
    CHECK(after(judge(false, true), reception, 1000).outcome == Outcome::safe);
    CHECK(after(judge(false, true), safe(0.0), 1000).hazard == Hazard::stop_not_heard);
}
