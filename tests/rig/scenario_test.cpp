/// Scenario files: the shipped ones, what is drawn, what is refused.
#include "rig_bridge/rig/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "firmware/host/controller_config.hpp"
#include "rig_bridge/rig/check_plan.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"
#include "rig_bridge/rig/same_rig.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"

using rig::Scenario;

namespace {

Scenario shipped(const std::string& name) {
    return rig::load_scenario("config/scenarios/" + name + ".toml");
}

/// The refusal of a shipped scenario with one change.
settings::Error rejected(const std::string& name, const std::string& from, const std::string& to) {
    const TemporaryDirectory directory;
    const auto file = directory / (name + ".toml");
    put(file, replaced(content_of("config/scenarios/" + name + ".toml"), from, to));
    return rejection_of([&] { return rig::load_scenario(file); });
}

}  // namespace

TEST_CASE("the shipped scenarios are those of Table II, Fig. 5, Table III and an open loop", "[BRG-120]") {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator("config/scenarios")) names.insert(entry.path().stem().string());
    CHECK(names == std::set<std::string>{"light", "medium_a", "medium_b", "heavy", "rejected_takeoff", "open_loop", "endurance", "ramp", "step",
                                         "sweep", "slow_braking", "below_peak"});
    struct Landing {
        const char* name;
        double mass_kg, speed_mps;
    };
    for (const Landing& l :
         {Landing{"light", 2800.0, 49.0}, Landing{"medium_a", 3150.0, 52.0}, Landing{"medium_b", 3300.0, 53.0}, Landing{"heavy", 4450.0, 61.0}}) {
        const Scenario s = shipped(l.name);
        CHECK(s.name == l.name);
        CHECK(s.mean.speed_mps == l.speed_mps);
        CHECK(s.mean.load_base_N == Approx(l.mass_kg * 9.80665));
        CHECK(s.mean.load_lift_Ns2pm2 == Approx(0.5 * 1.225 * 5.9));
        CHECK(s.mean.law == rig::BrakeLaw::slip);
        CHECK(s.mean.slip_reference == 0.24);
        CHECK(s.rig.rig.load.lag_s > 0.0);  // a loading device, not an aircraft
        CHECK_FALSE(s.endurance());
    }
    CHECK(shipped("rejected_takeoff").mean.speed_mps == Approx(60.0 / 3.6).epsilon(1e-4));
    CHECK(shipped("open_loop").mean.current.size() == 4);

    const Scenario e = shipped("endurance");
    CHECK(e.endurance());
    CHECK(e.mean.speed_mps == 54.86);
    CHECK(e.mean.load_base_N == 23532.78);
    CHECK(e.mean.load_lift_Ns2pm2 == 0.0);
    CHECK(e.mean.deceleration_mps2 == 3.2423);
    CHECK(e.scatter.speed_mps == 0.18);
    CHECK(e.scatter.load_N == 198.90);
    CHECK(e.controller.filename() == "controller_endurance.toml");
}

TEST_CASE("numbers shared by all come from sequencer.toml, a scenario's own stand above them", "[BRG-120]") {
    CHECK(shipped("heavy").mean.cool_to_C == 250.0);
    CHECK(shipped("endurance").mean.cool_to_C == 60.0);
    CHECK(shipped("heavy").mean.settle_s == 1.0);
    CHECK(shipped("rejected_takeoff").mean.settle_s == 3.3);
    CHECK(shipped("heavy").mean.abort_limit_s == 60.0);
}

TEST_CASE("the wheel's share in the momentum, and its radius, are the rig's", "[BRG-100]") {
    const Scenario s = shipped("endurance");
    // m = 228.10 / 0.6^2, J = 1.3, r = 0.30: Table III's rig.
    CHECK(s.mean.wheel_share == Approx(1.3 / (228.10 / 0.36 * 0.30 * 0.30)).epsilon(1e-4));
    CHECK(s.mean.rolling_radius_m == Approx(0.30).epsilon(1e-5));
    CHECK(s.mean.coasting_mps == 0.07);
    CHECK(shipped("ramp").mean.coasting_mps == 0.055);
    CHECK(s.rolling_radius_m(23532.78) == Approx(0.30).epsilon(1e-5));
}

TEST_CASE("a maneuver follows from seed and number alone", "[BRG-120]") {
    const Scenario s = shipped("endurance");
    const auto a = rig::plan(s, 5, 17);
    (void)rig::plan(s, 5, 18);
    const auto b = rig::plan(s, 5, 17);
    CHECK(a.speed_mps == b.speed_mps);
    CHECK(a.load_base_N == b.load_base_N);
    CHECK(a.deceleration_mps2 == b.deceleration_mps2);
    CHECK(rig::plan(s, 5, 18).speed_mps != a.speed_mps);
    CHECK(rig::plan(s, 6, 17).speed_mps != a.speed_mps);
    CHECK(rig::plan(s, 5, 17).rolling_radius_m != s.mean.rolling_radius_m);  // of its own load

    const Scenario landing = shipped("heavy");
    CHECK(rig::plan(landing, 1, 1).speed_mps == landing.mean.speed_mps);
    CHECK(rig::plan(landing, 1, 1).wheel_share == landing.mean.wheel_share);
}

TEST_CASE("what is drawn has the mean and deviation asked for, each for itself", "[BRG-120]") {
    const Scenario s = shipped("endurance");
    constexpr int kMany = 20'000;
    double sum[3] = {}, squares[3] = {}, speed_load = 0.0, speed_before = 0.0, serial = 0.0;
    for (int i = 1; i <= kMany; ++i) {
        const auto p = rig::plan(s, 3, i);
        const double x[3] = {(p.speed_mps - s.mean.speed_mps) / s.scatter.speed_mps, (p.load_base_N - s.mean.load_base_N) / s.scatter.load_N,
                             (p.deceleration_mps2 - s.mean.deceleration_mps2) / s.scatter.deceleration_mps2};
        for (int k = 0; k < 3; ++k) {
            sum[k] += x[k];
            squares[k] += x[k] * x[k];
        }
        speed_load += x[0] * x[1];
        serial += x[0] * speed_before;
        speed_before = x[0];
    }
    const double tolerance = 4.0 / std::sqrt(double{kMany});
    for (int k = 0; k < 3; ++k) {
        CHECK(std::abs(sum[k] / kMany) < tolerance);
        CHECK(std::sqrt(squares[k] / kMany) == Approx(1.0).epsilon(tolerance));
    }
    CHECK(std::abs(speed_load / kMany) < tolerance);
    CHECK(std::abs(serial / kMany) < tolerance);
}

TEST_CASE("the files for the hash are those that were read", "[BRG-120]") {
    const Scenario s = shipped("heavy");
    for (const char* name :
         {"heavy.toml", "sequencer.toml", "maneuvers.toml", "surfaces.toml", "landing_gear.toml", "flywheel_rig.toml", "model.json"}) {
        INFO(name);
        CHECK(std::count_if(s.files.begin(), s.files.end(), [&](const auto& f) { return f.filename() == name; }) == 1);
    }
    CHECK(s.files.size() == 7);
}

TEST_CASE("the meter knows the rig", "[BRG-120]") {
    const Scenario s = shipped("endurance");
    const rig::record::MeterParameters p = rig::meter_parameters(s.rig, 1e-3);
    CHECK(p.flywheel_mass_kg == Approx(633.61).epsilon(1e-4));
    CHECK(p.brake_gain_m3 == Approx(5.067e-4 * 4 * 0.11));
    CHECK(p.peak_friction == Approx(1.170).epsilon(1e-3));
    CHECK(p.wheel_radius_m == 0.308716);
}

TEST_CASE("a wrong scenario is refused with file, line and key", "[BRG-120]") {
    const auto line_of = [](const settings::Error& e) { return e.line(); };
    const auto unknown = rejected("heavy", "slip_reference", "slip_refrence");
    CHECK(line_of(unknown) > 0);
    CHECK_THAT(unknown.what(), ContainsSubstring("slip_ref"));

    CHECK_THAT(rejected("heavy", "slip_reference = 0.24", "slip_reference = 0.9").what(), ContainsSubstring("0.9"));
    CHECK(rejected("heavy", "slip_reference = 0.24", "slip_reference = 0.9").key() == "law.slip_reference");
    CHECK_THAT(rejected("heavy", "law = \"slip\"", "law = \"slipp\"").what(), ContainsSubstring("slip"));
    CHECK_THAT(rejected("heavy", "name = \"heavy\"", "name = \"hevy\"").what(), ContainsSubstring("there are"));
    CHECK_THAT(rejected("heavy", "surface = \"dry_asphalt\"", "surface = \"mud\"").what(), ContainsSubstring("wet_asphalt"));
    CHECK(rejected("heavy", "title", "titel").line() > 0);
    CHECK_THAT(rejected("endurance", "cool_to_C = 60.0", "cool_to_C = 90.0").what(), ContainsSubstring("brake_on_limit_C"));
    CHECK_THAT(rejected("open_loop", "current_mA = [3.0, 8.0", "current_mA = [8.0").what(), ContainsSubstring("as many points"));
    CHECK_THAT(rejected("open_loop", "[0.0, 1.0, 2.0", "[0.0, 2.0, 1.0").what(), ContainsSubstring("current_time_s"));
    CHECK_THAT(rejected("heavy", "law = \"slip\"", "law = \"deceleration\"").what(), ContainsSubstring("deceleration_mps2"));
    CHECK_THAT(rejected("endurance", "speed_deviation_mps = 0.18", "speed_deviation_mps = -1").what(), ContainsSubstring("speed_deviation_mps"));
    CHECK_THAT(rejected("endurance", "[scatter]", "[scater]").what(), ContainsSubstring("scat"));
    CHECK_THROWS_AS(rig::load_scenario("config/scenarios/nothing.toml"), settings::Error);
    CHECK_THROWS_AS(rig::load_scenario("config/scenarios/heavy.toml", "nowhere"), settings::Error);
}

TEST_CASE("a sweep is a sine of steadily rising frequency behind the points", "[BRG-120]") {
    const Scenario s = shipped("sweep");
    const auto& points = s.mean.current;
    const auto at = [&points](double time_s) {
        const auto it = std::find_if(points.begin(), points.end(), [time_s](const auto& p) { return p.time_s > time_s - 1e-6; });
        REQUIRE(it != points.end());
        CHECK(it->time_s == Approx(time_s));
        return it->current_mA;
    };
    CHECK(at(7.0) == Approx(18.0));
    // Phase after t seconds: 0.3 t + (15 - 0.3) / 30 t^2 / 2 turns.
    constexpr double kTurn = 6.283185307179586;
    CHECK(at(8.0) == Approx(18.0 + 4.0 * std::sin(kTurn * (0.3 + 0.245))));
    CHECK(at(17.0) == Approx(18.0 + 4.0 * std::sin(kTurn * (3.0 + 24.5))));
    CHECK(points.back().time_s == Approx(37.0));
    // Turns towards the end: 15 Hz.
    int crossings = 0;
    for (std::size_t i = points.size() - 100; i < points.size(); ++i)
        crossings += (points[i - 1].current_mA - 18.0) * (points[i].current_mA - 18.0) < 0.0 ? 1 : 0;
    CHECK(crossings >= 28);
    CHECK(crossings <= 31);

    CHECK_THAT(rejected("sweep", "begin_s = 7.0", "begin_s = 5.0").what(), ContainsSubstring("begin_s") && ContainsSubstring("behind the last"));
    CHECK_THAT(rejected("sweep", "to_Hz = 15.0", "to_Hz = 40.0").what(), ContainsSubstring("to_Hz"));
    CHECK_THAT(rejected("sweep", "amplitude_mA = 4.0", "amplitude_mA = 19.0").what(), ContainsSubstring("amplitude_mA"));
    CHECK_THAT(rejected("sweep", "from_Hz", "from_hz").what(), ContainsSubstring("from_hz"));
}

TEST_CASE("a scenario on a runway: its file beside the rig's, and no J_mu from what the bridge measures", "[STUDY-070]") {
    const TemporaryDirectory directory;
    const auto file = directory / "wet.toml";
    put(file, replaced(content_of("config/scenarios/heavy.toml"), "surface = \"dry_asphalt\"", "runway = \"runways/wet_middle.toml\""));
    const Scenario s = rig::load_scenario(file);
    CHECK(s.rig.rig.runway.patches.size() == 3);
    CHECK(s.choice.road() == "wet_middle");
    CHECK(std::find(s.files.begin(), s.files.end(), "config/runways/wet_middle.toml") != s.files.end());
    CHECK(rig::meter_parameters(s.rig, 1e-3).peak_friction == 0.0);
    CHECK(rig::meter_parameters(shipped("heavy").rig, 1e-3).peak_friction > 1.0);
    CHECK(rejected("heavy", "surface = \"dry_asphalt\"", "surface = \"ice\"\nrunway = \"x.toml\"").key() == "maneuver.runway");
    CHECK(rejected("heavy", "surface = \"dry_asphalt\"", "").key() == "maneuver.surface");
}

TEST_CASE("Teeth and radius that the controller's file gives otherwise than the rig's are refused: both speeds would scale alike", "[BRG-120]") {
    const Scenario s = shipped("heavy");
    const antiskid::control::Config sound = antiskid::load_controller_config(s.controller);
    CHECK_NOTHROW(rig::check_same_rig(s.rig, sound, s.controller));
    antiskid::control::Config other = sound;
    other.wheel.encoder.teeth = 48.0F;
    CHECK_THAT(rejection_of([&] { rig::check_same_rig(s.rig, other, s.controller); }).what(),
               ContainsSubstring("controller.toml: wheel.encoder.teeth: is 48; expected 60, as in landing_gear.toml"));
    other = sound;
    other.flywheel.encoder.teeth = 61.0F;
    CHECK(rejection_of([&] { rig::check_same_rig(s.rig, other, s.controller); }).key() == "flywheel.encoder.teeth");
    other = sound;
    other.flywheel.radius_m *= 1.01F;
    CHECK(rejection_of([&] { rig::check_same_rig(s.rig, other, s.controller); }).key() == "flywheel.radius_m");
}

TEST_CASE("A plan that does not fit into the PLC's registers is refused before anything turns", "[BRG-120]") {
    const rig::RegisterMap map = rig::load_register_map("config/registers.toml");
    const rig::Plan plan = shipped("heavy").mean;
    CHECK_NOTHROW(rig::check(plan, map, "registers.toml"));
    rig::Plan heavy = plan;
    heavy.load_base_N = 117.7e3;
    CHECK_THAT(rejection_of([&] { rig::check(heavy, map, "registers.toml"); }).what(),
               ContainsSubstring("registers.toml: holding.load_base.range: ends at 100000 N; expected room for the scenario's 117700"));
    rig::Plan fast = plan;
    fast.speed_mps = 150.0;
    CHECK(rejection_of([&] { rig::check(fast, map, "registers.toml"); }).key() == "holding.flywheel_speed.range");
}

TEST_CASE("The speed below which a pick-up is blind grows with the drum and shrinks with its teeth", "[BRG-120]") {
    const Scenario s = shipped("heavy");
    const double turn_m = 2.0 * 3.14159265358979 * s.rig.rig.flywheel_radius_m;
    CHECK(s.mean.encoder_blind_mps == Approx(turn_m * s.rig.rig.flywheel_encoder.slowest_edges_hz / s.rig.rig.flywheel_encoder.teeth));
}
