/// What the closed loop must show on the 32 reference scenarios, through sensors and codec.
#include "tests/catch.hpp"
#include "tests/study/scenarios.hpp"

#include <map>

using scenarios::Name;

TEST_CASE("slip reference 0.24: tracked, no lock, friction used, books closed, on all 32 scenarios", "[STUDY-001]") {
    double sum = 0.0;
    const auto names = scenarios::all();
    REQUIRE(names.size() == 32);
    for (const Name& name : names) {
        INFO(name.surface << ", " << name.maneuver);
        const study::RunResult run = scenarios::run(scenarios::options(name));
        CHECK(run.figures.standstill);
        CHECK(run.faults.empty());
        CHECK(run.figures.tracked_share >= 0.95);
        CHECK(run.figures.longest_lock_s <= 0.050);
        CHECK(std::abs(run.figures.energy_residual) <= 1e-6);
        sum += run.figures.j_mu;
    }
    INFO("mean J_mu " << sum / 32.0);
    CHECK(sum / 32.0 >= 0.958);
}

TEST_CASE("the same holds with another seed of every sensor", "[STUDY-001]") {
    double sum = 0.0;
    for (const Name& name : scenarios::all()) {
        INFO(name.surface << ", " << name.maneuver);
        auto options = scenarios::options(name);
        options.seed = 20261121;
        const study::RunResult run = scenarios::run(options);
        CHECK(run.faults.empty());
        CHECK(run.figures.tracked_share >= 0.95);
        CHECK(run.figures.longest_lock_s <= 0.050);
        sum += run.figures.j_mu;
    }
    CHECK(sum / 32.0 >= 0.958);
}

TEST_CASE("the slip law beats the threshold law on every surface whose friction at 0.24 lets it", "[STUDY-001][figures]") {
    struct Sums {
        double j_mu = 0.0;
        double distance_m = 0.0;
    };
    std::map<std::string, Sums> slip;
    std::map<std::string, Sums> threshold;
    for (const Name& name : scenarios::all()) {
        for (auto* side : {&slip, &threshold}) {
            const auto run = scenarios::run(scenarios::options(name, side == &slip ? "slip" : "threshold"));
            CHECK(run.faults.empty());
            (*side)[name.surface].j_mu += run.figures.j_mu / 4.0;
            (*side)[name.surface].distance_m += run.figures.stop_distance_m / 4.0;
        }
    }
    for (const auto& [surface, ours] : slip) {
        INFO(surface << ": slip law " << ours.j_mu << ", " << ours.distance_m << " m; threshold law " << threshold[surface].j_mu << ", "
                     << threshold[surface].distance_m << " m");
        if (surface == "snow" || surface == "dry_cobblestone") continue;
        CHECK(ours.j_mu > threshold[surface].j_mu);
        CHECK(ours.distance_m < threshold[surface].distance_m);
    }
    // Dry cobblestone peaks at 0.40, where a law that cycles gets more than 0.24 has. Snow peaks at slip 0.06: whoever holds 0.24 exactly gets 0.942
    // of it, less than a law that cycles below. There the slip law is held to its reference: it must reach what 0.24 offers.
    auto options = scenarios::options({"snow", "heavy"});
    const rig::Surface snow = plant_sim::load_scenario(options).plant.rig.surface;
    CHECK(slip["snow"].j_mu >= rig::friction(snow, 0.24).mu / rig::peak(snow).mu);
    const rig::Surface cobble = plant_sim::load_scenario(scenarios::options({"dry_cobblestone", "heavy"})).plant.rig.surface;
    CHECK(slip["dry_cobblestone"].j_mu >= 0.96 * rig::friction(cobble, 0.24).mu / rig::peak(cobble).mu);
}

TEST_CASE("the peak is found without being told the surface", "[STUDY-602]") {
    std::map<std::string, double> sum;
    for (const Name& name : scenarios::all()) {
        INFO(name.surface << ", " << name.maneuver);
        auto options = scenarios::options(name, "peak_slip");
        const auto run = scenarios::run(options);
        CHECK(run.faults.empty());
        CHECK(run.figures.longest_lock_s <= 0.050);
        sum[name.surface] += run.figures.j_mu / 4.0;
    }
    double mean = 0.0;
    for (const auto& [surface, j_mu] : sum) {
        INFO(surface << " " << j_mu);
        CHECK(j_mu >= 0.955);
        mean += j_mu / static_cast<double>(sum.size());
    }
    CHECK(mean >= 0.980);
}

TEST_CASE("a reference far past the peak is reached without a lock, and tracked", "[CTL-040]") {
    // What is held exactly is the most that can be had; build-up, drop-out and the fall of the reference take the rest.
    for (const double reference : {0.44, 0.50}) {
        for (const char* surface : {"dry_asphalt", "wet_asphalt", "wet_cobblestone", "snow"}) {
            for (const char* maneuver : {"light", "medium_b"}) {
                INFO(surface << ", " << maneuver << ", reference " << reference);
                auto options = scenarios::options({surface, maneuver});
                options.slip = reference;
                const rig::Surface road = plant_sim::load_scenario(options).plant.rig.surface;
                const double held = rig::friction(road, reference).mu / rig::peak(road).mu;
                int locked_periods = 0;
                const auto count = [&](const study::RigSession& session, const antiskid::can::ControllerView& view, double) {
                    const bool fast = session.rig().wheel().v_mps > 20.0;  // down to where tracking is judged
                    if (fast && view.state == antiskid::control::State::locked_wheel) ++locked_periods;
                };
                const auto run = scenarios::run(options, study::Link::rounded, count);
                CHECK(run.faults.empty());
                CHECK(locked_periods == 0);
                CHECK(run.figures.tracked_share >= 0.95);
                CHECK(run.figures.j_mu >= held - 0.03);
            }
        }
    }
}

TEST_CASE("a worn and a fierce brake are held as well", "[STUDY-001]") {
    for (const double friction : {0.22, 0.36}) {
        for (const Name& name : scenarios::all()) {
            INFO(name.surface << ", " << name.maneuver << ", mu_b " << friction);
            auto options = scenarios::options(name);
            options.choice.friction = friction;
            const auto s = plant_sim::load_scenario(options);
            const auto run = scenarios::run(options);
            CHECK(run.faults.empty());
            CHECK(run.figures.longest_lock_s <= 0.050);
            // Where full pressure cannot give the torque that the road takes at 0.24, no controller can hold it.
            const rig::RigParameters& p = s.plant.rig;
            const double road_Nm = rig::friction(p.surface, 0.24).mu * p.load.base_N * p.wheel.free_radius_m;
            const double brake_Nm = 0.85 * friction * p.brake.gain_m3() * s.plant.full_pressure_Pa;
            if (brake_Nm > road_Nm) CHECK(run.figures.tracked_share >= 0.95);
        }
    }
}

TEST_CASE("the low-speed schedule of the reference can be switched off: the paper's exact law", "[STUDY-001]") {
    auto options = scenarios::options({"wet_cobblestone", "light"});
    plant_sim::StopInputs s = plant_sim::load_scenario(options);
    s.controller.slip.low_speed_mps = 0.0F;
    float lowest = 1.0F;
    const auto watch = [&](const study::RigSession& session, const antiskid::can::ControllerView& view, double) {
        if (view.state == antiskid::control::State::braking && session.rig().wheel().v_mps < 20.0) {
            lowest = std::min(lowest, view.slip_reference);
        }
    };
    (void)study::run_in_process(s.controller, s.layout, s.plant.rig, s.session, study::Link::rounded, watch);
    CHECK(lowest == Approx(0.24).epsilon(1e-3));
}

TEST_CASE("period 2 and 5 ms stop the aircraft, too", "[STUDY-001]") {
    for (const float period_s : {2e-3F, 5e-3F}) {
        for (const char* surface : {"dry_asphalt", "wet_asphalt", "snow", "ice"}) {
            INFO(surface << ", period " << period_s);
            plant_sim::StopInputs s = plant_sim::load_scenario(scenarios::options({surface, "light"}));
            s.controller.period_s = period_s;
            if (period_s > 2e-3F) {  // as docs/engineering/controller.md says: a longer period asks for less
                s.controller.slip.k_p_per_s *= 0.3F;
                s.controller.slip.k_d *= 0.2F;
                s.controller.slip.k_dd_s *= 0.2F;
                s.controller.slip.max_slip_rate_per_s *= 0.5F;
                s.controller.slip.low_speed_mps *= 1.2F;
            }
            s.session.period_s = static_cast<double>(period_s);
            const auto run = study::run_in_process(s.controller, s.layout, s.plant.rig, s.session, study::Link::frames);
            CHECK(run.faults.empty());
            CHECK(run.figures.standstill);
            CHECK(run.figures.tracked_share >= 0.9);
            CHECK(run.figures.longest_lock_s <= 0.050);
        }
    }
}
