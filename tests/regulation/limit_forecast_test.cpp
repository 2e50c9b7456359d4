#include "rig_bridge/wear/limit_forecast.hpp"

#include <cmath>

#include "tests/catch.hpp"
#include "tests/regulation/toy_landing.hpp"

using wear::Feasibility;
using wear::LimitForecast;
using wear::Range;
using wear::Regulator;
using wear::Rules;

namespace {

constexpr Range kWholeRange{0.18, 0.38};

LimitForecast forecast_of(const wear::WearPlan& plan) {
    return wear::limit_forecast(Regulator(plan, Rules{}, kWholeRange));
}

/// Landing at which `life_J` is used up by landings of which `share` counts, over many lives: mean and deviation.
wear::When brute_force(double life_J, double share) {
    constexpr int kLives = 4000;
    toy::Landings landings({.offset = share, .slope = 0.0, .noise = 0.0}, 77);
    double sum = 0.0;
    double squares = 0.0;
    for (int life = 0; life < kLives; ++life) {
        double used_J = 0.0;
        int n = 0;
        while (used_J < life_J) {
            used_J += landings.next(0.24).tyre_J;
            ++n;
        }
        sum += n;
        squares += static_cast<double>(n) * n;
    }
    const double mean = sum / kLives;
    return {mean, std::sqrt(squares / kLives - mean * mean)};
}

}  // namespace

TEST_CASE("what will happen is said: feasible, early, late, which limit comes first", "[STUDY-167]") {
    const wear::WearPlan good = toy::plan(250, 0.3);
    CHECK(forecast_of(good).verdict == Feasibility::together);
    CHECK(forecast_of(toy::plan(250, 0.3, 0.9 * toy::Landings::kMean_J)).verdict == Feasibility::early);
    CHECK(forecast_of(toy::plan(250, 0.3, 1.1 * toy::Landings::kMean_J)).verdict == Feasibility::late);
    CHECK(forecast_of(toy::plan(250, 0.45)).verdict == Feasibility::brake_first);
    CHECK(forecast_of(toy::plan(250, 0.10)).verdict == Feasibility::tyre_first);
    CHECK_THAT(sentence(forecast_of(good), good), ContainsSubstring("feasible: both limits near landing 250"));
    CHECK_THAT(sentence(forecast_of(toy::plan(250, 0.10)), good), ContainsSubstring("not feasible") && ContainsSubstring("tyre's limit comes first"));
}

TEST_CASE("the landings at which limits come are those of many lives", "[STUDY-167]") {
    const wear::WearPlan plan = toy::plan(250, 0.5);  // out of reach: the brake comes first
    const LimitForecast o = forecast_of(plan);
    REQUIRE(o.verdict == Feasibility::brake_first);
    const wear::When brake = brute_force(plan.brake_life_J, 1.0 - kWholeRange.highest);
    const wear::When tyre = brute_force(plan.tyre_life_J, kWholeRange.highest);
    CHECK(o.brake.landing == Approx(brake.landing).epsilon(0.005));
    CHECK(o.brake.deviation == Approx(brake.deviation).epsilon(0.05));
    CHECK(o.tyre.landing == Approx(tyre.landing).epsilon(0.005));
    CHECK(o.tyre.deviation == Approx(tyre.deviation).epsilon(0.05));
}

TEST_CASE("the chance that the landings bring the planned energy is that of many lives", "[STUDY-167]") {
    const LimitForecast o = forecast_of(toy::plan(250, 0.3));
    toy::Landings landings({}, 5);
    constexpr int kLives = 4000;
    int within = 0;
    for (int life = 0; life < kLives; ++life) {
        double sum_J = 0.0;
        for (int i = 0; i < 250; ++i) sum_J += landings.next(0.24).kinetic_J;
        if (std::abs(sum_J / (250.0 * toy::Landings::kMean_J) - 1.0) <= 0.02) ++within;
    }
    CHECK(o.probability == Approx(static_cast<double>(within) / kLives).margin(0.025));
}

TEST_CASE("nothing left is said", "[STUDY-167]") {
    Regulator regulator(toy::plan(10, 0.3), Rules{}, kWholeRange);
    regulator.spent(0.0, 1e9);
    CHECK(wear::limit_forecast(regulator).verdict == Feasibility::reached);
    CHECK(regulator.tyre_left_J() == 0.0);
}
