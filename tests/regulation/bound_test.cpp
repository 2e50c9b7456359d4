#include "plant_sim/study/regulation/bound.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/catch.hpp"

using regulation::Bound;
using regulation::BoundProblem;
using regulation::Pair;

namespace {

/// Two surfaces, two references, landings of 5 J or 10 J: brake and tyre lie on whole joules, so that the grid is exact.
BoundProblem small() {
    wear::SurfaceTable table{.reference = {0.2, 0.4}, .rows = {}};
    table.rows.push_back({"dry", {0.9, 0.9}, {0.2, 0.4}, {10.0, 13.0}});
    table.rows.push_back({"wet", {0.9, 0.9}, {0.2, 0.4}, {26.0, 20.0}});
    return {.table = table,
            .allowed = {{0.2, 0.4}, {0.2, 0.4}},
            .landing_J = {5.0, 10.0},
            .costs = {.brake_per_J = 1.0, .tyre_per_J = 0.9, .visit = 8.0, .metre = 0.3, .planned = {20.0, 7.0}},
            .begins = {{20.0, 7.0}, {17.0, 9.0}},
            .tyre_step_J = 1.0,
            .brake_step_J = 1.0};
}

/// By the tree of all landings, surfaces and references, without a grid: cost less `g` a landing.
double by_tree(const BoundProblem& p, const Pair& left, double g) {
    const auto of = [&](std::size_t surface, std::size_t a) {
        double cost = 0.0;
        const double share = p.table.rows[surface].tyre_share[a];
        for (const double landing_J : p.landing_J) {
            const double brake_J = (1.0 - share) * landing_J, tyre_J = share * landing_J;
            const double part = std::min({1.0, left.brake_J / brake_J, left.tyre_J / tyre_J});
            const Pair after{left.brake_J - part * brake_J, left.tyre_J - part * tyre_J};
            double one =
                part * (p.costs.brake_per_J * brake_J + p.costs.tyre_per_J * tyre_J + p.costs.metre * p.table.rows[surface].distance_m[a] - g);
            if (after.brake_J > 1e-9 && after.tyre_J > 1e-9) {
                one += by_tree(p, after, g);
            } else {
                const bool brake_is_left = after.brake_J > 1e-9;
                const double rest_J = std::max({after.brake_J, after.tyre_J, 0.0});
                const double thrown = rest_J * (brake_is_left ? p.costs.brake_per_J : p.costs.tyre_per_J);
                const double planned_J = brake_is_left ? p.costs.planned.brake_J : p.costs.planned.tyre_J;
                one += p.costs.visit + std::min(thrown, p.costs.visit * std::max(0.0, 1.0 - rest_J / planned_J));
            }
            cost += one / static_cast<double>(p.landing_J.size());
        }
        return cost;
    };
    if (!p.told) return std::min(0.5 * (of(0, 0) + of(1, 0)), 0.5 * (of(0, 1) + of(1, 1)));
    return 0.5 * std::min(of(0, 0), of(0, 1)) + 0.5 * std::min(of(1, 0), of(1, 1));
}

}  // namespace

TEST_CASE("the bound is what the tree of all choices gives", "[STUDY-169]") {
    for (const bool told : {true, false}) {
        BoundProblem problem = small();
        problem.told = told;
        const Bound bound(problem);
        double value = 0.0;
        for (const Pair& begin : problem.begins) value += by_tree(problem, begin, bound.per_landing());
        CHECK(std::abs(value) < 1e-6);
        CHECK(bound.landings() > 2.0);
        CHECK(bound.landings() < 6.0);
    }
    BoundProblem untold = small();
    untold.told = false;
    CHECK(Bound(small()).per_landing() < Bound(untold).per_landing());
}

TEST_CASE("what a policy loses, landing by landing, is how far its cost lies above the bound", "[STUDY-169]") {
    BoundProblem problem = small();
    problem.begins = {{60.0, 21.0}};
    problem.costs.planned = {60.0, 21.0};
    const Bound bound(problem);
    std::mt19937 generator(3);
    for (const bool best : {false, true}) {
        double cost = 0.0;
        double loss = 0.0;
        double landings = 0.0;
        double squares = 0.0;
        constexpr int kLives = 20000;
        for (int life = 0; life < kLives; ++life) {
            Pair left = problem.begins.front();
            const double before = cost - bound.per_landing() * landings - loss;
            while (left.brake_J > 0.0 && left.tyre_J > 0.0) {
                const std::size_t surface = generator() % 2U;
                const double reference = best ? bound.best(left, surface) : 0.2;
                loss += bound.loss(left, surface, reference);
                const double landing_J = problem.landing_J[generator() % 2U];
                const double part = std::min({1.0, left.brake_J / ((1.0 - reference) * landing_J), left.tyre_J / (reference * landing_J)});
                left = {std::max(0.0, left.brake_J - part * (1.0 - reference) * landing_J),
                        std::max(0.0, left.tyre_J - part * reference * landing_J)};
                cost += part * ((1.0 - reference) * landing_J + 0.9 * reference * landing_J +
                                0.3 * problem.table.at(problem.table.rows[surface].distance_m, reference));
                landings += part;
            }
            cost += problem.costs.at_limit(left);
            squares += std::pow(cost - bound.per_landing() * landings - loss - before, 2);
        }
        // Per life: the mean is 0, within four of its standard errors.
        const double off = (cost - bound.per_landing() * landings - loss) / kLives;
        CHECK(std::abs(off) < 4.0 * std::sqrt(squares / kLives / kLives));
        if (best)
            CHECK(std::abs(loss) < 1e-6);
        else
            CHECK(loss / landings > 0.1);
    }
}

TEST_CASE("with the shipped plan's surfaces and prices the grid is fine enough", "[STUDY-169][figures]") {
    const wear::RegulationConfig config = wear::load_regulation_config("config/regulation.toml");
    BoundProblem problem{.table = config.floor,
                         .allowed = {},
                         .landing_J = {3.4e6, 4.6e6, 8.3e6},
                         .costs = regulation::costs_of(config.prices, wear::plan_of(config, 3.9e9, 5.1e6, 1.9e6)),
                         .begins = {{0.25e9, 0.08e9}, {0.15e9, 0.10e9}}};
    for (const auto& row : config.floor.rows) problem.allowed.push_back(config.range_on(row.surface));
    BoundProblem fine = problem;
    fine.tyre_step_J = 0.10e9 / 1600.0;
    CHECK(Bound(problem).per_landing() == Approx(Bound(fine).per_landing()).epsilon(0.0005));
}

TEST_CASE("where nobody shares, each part pays for visits of its own", "[STUDY-169]") {
    // 1.0 + 8/20 a joule of brake, 0.9 + 8/7 of tyre, 7.5 J a landing.
    const double brake = 1.4, tyre = 0.9 + 8.0 / 7.0;
    const double dry = 0.3 * 10.0 + 7.5 * (0.8 * brake + 0.2 * tyre);
    const double wet = std::min(0.3 * 26.0 + 7.5 * (0.8 * brake + 0.2 * tyre), 0.3 * 20.0 + 7.5 * (0.6 * brake + 0.4 * tyre));
    CHECK(regulation::cost_unshared(small()) == Approx(0.5 * (dry + wet)));
}

TEST_CASE("a grid that a landing does not cross is refused", "[STUDY-169]") {
    BoundProblem problem = small();
    problem.brake_step_J = 4.0;
    CHECK_THROWS_AS(Bound(problem), std::invalid_argument);
}
