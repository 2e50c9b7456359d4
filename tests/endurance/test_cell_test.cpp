/// Every shipped scenario through sequencer, controller, PLC and plant in one process.
#include <cmath>

#include "tests/catch.hpp"
#include "tests/endurance/truth.hpp"

using endurance::Outcome;
using endurance_test::cell;
using endurance_test::setup;
using sequencer::Abort;
using sequencer::Phase;

TEST_CASE("every shipped scenario runs to its end, twice on the same rig", "[STUDY-070]") {
    const std::string name =
        GENERATE("light", "medium_a", "medium_b", "heavy", "rejected_takeoff", "open_loop", "endurance");
    CAPTURE(name);
    const endurance::Setup s = setup(name);
    auto rig = cell(s);
    for (int number = 1; number <= 2; ++number) {
        const auto plan = rig::plan(s.scenario, 1, number);
        const Outcome out = rig.run(plan);
        CHECK(out.phase == Phase::finished);
        CHECK(out.faults.empty());
        CHECK(out.figures.standstill);
        // The speed at brake-on is the prescribed one.
        CHECK(out.figures.brake_on_mps == Approx(plan.speed_mps).margin(0.05));
        // Eq. (8) and (9): what the flywheel and the wheel had is what brake and tyre took, as measured.
        CHECK(out.figures.energy_brake_J + out.figures.energy_tyre_J ==
              Approx(out.figures.kinetic_energy_J).epsilon(0.01));
    }
    CHECK(rig.rig().maneuvers() == 2);
}

TEST_CASE("the slip landing uses the friction of the road", "[STUDY-070]") {
    const endurance::Setup s = setup("heavy");
    auto rig = cell(s);
    const Outcome out = rig.run(rig::plan(s.scenario, 1, 1));
    CHECK(out.figures.j_mu > 0.93);
    CHECK(out.figures.j_mu <= 1.0);
}

TEST_CASE("the meter's figures are the plant's", "[STUDY-071]") {
    const endurance::Setup s = setup("endurance");
    auto rig = cell(s);
    const double energy_before = rig.rig().cumulative_energy_J();
    const Outcome out = rig.run(rig::plan(s.scenario, 1, 1));
    CHECK(out.figures.energy_brake_J ==
          Approx(rig.rig().cumulative_energy_J() - energy_before).epsilon(0.002));
    // From brake-on to rest the mean torque and load are in the energy and the law.
    CHECK(out.figures.mean_load_N == Approx(rig::plan(s.scenario, 1, 1).load_base_N).epsilon(1e-3));
    CHECK(out.figures.mean_torque_Nm * out.figures.duration_s ==
          Approx(194.42 * out.figures.brake_on_mps).epsilon(0.005));
}

TEST_CASE("an interlock that opens while the sequencer runs ends the maneuver, and the rig runs the next",
          "[STUDY-072]") {
    const unsigned bit = GENERATE(0U, 1U, 2U, 3U);
    constexpr Abort kCauses[] = {Abort::emergency_stop, Abort::guard_open, Abort::hydraulics_lost,
                                 Abort::drive_fault};
    const endurance::Setup s = setup("light");
    auto rig = cell(s);
    rig.rig().open_interlocks(1U << bit);
    const Outcome out = rig.run(rig::plan(s.scenario, 1, 1));
    CHECK(out.phase == Phase::aborted);
    CHECK(out.abort == kCauses[bit]);
    CHECK(rig.rig().maneuvers() == 0);
    CHECK(rig.rig().rig().wheel().v_mps == 0.0);
}
