/// The drive is watched: by its own reading, and by the encoder on the bus.
#include "tests/catch.hpp"
#include "tests/rig/rig_model.hpp"

using namespace sequencer_test;
using rig::Abort;

TEST_CASE("a rim that is faster than any spin-up can ask for ends the maneuver", "[BRG-110]") {
    const Plan plan = landing();
    const double top_mps = 50.0 + 0.003 * 50.0 + 0.05 + plan.speed_band_mps;
    CHECK(rig::top_speed_mps(plan) == Approx(top_mps).epsilon(1e-12));
    for (const Phase phase : kActive) {
        INFO(rig::name(phase));
        Reached r(phase);
        Inputs in = r.rig.inputs;
        in.flywheel_mps = in.rim_mps = top_mps - 0.01;
        in.load_N = 30e3 - 3.0 * in.flywheel_mps * in.flywheel_mps;
        CHECK(r.next(in).phase != Phase::aborting);
        in.flywheel_mps = in.rim_mps = top_mps + 0.01;
        const Outputs out = r.next(in);
        CHECK(out.abort == Abort::overspeed);
        CHECK(safe(out));
        CHECK(out.emergency_stop);
    }
}

TEST_CASE("PLC and encoder may differ in the rim's speed for a moment, not for longer", "[BRG-110]") {
    const double sign = GENERATE(-1.0, 1.0);
    for (const Phase phase : {Phase::spin_up, Phase::settling, Phase::braking, Phase::cool_down}) {
        INFO(rig::name(phase) << ", " << sign);
        Reached r(phase);
        Inputs in = r.rig.inputs;
        if (phase == Phase::cool_down && sign < 0.0) in.flywheel_mps = 3.0;
        in.rim_mps = in.flywheel_mps + sign * 2.01;
        const auto next = [&](const Inputs& now) {
            Inputs one = now;
            one.controller_standby = one.controller_armed = false;  // keeps spin_up where it is
            return r.next(phase == Phase::spin_up ? one : now);
        };
        in.brake_temperature_C = 200.0;  // keeps cool_down
        for (int i = 0; i < 45; ++i) REQUIRE(next(in).phase == phase);
        Inputs agree = in;
        agree.rim_mps = in.flywheel_mps + sign * 1.99;
        CHECK(next(agree).phase == phase);
        int steps = 0;
        Outputs out;
        do {
            out = next(in);
        } while (out.phase == phase && ++steps < 100);
        CHECK(out.abort == Abort::speed_mismatch);
        CHECK(safe(out));
        CHECK(steps >= 49);
        CHECK(steps <= 52);
    }
}

TEST_CASE("sensors that are lost are no other speed, however much longer than mismatch_s they are waited for", "[BRG-400]") {
    const Phase phase = GENERATE(Phase::spin_up, Phase::settling, Phase::braking);
    CAPTURE(rig::name(phase));
    Reached r(phase);
    Inputs in = r.rig.inputs;
    if (phase == Phase::spin_up) in.controller_standby = in.controller_armed = false;  // keeps it there
    Outputs out;
    for (int i = 0; i < 300; ++i) {  // as the bridge reckons a rim of which nobody tells: slower and slower
        in.rim_age_s += kStep_s;
        in.rim_mps = i < 3 ? in.rim_mps : std::min(in.rim_mps, 0.1 / (kStep_s * (i - 2)));
        out = r.next(in);
        REQUIRE(out.abort == Abort::none);
    }
    in.sensors_fresh = false;
    CHECK(r.next(in).abort == Abort::sensors_lost);
}

TEST_CASE("speeds that differ are named though the encoder falls silent now and then", "[BRG-400]") {
    Reached r(Phase::braking);
    Inputs in = r.rig.inputs;
    in.rim_mps = in.flywheel_mps - 2.01;
    int received = 0;
    for (int i = 0; received < 60; ++i) {
        in.rim_age_s = i % 2 == 0 ? 0.04 : 0.001;
        received += i % 2;
        if (r.next(in).abort != Abort::none) break;
    }
    CHECK(r.sequencer.abort() == Abort::speed_mismatch);
    CHECK(received >= 50);
    CHECK(received <= 52);
}

TEST_CASE("an old reading of the PLC is no other speed: it may be off by what a tyre can have done since", "[BRG-110]") {
    const double off_mps = GENERATE(5.59, 5.61);
    Reached r(Phase::braking);
    Inputs in = r.rig.inputs;
    in.flywheel_age_s = 0.3;  // at 12 m/s2, and 2 m/s of the band
    in.rim_mps = in.flywheel_mps - off_mps;
    Outputs out;
    for (int i = 0; i < 100; ++i) out = r.next(in);
    CHECK(out.abort == (off_mps < 5.6 ? Abort::none : Abort::speed_mismatch));
}

TEST_CASE("An encoder whose pick-up needs a rate of edges shows a slow rim as none, which is no other speed", "[BRG-110]") {
    constexpr double kBlind_mps = 3.9;  // 10 edges a second, 24 teeth, a drum of 1.5 m
    const auto outcome = [](double flywheel_mps, double blind_mps) {
        rig::Plan plan = sequencer_test::landing();
        plan.encoder_blind_mps = blind_mps;
        Reached r(Phase::spin_up, plan);
        Inputs in = r.rig.inputs;
        in.controller_standby = in.controller_armed = false;  // keeps it there
        in.flywheel_mps = flywheel_mps;
        in.rim_mps = 0.0;
        Outputs out;
        for (int i = 0; i < 100; ++i) out = r.next(in);
        return out.abort;
    };
    CHECK(outcome(3.8, kBlind_mps) == Abort::none);
    CHECK(outcome(3.8, 0.0) == Abort::speed_mismatch);
    CHECK(outcome(6.0, kBlind_mps) == Abort::speed_mismatch);  // a dead encoder
}
