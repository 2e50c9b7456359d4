#include "rig_bridge/wear/regulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/catch.hpp"
#include "tests/regulation/toy_landing.hpp"

using wear::Landing;
using wear::Range;
using wear::Reading;
using wear::Regulator;
using wear::Rules;
using wear::WearPlan;

namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

/// How far apart the two lives are used up when one of them ends, as shares of a life.
double apart(const Regulator& r) {
    return std::abs(r.brake_used_J() / r.plan().brake_life_J - r.tyre_used_J() / r.plan().tyre_life_J);
}

Regulator lived(const WearPlan& plan, const toy::Plant& plant, unsigned seed, const Rules& rules = {}) {
    Regulator regulator(plan, rules, toy::kRange);
    toy::Landings landings(plant, seed);
    while (regulator.brake_left_J() > 0.0 && regulator.tyre_left_J() > 0.0) regulator.after(landings.next(regulator.reference()));
    return regulator;
}

}  // namespace

TEST_CASE("brake and tyre reach their limits together, whatever landings come and whatever share a slip gives", "[STUDY-167]") {
    for (const double share : {0.22, 0.28, 0.33}) {
        for (const double slope : {0.8, 0.95, 1.1}) {
            const toy::Plant plant{.offset = 0.01, .slope = slope, .noise = 0.03};
            if (share > plant.offset + plant.slope * toy::kRange.highest - 0.01) continue;
            for (unsigned seed = 1; seed <= 20; ++seed) {
                const Regulator end = lived(toy::plan(250, share), plant, seed);
                CAPTURE(share, slope, seed, end.landings());
                CHECK(apart(end) < 0.02);
                // Together at the planned landing: its scatter is that of the landings' energies, 4 sigma.
                CHECK(std::abs(end.landings() - 250) < 4.0 * std::sqrt(250.0) * toy::Landings::kDeviation_J / toy::Landings::kMean_J);
            }
        }
    }
}

TEST_CASE("the error in the remaining ratio obeys D' = (1 - W/R) D - e W, and so shrinks with every landing", "[STUDY-167]") {
    const WearPlan plan = toy::plan(200, 0.30);
    const double ratio = plan.tyre_life_J / (plan.tyre_life_J + plan.brake_life_J);
    // Wide bounds and steps, no noise, a slope that is exactly what the regulator expects at first: no saturation, e = 0.
    Regulator r(plan, {.default_reference = 0.24, .step = 0.5}, {0.05, 0.5});
    toy::Landings landings({.offset = 0.0, .slope = 1.0, .noise = 0.0}, 3);
    r.spent(0.0, 0.1 * plan.tyre_life_J);
    r.after(landings.next(0.24));
    double left_J = r.brake_left_J() + r.tyre_left_J();
    double imbalance_J = r.tyre_left_J() - ratio * left_J;
    for (int i = 0; i < 150; ++i) {
        const Landing l = landings.next(r.reference());
        r.after(l);
        const double expected_J = imbalance_J * (1.0 - l.kinetic_J / left_J);
        left_J = r.brake_left_J() + r.tyre_left_J();
        imbalance_J = r.tyre_left_J() - ratio * left_J;
        CHECK(imbalance_J == Approx(expected_J).epsilon(1e-9));
    }
}

TEST_CASE("it learns the share that a reference gives", "[STUDY-167]") {
    Regulator r(toy::plan(400, 0.27), {}, toy::kRange);
    toy::Landings landings({.offset = 0.0, .slope = 0.85, .noise = 0.02}, 9);
    for (int i = 0; i < 200; ++i) r.after(landings.next(r.reference()));
    CHECK(r.share_per_slip() == Approx(0.85).epsilon(0.03));
    CHECK(r.measured_share() == Approx(r.share_of(r.reference())).margin(0.03));
    CHECK(r.landing_J() == Approx(toy::Landings::kMean_J).epsilon(0.1));
}

TEST_CASE("where the share is out of reach the reference stays at its bound", "[STUDY-167]") {
    const Regulator high = lived(toy::plan(250, 0.45), {.noise = 0.0}, 4);
    CHECK(high.reference() == toy::kRange.highest);
    CHECK(high.brake_left_J() == 0.0);
    CHECK(high.tyre_left_J() > 0.1 * high.plan().tyre_life_J);
    const Regulator low = lived(toy::plan(250, 0.12), {.noise = 0.0}, 4);
    CHECK(low.reference() == toy::kRange.lowest);
    CHECK(low.tyre_left_J() == 0.0);
}

TEST_CASE("a brake life that is revised on the way is met all the same", "[STUDY-167]") {
    const WearPlan plan = toy::plan(250, 0.30);
    Regulator r(plan, {}, toy::kRange);
    toy::Landings landings({}, 21);
    for (int i = 0; i < 100; ++i) r.after(landings.next(r.reference()));
    CHECK_FALSE(r.revise_brake_life(kNotANumber));
    CHECK_FALSE(r.revise_brake_life(-1.0));
    CHECK(r.plan().brake_life_J == plan.brake_life_J);
    CHECK(r.revise_brake_life(0.93 * plan.brake_life_J));
    while (r.brake_left_J() > 0.0 && r.tyre_left_J() > 0.0) r.after(landings.next(r.reference()));
    CHECK(apart(r) < 0.02);
    CHECK(r.landings() < 250);
}

TEST_CASE("whatever is measured, the reference stays in its range and moves by one step at most", "[STUDY-167]") {
    std::mt19937 generator(17);
    const std::vector<double> odd{kNotANumber, std::numeric_limits<double>::infinity(), -1.0, 0.0, 1e300, 5e6, 1e6, 0.3};
    const Rules rules{.step = 0.013};
    for (int repeat = 0; repeat < 50; ++repeat) {
        Regulator r(toy::plan(100, 0.3), rules, toy::kRange);
        toy::Landings landings({.noise = 0.1}, static_cast<unsigned>(repeat));
        for (int i = 0; i < 150; ++i) {
            const double before = r.reference();
            Landing l = landings.next(before);
            if (generator() % 3 == 0) {
                for (double* const value : {&l.kinetic_J, &l.brake_J, &l.tyre_J, &l.j_mu, &l.brake_wear_J}) {
                    if (generator() % 2 == 0) *value = odd[generator() % odd.size()];
                }
            }
            const Range was = r.range();
            r.after(l);
            REQUIRE(r.range().lowest >= was.lowest);
            REQUIRE(r.range().highest <= was.highest);
            REQUIRE(r.range().contains(r.reference()));
            REQUIRE(r.range().contains(rules.default_reference));
            if (r.range() == was) REQUIRE(std::abs(r.reference() - before) <= rules.step + 1e-12);
            REQUIRE(std::isfinite(r.brake_left_J()));
            REQUIRE(std::isfinite(r.share_per_slip()));
        }
    }
}

TEST_CASE("measurements that cannot be are named, hold the reference, and are no news", "[STUDY-167]") {
    Regulator r(toy::plan(250, 0.3), {.max_unmeasured_landings = 3}, toy::kRange);
    toy::Landings landings({.noise = 0.0}, 2);
    for (int i = 0; i < 20; ++i) {
        Landing l = landings.next(r.reference());
        l.brake_wear_J = r.brake_used_J() + l.brake_J;
        REQUIRE(r.after(l) == Reading::measured);
    }
    const Landing good = landings.next(r.reference());
    const auto changed = [&](double Landing::*value, double to) {
        Landing l = good;
        l.*value = to;
        return l;
    };
    const std::vector<std::pair<Landing, Reading>> cases{
        {changed(&Landing::tyre_J, kNotANumber), Reading::missing},
        {changed(&Landing::brake_J, std::numeric_limits<double>::infinity()), Reading::missing},
        {changed(&Landing::kinetic_J, 0.0), Reading::missing},
        {changed(&Landing::reference, kNotANumber), Reading::missing},
        {changed(&Landing::tyre_J, -1.0), Reading::negative},
        {changed(&Landing::tyre_J, 1.2 * good.kinetic_J), Reading::beyond_kinetic},
        {changed(&Landing::brake_J, 0.5 * good.brake_J), Reading::energy_mismatch},
        {changed(&Landing::brake_wear_J, 0.5 * r.brake_used_J()), Reading::counter_back},
    };
    for (const auto& [landing, reading] : cases) {
        Regulator one = r;
        CAPTURE(name(reading));
        CHECK(one.after(landing) == reading);
        CHECK(one.reference() == r.reference());
        CHECK(one.share_per_slip() == r.share_per_slip());
        CHECK(one.missed() == 1);
        // It wore all the same.
        CHECK(one.brake_used_J() - r.brake_used_J() + one.tyre_used_J() - r.tyre_used_J() > 3e6);
        CHECK(one.after(good) == Reading::measured);
        CHECK(one.missed() == 0);
    }
}

TEST_CASE("without measurements it goes back to the default, step by step, and takes up again when they come", "[STUDY-167]") {
    const Rules rules{.step = 0.01, .max_unmeasured_landings = 4};
    Regulator r(toy::plan(250, 0.33), rules, toy::kRange);
    toy::Landings landings({}, 6);
    for (int i = 0; i < 60; ++i) r.after(landings.next(r.reference()));
    const double held = r.reference();
    REQUIRE(held > 0.3);
    for (int i = 0; i < 3; ++i) {
        r.after({});
        CHECK(r.reference() == held);
    }
    for (int i = 1; i <= 20; ++i) {
        r.after({});
        CHECK(r.reference() == Approx(std::max(0.24, held - 0.01 * i)).margin(1e-12));
    }
    CHECK(r.reference() == rules.default_reference);
    while (r.brake_left_J() > 0.0 && r.tyre_left_J() > 0.0) r.after(landings.next(r.reference()));
    CHECK(r.missed() == 0);
}

TEST_CASE("one landing in ten lost: the limits are still reached together, the wear counter tells what they took", "[STUDY-167]") {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        Regulator r(toy::plan(250, 0.29), {}, toy::kRange);
        toy::Landings landings({}, seed);
        std::mt19937 lost(seed);
        double brake_J = 0.0;
        double tyre_J = 0.0;
        while (brake_J < r.plan().brake_life_J && tyre_J < r.plan().tyre_life_J) {
            Landing l = landings.next(r.reference());
            brake_J += l.brake_J;
            tyre_J += l.tyre_J;
            l.brake_wear_J = brake_J;
            r.after(lost() % 10 == 0 ? Landing{} : l);
        }
        CHECK(std::abs(brake_J / r.plan().brake_life_J - tyre_J / r.plan().tyre_life_J) < 0.02);
        CHECK(r.brake_used_J() == Approx(brake_J).epsilon(0.01));
        CHECK(r.tyre_used_J() == Approx(tyre_J).epsilon(0.01));
    }
}

TEST_CASE("a measured J_mu below the floor moves the bound towards the default, never past it", "[STUDY-167]") {
    Regulator r(toy::plan(250, 0.45), {.step = 0.02, .j_mu_floor = 0.85}, toy::kRange);
    toy::Landings landings({.noise = 0.0}, 8);
    for (int i = 0; i < 30; ++i) r.after(landings.next(r.reference()));
    REQUIRE(r.reference() == toy::kRange.highest);
    Landing bad = landings.next(r.reference());
    bad.j_mu = 0.80;
    r.after(bad);
    CHECK(r.range() == Range{toy::kRange.lowest, toy::kRange.highest - 0.02});
    CHECK(r.reference() == toy::kRange.highest - 0.02);
    for (int i = 0; i < 50; ++i) {
        bad = landings.next(r.reference());
        bad.j_mu = 0.5;
        r.after(bad);
    }
    CHECK(r.range() == Range{toy::kRange.lowest, 0.24});
    // Another surface may be worse than those seen so far.
    r.narrow({0.2, 0.5});
    CHECK(r.range() == Range{0.2, 0.24});
    CHECK_THROWS_AS(r.narrow({0.25, 0.5}), std::invalid_argument);
}

TEST_CASE("the same landings give the same references: it is rebuilt from what was measured", "[STUDY-167]") {
    const WearPlan plan = toy::plan(120, 0.28);
    Regulator r(plan, {}, toy::kRange);
    toy::Landings landings({}, 12);
    std::vector<Landing> seen;
    for (int i = 0; i < 100; ++i) {
        Landing l = landings.next(r.reference());
        if (i % 11 == 5) l.tyre_J = kNotANumber;
        seen.push_back(l);
        r.after(l);
        Regulator again(plan, {}, toy::kRange);
        for (const Landing& old : seen) again.after(old);
        REQUIRE(again.reference() == r.reference());
        REQUIRE(again.required_share() == r.required_share());
    }
}

TEST_CASE("plans and rules that cannot be are refused", "[STUDY-167]") {
    const WearPlan good = toy::plan(100, 0.3);
    const auto rejects = [](const WearPlan& plan, const Rules& rules, const char* what) {
        CHECK_THROWS_WITH(Regulator(plan, rules, toy::kRange), ContainsSubstring(what));
    };
    WearPlan plan = good;
    plan.landings = 0;
    rejects(plan, {}, "landings");
    plan = good;
    plan.tyre_life_J = kNotANumber;
    rejects(plan, {}, "life");
    plan = good;
    plan.brake_taken_J = plan.brake_life_J;
    rejects(plan, {}, "brake has taken");
    rejects(good, {.default_reference = 0.1}, "outside of the range");
    rejects(good, {.step = 0.0}, "step");
}
