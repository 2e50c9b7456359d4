/// Which brake a landing is run with, and that it is kept from one to the next.
#include "plant_sim/scenario/brake_options.hpp"

#include "firmware/host/settings/command_line.hpp"
#include "plant_sim/wear/brake_state.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"
#include "tests/study/scenarios.hpp"

namespace {

plant_sim::StopOptions landing() {
    return scenarios::options({"wet_asphalt", "light"});
}

/// As `virtual-rig` and `rig-lab stop` do.
double landed(const plant_sim::StopOptions& options) {
    const plant_sim::StopInputs s = plant_sim::load_scenario(options);
    const study::RunResult run = study::run_in_process(s.controller, s.layout, s.plant.rig, s.session, study::Link::rounded);
    s.save_brake(options, run.figures.energy_brake_J);
    return s.plant.rig.mean_friction;
}

plant_sim::BrakeOptions asked(const std::string& arguments) {
    plant_sim::BrakeOptions options;
    CLI::App app;
    options.add_to(app);
    app.parse(arguments);
    return options;
}

}  // namespace

TEST_CASE("--brake says new, worn or MJ; anything else is refused", "[RIG-300]") {
    const wear::BrakeWear wear = plant_sim::load_scenario(landing()).plant.wear;
    CHECK_FALSE(asked("").given());
    CHECK(asked("--brake new").brake_of(wear, 3).state() == wear::BrakeState{3, 0, 0.0});
    CHECK(asked("--brake worn").brake_of(wear, 3).state() == wear::BrakeState{3, 0, 3.9e9});
    CHECK(asked("--brake 1250.5").brake_of(wear, 3).state() == wear::BrakeState{3, 0, 1250.5e6});
    for (const char* wrong : {"--brake old", "--brake -1", "--brake 5MJ", "--brake nan", "--brake 1e10"})
        CHECK_THROWS_AS(asked(wrong), CLI::ValidationError);
    const auto rule = asked("--brake new --variance printed --component mixture").brake_of(wear, 1).rule();
    CHECK(rule == wear::ConditionalRule{wear::Variance::printed, wear::Choice::mixture});
}

TEST_CASE("a landing has the friction of the brake asked for; --mu-b stands above it", "[RIG-300]") {
    auto options = landing();
    CHECK(plant_sim::load_scenario(options).plant.rig.mean_friction == 0.30);
    CHECK_FALSE(plant_sim::load_scenario(options).brake);
    options.brake.brake = "worn";
    const plant_sim::StopInputs worn = plant_sim::load_scenario(options);
    CHECK(worn.plant.rig.mean_friction == worn.brake->next_friction());
    CHECK(worn.plant.rig.mean_friction < 0.22);
    CHECK(worn.report(options).brake_taken_J == 3.9e9);
    options.choice.friction = 0.25;
    CHECK(plant_sim::load_scenario(options).plant.rig.mean_friction == 0.25);
}

TEST_CASE("landings one after the other wear the kept brake as one object would", "[RIG-300]") {
    const TemporaryDirectory directory;
    auto options = landing();
    options.brake.state = directory / "brake.json";
    const plant_sim::StopInputs s = plant_sim::load_scenario(options);
    wear::WearingBrake whole = *s.brake;
    for (std::uint64_t landings = 1; landings <= 3; ++landings) {
        options.seed = landings;  // the kept brake has its own
        CHECK(landed(options) == whole.next_friction());
        const auto kept = wear::find_brake_state(options.brake.state, s.plant.wear);
        REQUIRE(kept);
        CHECK(kept->maneuvers == landings);
        CHECK(kept->seed == 1);
        // m v^2 / 2 of the light landing, what the tyre took off.
        const double energy_J = kept->c_e_J - whole.state().c_e_J;
        CHECK(energy_J > 0.6 * 0.5 * 2800.0 * 49.0 * 49.0);
        CHECK(energy_J < 0.5 * 2800.0 * 49.0 * 49.0);
        whole.take(energy_J);
        whole = {whole.wear(), whole.rule(), *kept};
    }
    options.brake.brake = "new";
    CHECK_THROWS_AS(plant_sim::load_scenario(options), std::invalid_argument);
    options.brake.brake.clear();
    options.choice.maneuver = rig::kEndurance;  // another brake
    options.law = "deceleration";
    CHECK_THROWS_AS(plant_sim::load_scenario(options), settings::Error);
}

TEST_CASE("beyond the model's data it is said that and how the model goes on", "[RIG-300]") {
    const wear::BrakeWear wear = plant_sim::load_scenario(landing()).plant.wear;
    const auto notice = [&](const char* arguments) { return plant_sim::extrapolation_notice(asked(arguments).brake_of(wear, 1)); };
    CHECK(notice("--brake new").empty());
    CHECK(notice("--brake worn").empty());
    CHECK_THAT(notice("--brake 4000"), ContainsSubstring("4000.0 MJ") && ContainsSubstring(wear::kHowItExtrapolates));
}
