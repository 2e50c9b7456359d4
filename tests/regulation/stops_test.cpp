/// The landings of `rig-lab regulate` in closed loop, few of them.
#include <algorithm>
#include <cmath>

#include "plant_sim/lab/regulate_stops.hpp"
#include "plant_sim/study/regulation/lives.hpp"
#include "tests/catch.hpp"

using plant_sim::lab::land;
using plant_sim::lab::LandingSites;

TEST_CASE("energies as the meter counts them are the plant's, and what the aircraft brought", "[STUDY-167]") {
    const LandingSites sites = plant_sim::lab::load_sites("config");
    REQUIRE(sites.sites.size() == 32);
    for (const std::size_t site : {std::size_t{0}, std::size_t{10}, std::size_t{19}, std::size_t{23}}) {
        const std::vector<regulation::LandingRequest> request{
            {.draw = {.scenario = site, .sensor_seed = 5}, .reference = 0.28, .mean_friction = 0.22}};
        const regulation::Stop stop = land(sites, request, 1).front();
        CAPTURE(sites.sites[site].surface, sites.sites[site].maneuver);
        CHECK(stop.measured.brake_J == Approx(stop.brake_J).epsilon(0.005));
        CHECK(stop.measured.tyre_J == Approx(stop.tyre_J).epsilon(0.02));
        CHECK(stop.measured.kinetic_J == Approx(sites.sites[site].kinetic_J()).epsilon(0.001));
        CHECK(stop.brake_J + stop.tyre_J == Approx(sites.sites[site].kinetic_J()).epsilon(0.001));
        CHECK(stop.measured.j_mu == Approx(stop.j_mu).margin(0.01));
        // Eq. (7) alone is 2 to 3 % below the mean over the stop.
        CHECK(stop.measured_friction == Approx(0.22).epsilon(0.003));
    }
}

TEST_CASE("landings side by side do not depend on the threads, nor on what lands beside them", "[STUDY-160]") {
    const LandingSites sites = plant_sim::lab::load_sites("config");
    std::vector<regulation::LandingRequest> requests;
    for (const std::size_t site : {0U, 3U, 10U, 16U, 9U, 5U, 1U, 8U, 4U, 11U, 12U})
        requests.push_back({.draw = {.scenario = site, .sensor_seed = 7 + site},
                            .reference = 0.2 + 0.01 * static_cast<double>(site),
                            .mean_friction = 0.25,
                            .metered = site % 3 != 0});
    const auto together = land(sites, requests, 1);
    const auto spread = land(sites, requests, 3);
    for (std::size_t i = 0; i < requests.size(); ++i) {
        CAPTURE(i);
        const std::vector<regulation::LandingRequest> one{requests[i]};
        for (const regulation::Stop& other : {spread[i], land(sites, one, 1).front()}) {
            CHECK(other.brake_J == together[i].brake_J);
            CHECK(other.distance_m == together[i].distance_m);
            if (!requests[i].metered) continue;
            CHECK(other.measured.tyre_J == together[i].measured.tyre_J);
            CHECK(other.measured_friction == together[i].measured_friction);
        }
        CHECK(std::isnan(together[i].measured.tyre_J) == !requests[i].metered);
    }
    const std::vector<regulation::LandingRequest> never{{.draw = {.scenario = 0, .sensor_seed = 1}, .reference = 0.2, .mean_friction = 1e-6}};
    CHECK_THROWS(land(sites, never, 1));
}

TEST_CASE("the shipped table of J_mu is what these landings give", "[STUDY-167]") {
    LandingSites sites = plant_sim::lab::load_sites("config");
    const wear::RegulationConfig config = wear::load_regulation_config("config/regulation.toml");
    const plant_sim::lab::CharacteriseOptions options{.references = {0.20, 0.36}, .seed = 1, .threads = 2};
    // Snow and ice take long: the dry and wet runways are enough here.
    std::erase_if(sites.sites, [](const auto& s) { return s.surface == "snow" || s.surface == "ice"; });
    const wear::SurfaceTable made = characterise(sites, options);
    const auto& grid = config.floor.reference;
    for (std::size_t i = 0; i < 2; ++i) {
        const auto at = std::find_if(grid.begin(), grid.end(), [&](double x) { return std::abs(x - options.references[i]) < 1e-9; });
        REQUIRE(at != grid.end());
        for (const auto& row : made.rows) {
            const auto* shipped = config.floor.find(row.surface);
            REQUIRE(shipped != nullptr);
            CAPTURE(row.surface, *at);
            const auto k = static_cast<std::size_t>(at - grid.begin());
            CHECK(row.j_mu[i] == Approx(shipped->j_mu[k]).margin(0.002));
            CHECK(row.tyre_share[i] == Approx(shipped->tyre_share[k]).margin(0.001));
            CHECK(row.distance_m[i] == Approx(shipped->distance_m[k]).epsilon(0.002));
        }
    }
}

TEST_CASE("a short life in closed loop: brake and tyre are used up together, no stop beyond the floor's", "[STUDY-167]") {
    LandingSites sites = plant_sim::lab::load_sites("config");
    std::erase_if(sites.sites, [](const auto& s) { return s.surface != "dry_concrete" && s.surface != "damp_asphalt"; });
    const wear::RegulationConfig config = wear::load_regulation_config("config/regulation.toml");
    const wear::BrakeWear brake = sites.sites.front().rig.wear;
    wear::WearPlan plan = wear::plan_of(config, brake.life_J, sites.mean_J(), sites.deviation_J());
    plan.landings = 48;
    const double left_J = 48 * sites.mean_J();
    plan.brake_taken_J = plan.brake_life_J - 0.72 * left_J;
    plan.tyre_life_J = 0.28 * left_J;
    regulation::LivesOptions options{.lives = 1, .seed = 3, .mix = regulation::Mix::balanced, .missing = 0.0, .scenarios = sites.sites.size()};
    const auto all = run_lives(plan, config.rules, config.range(), {{.name = "regulated"}}, brake, options,
                               [&sites](std::span<const regulation::LandingRequest> requests) { return land(sites, requests, 2); });
    const regulation::Life& life = all.front().lives.front();
    CAPTURE(life.brake_at_plan, life.tyre_at_plan, life.brought);
    CHECK(life.feasible);
    CHECK(life.met);
    CHECK(life.floor_held);
    for (const auto& row : life.rows) {
        CHECK(config.range().contains(row.reference));
        CHECK(row.j_mu > config.rules.j_mu_floor);
    }
}
