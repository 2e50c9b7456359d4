/// What is drawn, and that nothing but the seed decides it.
#include <cmath>
#include <map>
#include <set>

#include "plant_sim/study/sweep/stops_table.hpp"
#include "plant_sim/study/sweep/sweep_plan.hpp"
#include "plant_sim/study/team/shared_work.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "tests/catch.hpp"
#include "tests/study/team_of_threads.hpp"

TEST_CASE("the paper's sweep: 32 scenarios, 45 references, 100 landings, 4,500 stops and the threshold law's", "[STUDY-148]") {
    const sweep::SweepPlan plan = sweep::load_plan({});
    CHECK(plan.scenarios.size() == 32);
    CHECK(plan.references.size() == 45);
    CHECK(plan.references.front() == 0.06);
    CHECK(plan.references.back() == 0.50);
    CHECK(plan.stops() == 4600);
    for (std::size_t j = 0; j < 100; ++j) {
        const sweep::Stop first = plan.stop(j);
        const sweep::Stop last = plan.stop(4500 + j);
        CHECK(last.threshold);
        CHECK_FALSE(first.threshold);
        // The same landing, whatever the reference.
        CHECK(first.surface == last.surface);
        CHECK(first.maneuver == last.maneuver);
        CHECK(first.mean_friction == last.mean_friction);
        CHECK(first.sensor_seed == last.sensor_seed);
        CHECK(plan.rig(j).mean_friction == first.mean_friction);
        CHECK(plan.session(2300 + j).seed == first.sensor_seed);
        CHECK(plan.session(2300 + j).plan.slip_reference == plan.references[23]);
    }
}

TEST_CASE("landings are drawn each by itself: more of them change none, another seed changes all", "[STUDY-148]") {
    const auto friction = [](double c_e_J, wear::Generator& generator) { return 0.3 - 1e-11 * c_e_J + 1e-3 * wear::normal(generator); };
    const sweep::BrakeLife brake{.life_J = 4e9, .friction = friction};
    const auto few = sweep::draw_landings(7, 10, 32, brake);
    const auto many = sweep::draw_landings(7, 1000, 32, brake);
    const auto other = sweep::draw_landings(8, 10, 32, brake);
    for (std::size_t i = 0; i < few.size(); ++i) {
        CHECK(few[i].c_e_J == many[i].c_e_J);
        CHECK(few[i].mean_friction == many[i].mean_friction);
        CHECK(few[i].sensor_seed == many[i].sensor_seed);
        CHECK(few[i].scenario == many[i].scenario);
        CHECK(few[i].c_e_J != other[i].c_e_J);
        CHECK(few[i].sensor_seed != other[i].sensor_seed);
    }
    // Uniform over scenarios and life: 1000 draws, chi-square with 31 degrees of freedom below its 99.9 % quantile of 61.1.
    std::map<std::size_t, double> counts;
    double mean_J = 0.0;
    for (const sweep::DrawnLanding& landing : many) {
        REQUIRE(landing.scenario < 32);
        REQUIRE(landing.c_e_J > 0.0);
        REQUIRE(landing.c_e_J < 4e9);
        counts[landing.scenario] += 1.0;
        mean_J += landing.c_e_J / 1000.0;
    }
    double chi_square = 0.0;
    for (std::size_t i = 0; i < 32; ++i) chi_square += std::pow(counts[i] - 31.25, 2) / 31.25;
    CHECK(chi_square < 61.1);
    CHECK(mean_J == Approx(2e9).margin(3.3 * 4e9 / std::sqrt(12.0 * 1000.0)));
}

TEST_CASE("friction is drawn from the brake's wear model at the wear that was drawn", "[STUDY-148]") {
    sweep::SweepPlanOptions options;
    options.landings = 2000;
    const sweep::SweepPlan plan = sweep::load_plan(options);
    const rig::LoadedRig rig = rig::load_rig("config", {});
    double off = 0.0;
    double low = 1.0;
    double high = 0.0;
    for (const sweep::DrawnLanding& landing : plan.landings) {
        const double expected = wear::expected_friction_at(*rig.wear.model, rig.wear.scale, {}, landing.c_e_J);
        off += (landing.mean_friction - expected) / 2000.0;
        low = std::min(low, landing.mean_friction);
        high = std::max(high, landing.mean_friction);
        CHECK(std::abs(landing.mean_friction - expected) < 0.05);
    }
    CHECK(std::abs(off) < 1e-3);
    CHECK(high - low > 0.05);  // from a new brake to a worn one
}

TEST_CASE("the order of work has every stop once, and its parts are alike", "[STUDY-148]") {
    const auto all = study::team::order_of_work(4600);
    CHECK(std::set<std::size_t>(all.begin(), all.end()).size() == 4600);
    std::set<std::size_t> seen;
    for (std::size_t rank = 0; rank < 3; ++rank) {
        threads::Wire wire;
        const threads::Member team(wire, rank, 3);
        const auto part = study::team::share_of(all, team);
        CHECK(part.size() >= 1533);
        CHECK(part.size() <= 1534);
        std::map<std::size_t, int> landings;
        for (const std::size_t number : part) {
            CHECK(seen.insert(number).second);
            ++landings[number % 100];
        }
        // Each landing's 46 stops fall evenly: an expected 15.3 with a standard deviation of 3.2.
        for (const auto& [landing, count] : landings) CHECK(std::abs(count - 15) < 15);
    }
    CHECK(seen.size() == 4600);
}
