#include "plant_sim/wear/arena.hpp"

#include <cmath>
#include <numbers>

#include "tests/catch.hpp"

namespace {

using namespace wear::arena;

Plan small_plan(unsigned threads) {
    Plan plan;
    plan.settings = load_settings("config/wear_arena.toml");
    plan.settings.life_landings = 80.0;
    plan.laws = {Law::archard, Law::glazing};
    plan.judged_seed = plan.settings.tuning;
    plan.training_lives = 3;
    plan.judged_lives = 4;
    plan.threads = threads;
    return plan;
}

}  // namespace

TEST_CASE("every law wears a brake out, in a life that scatters about the mean", "[WEAR-070]") {
    const Settings settings = load_settings("config/wear_arena.toml");
    for (std::size_t i = 0; i < kLawNames.size(); ++i) {
        double sum = 0.0;
        for (std::uint64_t seed = 0; seed < 20; ++seed) sum += static_cast<double>(live(static_cast<Law>(i), settings, seed).landings());
        INFO(kLawNames.at(i) << ": " << sum / 20.0);
        CHECK(sum / 20.0 > 0.5 * settings.life_landings);
        CHECK(sum / 20.0 < 1.5 * settings.life_landings);
    }
}

TEST_CASE("nobody is better than the oracle, whatever the number of threads", "[WEAR-070]") {
    const Result one = run(small_plan(1)), two = run(small_plan(2));
    const auto& oracle = one.within.at(static_cast<std::size_t>(Method::oracle));
    for (std::size_t e = 0; e < one.within.size(); ++e) {
        INFO(kMethodNames.at(e));
        CHECK(one.within.at(e).crps >= oracle.crps);
        CHECK(one.within.at(e).crps == two.within.at(e).crps);
        CHECK(one.across.value().at(e).crps == two.across.value().at(e).crps);
        for (std::size_t k = 0; k < kTenths; ++k) CHECK(one.within.at(e).left.at(k).crps == two.within.at(e).left.at(k).crps);
    }
}

TEST_CASE("across laws what is shipped loses less than the filter alone, and holds more", "[WEAR-070][WEAR-072]") {
    Plan plan = small_plan(2);
    plan.laws = {Law::archard, Law::oxidation};
    plan.training_lives = 6;
    const Result result = run(plan);
    const auto sum = [&](Method e, double LeftScore::*value) {
        double all = 0.0;
        for (const LeftScore& left : result.across.value().at(static_cast<std::size_t>(e)).left) all += left.*value / kTenths;
        return all;
    };
    CHECK(sum(Method::shipped, &LeftScore::crps) < sum(Method::filter, &LeftScore::crps));
    CHECK(sum(Method::shipped, &LeftScore::held) > sum(Method::filter, &LeftScore::held));
    CHECK(sum(Method::past_lives, &LeftScore::skill) == 0.0);
    CHECK(sum(Method::oracle, &LeftScore::skill) == Approx(1.0));
    CHECK(result.within_by_law.size() == 2);
    // Readings of the lining help on any law, to who forecasts by friction and to who has only past lives.
    CHECK(sum(Method::shipped_read, &LeftScore::crps) < sum(Method::shipped, &LeftScore::crps));
    CHECK(sum(Method::past_lives_read, &LeftScore::crps) < sum(Method::past_lives, &LeftScore::crps));
}

TEST_CASE("scores of who knows the truth are those of a normal distribution in closed form", "[WEAR-070]") {
    Plan plan = small_plan(2);
    plan.judged_lives = 12;
    const Result result = run(plan);
    const Score& oracle = result.within.at(static_cast<std::size_t>(Method::oracle));
    CHECK(oracle.crps == Approx(Brake::kFresh / std::sqrt(std::numbers::pi)).epsilon(0.05));
    CHECK(oracle.log_score == Approx(0.5 * std::log(2.0 * std::numbers::pi * std::numbers::e) + std::log(Brake::kFresh)).margin(0.05));
    CHECK(oracle.pit < 0.04);  // 1.63 over the root of some 1,900 readings: 1 of 100
    double held = 0.0;
    for (const LeftScore& left : oracle.left) held += left.held / kTenths;
    CHECK(held > 0.7);
    CHECK(held < 0.9);
}
