/// The landings of `rig-lab regulate` in closed loop, few of them.
#include <algorithm>
#include <cmath>

#include "plant_sim/lab/regulate_stops.hpp"
#include "plant_sim/study/regulation/fleet.hpp"
#include "tests/catch.hpp"

using plant_sim::land;
using plant_sim::LandingSites;

TEST_CASE("energies as the meter counts them are the plant's, and what the aircraft brought", "[STUDY-175]") {
    const LandingSites sites = plant_sim::load_sites("config");
    REQUIRE(sites.sites.size() == 32);
    for (const std::size_t site : {std::size_t{0}, std::size_t{10}, std::size_t{19}, std::size_t{23}}) {
        const regulation::Stop stop = land(sites, {.scenario = site, .sensor_seed = 5}, 0.28, 0.22);
        CAPTURE(sites.sites[site].surface, sites.sites[site].maneuver);
        CHECK(stop.measured.brake_J == Approx(stop.brake_J).epsilon(0.005));
        CHECK(stop.measured.tyre_J == Approx(stop.tyre_J).epsilon(0.02));
        CHECK(stop.measured.kinetic_J == Approx(sites.sites[site].kinetic_J()).epsilon(0.001));
        CHECK(stop.brake_J + stop.tyre_J == Approx(sites.sites[site].kinetic_J()).epsilon(0.001));
        CHECK(stop.measured.j_mu == Approx(stop.j_mu).margin(0.01));
    }
}

TEST_CASE("the shipped table of J_mu is what these landings give", "[STUDY-175]") {
    LandingSites sites = plant_sim::load_sites("config");
    const regulation::Order order = regulation::load_order("config/regulation.toml");
    const plant_sim::CharacteriseOptions options{.references = {0.20, 0.36}, .seed = 1, .threads = 2};
    // Snow and ice take long: the dry and wet runways are enough here.
    std::erase_if(sites.sites, [](const auto& s) { return s.surface == "snow" || s.surface == "ice"; });
    const regulation::Characterisation made = characterise(sites, options);
    const auto& grid = order.floor.reference;
    for (std::size_t i = 0; i < 2; ++i) {
        const auto at = std::find_if(grid.begin(), grid.end(),
                                     [&](double x) { return std::abs(x - options.references[i]) < 1e-9; });
        REQUIRE(at != grid.end());
        for (const auto& row : made.floor.rows) {
            const auto* shipped = order.floor.find(row.surface);
            REQUIRE(shipped != nullptr);
            CAPTURE(row.surface, *at);
            CHECK(row.j_mu[i] ==
                  Approx(shipped->j_mu[static_cast<std::size_t>(at - grid.begin())]).margin(0.002));
        }
    }
}

TEST_CASE("a short life in closed loop: brake and tyre are used up together, no stop beyond the floor's",
          "[STUDY-175]") {
    LandingSites sites = plant_sim::load_sites("config");
    std::erase_if(sites.sites,
                  [](const auto& s) { return s.surface != "dry_concrete" && s.surface != "damp_asphalt"; });
    const regulation::Order order = regulation::load_order("config/regulation.toml");
    const wear::BrakeWear brake = sites.sites.front().rig.wear;
    regulation::Plan plan = regulation::plan_of(order, brake.life_J, sites.mean_J(), sites.deviation_J());
    plan.landings = 48;
    const double left_J = 48 * sites.mean_J();
    plan.brake_taken_J = plan.brake_life_J - 0.72 * left_J;
    plan.tyre_life_J = 0.28 * left_J;
    regulation::FleetOptions options{.lives = 1,
                                     .seed = 3,
                                     .mix = regulation::Mix::balanced,
                                     .missing = 0.0,
                                     .scenarios = sites.sites.size(),
                                     .threads = 2};
    const auto all =
        run_fleet(plan, order.rules, order.range(), {{"regulated", std::nullopt}}, brake, options, [&sites] {
            return [&sites](const regulation::Draw& draw, double reference, double friction) {
                return land(sites, draw, reference, friction);
            };
        });
    const regulation::Life& life = all.front().lives.front();
    CAPTURE(life.brake_at_plan, life.tyre_at_plan, life.brought);
    CHECK(life.feasible);
    CHECK(life.met);
    CHECK(life.floor_held);
    for (const auto& row : life.rows) {
        CHECK(order.range().contains(row.reference));
        CHECK(row.j_mu > order.rules.j_mu_floor);
    }
}
