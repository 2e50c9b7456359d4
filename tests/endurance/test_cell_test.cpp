/// Every shipped scenario through sequencer, controller, PLC and plant in one process.
#include <algorithm>

#include "plant_sim/endurance/test_cell.hpp"
#include "rig_bridge/rig/acceptance.hpp"
#include "tests/catch.hpp"
#include "tests/endurance/truth.hpp"
#include "tests/settings/refusal.hpp"

using endurance::Outcome;
using endurance_test::cell;
using endurance_test::setup;
using rig::Abort;
using rig::Phase;

TEST_CASE("every shipped scenario runs to its end, twice on the same rig", "[STUDY-070]") {
    const std::string name = GENERATE("light", "medium_a", "medium_b", "heavy", "rejected_takeoff", "open_loop", "endurance", "ramp", "step", "sweep",
                                      "slow_braking", "below_peak");
    CAPTURE(name);
    const endurance::EnduranceSetup s = setup(name);
    auto rig = cell(s);
    for (int number = 1; number <= 2; ++number) {
        const auto plan = rig::plan(s.scenario, 1, number);
        const Outcome out = rig.run(plan);
        CHECK(out.phase == Phase::finished);
        CHECK(out.faults.empty());
        CHECK(out.figures.standstill);
        // The speed at brake-on is the prescribed one.
        CHECK(out.figures.brake_on_mps == Approx(plan.speed_mps).margin(endurance_test::held_to_mps(s, plan)));
        // Eq. (8) and (9): what the flywheel and the wheel had is what brake and tyre took, as measured. The way of one edge is
        // uncertain at both ends, which shows from 6 m/s on: 0.05 m times 27 kN of load, half of it used.
        CHECK(out.figures.energy_brake_J + out.figures.energy_tyre_J == Approx(out.figures.kinetic_energy_J).epsilon(0.01).margin(700.0));
    }
    CHECK(rig.rig().maneuvers() == 2);
}

TEST_CASE("what the rig does with a shipped scenario is within its bands; another load or deceleration is not", "[STUDY-070]") {
    const std::string name = GENERATE("light", "medium_a", "medium_b", "heavy", "rejected_takeoff", "open_loop", "endurance", "ramp", "step", "sweep",
                                      "slow_braking", "below_peak");
    CAPTURE(name);
    const endurance::EnduranceSetup s = setup(name);
    auto rig = cell(s);
    const rig::Plan plan = rig::plan(s.scenario, 1, 1);
    const std::vector<rig::Band> bands = rig::acceptance(s.scenario, plan);
    const Outcome good = rig.run(plan);
    CHECK(rig::what_is_outside(bands, good.figures).empty());
    rig::Plan light = plan;
    light.load_base_N *= 0.9;
    const Outcome off = rig.run(light);
    CHECK(off.phase == Phase::finished);
    CHECK_THAT(rig::what_is_outside(bands, off.figures), ContainsSubstring("mean load"));
}

TEST_CASE("a stop that is as long as the brake is weak finishes, and is out of tolerance", "[STUDY-070]") {
    const endurance::EnduranceSetup s = setup("endurance");
    auto rig = cell(s);
    const rig::Plan plan = rig::plan(s.scenario, 1, 1);
    rig::Plan weak = plan;
    weak.demand_Pa = 6.5e6;  // of the 9.4 MPa that the deceleration takes
    const Outcome out = rig.run(weak);
    CHECK(out.phase == Phase::finished);
    CHECK(out.faults.empty());
    CHECK(out.figures.length_m > 600.0);
    CHECK(rig::out_of_tolerance(rig::acceptance(s.scenario, plan), out.figures) == std::vector<std::string>{"duration_s", "length_m"});
}

TEST_CASE("the slip landing uses the friction of the road", "[STUDY-070]") {
    const endurance::EnduranceSetup s = setup("heavy");
    auto rig = cell(s);
    const Outcome out = rig.run(rig::plan(s.scenario, 1, 1));
    CHECK(out.figures.j_mu > 0.93);
    CHECK(out.figures.j_mu <= 1.0);
}

TEST_CASE("the meter's figures are the plant's", "[STUDY-070]") {
    const endurance::EnduranceSetup s = setup("endurance");
    auto rig = cell(s);
    const double energy_before = rig.rig().cumulative_energy_J();
    const Outcome out = rig.run(rig::plan(s.scenario, 1, 1));
    CHECK(out.figures.energy_brake_J == Approx(rig.rig().cumulative_energy_J() - energy_before).epsilon(0.002));
    // From brake-on to rest the mean torque and load are in the energy and the law.
    CHECK(out.figures.mean_load_N == Approx(rig::plan(s.scenario, 1, 1).load_base_N).epsilon(1e-3));
    CHECK(out.figures.mean_torque_Nm * out.figures.duration_s == Approx(194.42 * out.figures.brake_on_mps).epsilon(0.005));
}

TEST_CASE("an interlock that opens while the sequencer runs ends the maneuver, and the rig runs the next", "[STUDY-070]") {
    const unsigned bit = GENERATE(0U, 1U, 2U, 3U);
    constexpr Abort kCauses[] = {Abort::emergency_stop, Abort::guard_open, Abort::hydraulics_lost, Abort::drive_fault};
    const endurance::EnduranceSetup s = setup("light");
    auto rig = cell(s);
    rig.rig().open_interlocks(1U << bit);
    const Outcome out = rig.run(rig::plan(s.scenario, 1, 1));
    CHECK(out.phase == Phase::aborted);
    CHECK(out.abort == kCauses[bit]);
    CHECK(rig.rig().maneuvers() == 0);
    CHECK(rig.rig().rig().wheel().v_mps == 0.0);
}

TEST_CASE("the valve's experiments run at standstill", "[BRG-100]") {
    const std::string name = GENERATE("ramp", "step", "sweep");
    CAPTURE(name);
    const endurance::EnduranceSetup s = setup(name);
    auto rig = cell(s);
    double still_s = 0.0;
    double min_mA = 100.0;
    double max_mA = 0.0;
    const Outcome out = rig.run(rig::plan(s.scenario, 1, 1), [&](const endurance::Period& p) {
        if (p.sample.maneuver_state.phase != static_cast<std::uint8_t>(Phase::standstill)) return;
        still_s += 1e-3;
        CHECK(rig.rig().rig().wheel().v_mps < 0.1);
        min_mA = std::min(min_mA, p.current_mA);
        max_mA = std::max(max_mA, p.current_mA);
    });
    CHECK(out.phase == Phase::finished);
    CHECK(out.faults.empty());
    CHECK(still_s > 20.0);
    CHECK(max_mA == Approx(name == "ramp" ? 40.0 : name == "step" ? 36.0 : 22.0).margin(0.1));
    CHECK(min_mA <= 8.0);
}

TEST_CASE("The summary of a maneuver in process tells its faults, warnings and what is out of tolerance", "[STUDY-070]") {
    Outcome out;
    out.phase = Phase::finished;
    out.figures.length_m = 200.0;
    out.faults.insert(antiskid::control::Fault::flywheel_stuck);
    out.warnings = {"energy_unbalanced: by 12 %"};
    const rig::record::FigureField* length = nullptr;
    for (const rig::record::FigureField& field : rig::record::kFigureFields)
        if (std::string_view(field.key) == "length_m") length = &field;
    REQUIRE(length != nullptr);
    const rig::record::Summary s = endurance::summary_of({}, out, {{.figure = length, .min = 100.0, .max = 110.0}});
    CHECK(s.outcome == "finished");
    CHECK(s.faults == std::vector<std::string>{"flywheel_stuck"});
    CHECK(s.warnings == out.warnings);
    REQUIRE(s.out_of_tolerance);
    CHECK(s.out_of_tolerance->size() == 1);
    out.phase = Phase::aborted;
    out.abort = Abort::controller_fault;
    CHECK(endurance::summary_of({}, out, {}).outcome == "controller_fault");
}

TEST_CASE("A rig whose files disagree, or that its layout cannot carry, is refused before it runs", "[STUDY-070]") {
    const auto rejected = [](const char* file, const std::string& from, const std::string& to) {
        const TemporaryDirectory directory;
        const auto config = directory / "config";
        std::filesystem::copy("config", config, std::filesystem::copy_options::recursive);
        put(config / file, replaced(content_of(config / file), from, to));
        return std::string(rejection_of([&] { return endurance::load_setup(config / "scenarios/heavy.toml", config); }).what());
    };
    CHECK_THAT(rejected("controller.toml", "teeth = 60", "teeth = 48"), ContainsSubstring("wheel.encoder.teeth: is 48; expected 60"));
    CHECK_THAT(rejected("rig_machinery.toml", "force_max_N = 60.0e3", "force_max_N = 100.0e3"),
               ContainsSubstring("load_cells.vertical.signal") && ContainsSubstring("it must reach 100000 N"));
    CHECK_THAT(rejected("antiskid.dbc", "SG_ Pressure : 16|16@1+ (500,0) [0|32767500]", "SG_ Pressure : 16|16@1+ (500,0) [0|10000000]"),
               ContainsSubstring("pressure.signal") && ContainsSubstring("too narrow for this rig"));
}
