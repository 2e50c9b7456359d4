/// The shipped plant data against what is printed and published. Their readers check types and ranges; this checks the values.
#include <array>
#include <cmath>

#include "tests/settings/refusal.hpp"

namespace {

double mean_over_stop(const std::vector<double>& c) {
    return c[0] + c[1] / 2.0 + c[2] / 3.0 + c[3] / 4.0;
}

void check_friction_curves(const settings::Table& brake) {
    for (const auto* const friction_class : {"light", "medium", "heavy"}) {
        CAPTURE(friction_class);
        const auto c = brake.table("relative_friction").numbers(friction_class, {.count = {.min = 4, .max = 4}});
        CHECK(mean_over_stop(c) == Approx(1.0).epsilon(1e-12));
        for (int step = 0; step <= 64; ++step) {
            const double x = step / 64.0;
            const double f = c[0] + x * (c[1] + x * (c[2] + x * c[3]));
            CHECK(f > 0.7);
            CHECK(f < 1.3);
        }
    }
}

void check_valve(const settings::Table& valve) {
    const auto current_mA = valve.numbers("current_mA", {.count = {.min = 8}, .strictly_increasing = true});
    const auto pressure_Pa = valve.numbers("pressure_Pa", {.count = {.min = 8}, .strictly_increasing = true});
    REQUIRE(current_mA.size() == pressure_Pa.size());
    CHECK(current_mA.front() == 3.0);
    CHECK(pressure_Pa.front() == 0.0);
    CHECK(current_mA.back() == 40.0);
    CHECK(pressure_Pa.back() == 2.07e7);
}

double brake_gain_m3(const settings::Table& brake) {
    return brake.number("friction") * brake.number("piston_area_m2") * brake.number("pistons") * brake.number("surfaces") *
           brake.number("effective_radius_m");
}

}  // namespace

TEST_CASE("surfaces peak where they are published to", "[CFG-028]") {
    struct Published {
        std::string_view name;
        double slip;
        double mu;
    };
    constexpr std::array<Published, 8> kPublished{{{"dry_asphalt", 0.170, 1.170},
                                                   {"dry_concrete", 0.160, 1.090},
                                                   {"dry_cobblestone", 0.400, 1.000},
                                                   {"damp_asphalt", 0.231, 0.920},
                                                   {"wet_asphalt", 0.131, 0.801},
                                                   {"wet_cobblestone", 0.140, 0.380},
                                                   {"snow", 0.060, 0.190},
                                                   {"ice", 0.031, 0.050}}};
    const auto doc = settings::Document::load("config/surfaces.toml");
    const auto surfaces = doc.root().tables("surfaces");
    REQUIRE(surfaces.size() == kPublished.size());
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        CAPTURE(surfaces[i].name());
        CHECK(surfaces[i].name() == kPublished[i].name);
        const double c1 = surfaces[i].number("c1");
        const double c2 = surfaces[i].number("c2");
        const double c3 = surfaces[i].number("c3");
        // A search, not the closed form that the plant uses.
        double slip = 0.0;
        double mu = 0.0;
        for (int step = 0; step <= 100000; ++step) {
            const double lambda = step * 1e-5;
            const double candidate = c1 * (1.0 - std::exp(-c2 * lambda)) - c3 * lambda;
            if (candidate > mu) {
                mu = candidate;
                slip = lambda;
            }
        }
        CHECK(std::abs(slip - kPublished[i].slip) <= 0.0005);
        CHECK(std::abs(mu - kPublished[i].mu) <= 0.0005);
    }
    CHECK_NOTHROW(doc.finish());
}

TEST_CASE("landing gear and maneuvers agree with each other", "[CFG-028]") {
    const auto gear = settings::Document::load("config/landing_gear.toml");
    const auto brake = gear.root().table("brake");
    CHECK(brake_gain_m3(brake) == Approx(1.04e-3).epsilon(3e-3));
    check_friction_curves(brake);
    check_valve(gear.root().table("valve"));

    const auto environment = gear.root().table("environment");
    const double lift_Ns2pm2 = 0.5 * environment.number("air_density_kgpm3") * gear.root().table("aircraft").number("lift_area_m2");
    const auto doc = settings::Document::load("config/maneuvers.toml");
    const auto maneuvers = doc.root().tables("maneuvers", {.min = 4, .max = 4});
    for (const auto& maneuver : maneuvers) {
        const double speed_mps = maneuver.number("speed_mps");
        const double weight_N = maneuver.number("mass_kg") * environment.number("gravity_mps2");
        CHECK(weight_N - lift_Ns2pm2 * speed_mps * speed_mps > 0.5 * weight_N);
        CHECK(brake.table("relative_friction").has(maneuver.text("friction_class")));
    }
    const auto reference = doc.root().table("reference");
    CHECK(doc.root().table("maneuvers").has(reference.text("maneuver")));
    CHECK(settings::Document::load("config/surfaces.toml").root().table("surfaces").has(reference.text("surface")));
    CHECK(reference.number("slip_reference") == 0.24);
    CHECK_NOTHROW(doc.finish());
}

TEST_CASE("the flywheel rig meets every row of Table III", "[CFG-028]") {
    const auto doc = settings::Document::load("config/flywheel_rig.toml");
    const auto root = doc.root();
    const auto campaign = root.table("endurance");
    const double load_N = campaign.number("load_N");
    const double speed_mps = campaign.number("speed_mps");
    const double duration_s = campaign.number("duration_s");
    const double deceleration_mps2 = campaign.number("deceleration_mps2");
    CHECK(load_N == 23532.78);

    const auto wheel = root.table("wheel");
    const double radius_m = wheel.number("free_radius_m") - load_N / wheel.number("stiffness_Npm");
    CHECK(radius_m == Approx(0.30).epsilon(1e-5));
    const double flywheel_radius_m = root.table("flywheel").number("radius_m");
    const double mass_kg = root.table("flywheel").number("inertia_kgm2") / (flywheel_radius_m * flywheel_radius_m);
    const double mass_radius_kgm = (mass_kg + wheel.number("inertia_kgm2") / (radius_m * radius_m)) * radius_m;
    CHECK(std::abs(mass_radius_kgm - 194.4) <= 0.05);

    // Well inside one standard deviation of the printed means.
    CHECK(std::abs(mass_radius_kgm * deceleration_mps2 - campaign.number("torque_Nm")) <= 0.1 * campaign.number("torque_deviation_Nm"));
    CHECK(std::abs(speed_mps / deceleration_mps2 - duration_s) <= 0.1 * campaign.number("duration_deviation_s"));
    CHECK(std::abs(0.5 * speed_mps * duration_s - campaign.number("length_m")) <= 0.1 * campaign.number("length_deviation_m"));

    const auto brake = root.table("brake");
    const double pressure_Pa = campaign.number("torque_Nm") / brake_gain_m3(brake);
    CHECK(pressure_Pa > 0.4 * 2.07e7);
    CHECK(pressure_Pa < 0.6 * 2.07e7);
    check_friction_curves(brake);
    check_valve(root.table("valve"));
}
