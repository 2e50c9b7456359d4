#include "rig_bridge/wear/order_score.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "rig_bridge/wear/conditional.hpp"
#include "rig_bridge/wear/on_threads.hpp"
#include "tests/catch.hpp"
#include "tests/wear/known_mixture.hpp"
#include "tests/wear/physical_campaign.hpp"
#include "tests/wear/small_fit.hpp"

namespace {

wear::Fit scored(const wear::Campaign& campaign, std::size_t max, int starts, unsigned threads = 1) {
    wear::Fit fit = wear::fit(campaign, small(max, starts));
    const std::vector<double> scores = wear::blocked_scores(campaign, fit.orders, {}, threads);
    for (std::size_t i = 0; i < scores.size(); ++i) fit.orders[i].score = scores[i];
    return fit;
}

/// log N(y; a + b x, s^2) of the points of each fold by a straight line through the others, summed.
double score_of_a_line(const std::vector<wear::Point>& points) {
    double sum = 0.0;
    for (std::size_t fold = 0; fold < wear::kScoreFolds; ++fold) {
        const auto left_out = [&](std::size_t i) { return i / wear::kScoreBlock % wear::kScoreFolds == fold; };
        double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (left_out(i)) continue;
            const double u = points[i].c_e_J * 1e-8, v = points[i].mean_friction;
            n += 1.0;
            x += u;
            y += v;
            xx += u * u;
            xy += u * v;
            yy += v * v;
        }
        const double slope = (n * xy - x * y) / (n * xx - x * x), level = (y - slope * x) / n;
        const double variance = (yy - level * y - slope * xy) / n;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!left_out(i)) continue;
            const double off = points[i].mean_friction - level - slope * points[i].c_e_J * 1e-8;
            sum += -0.5 * off * off / variance - 0.5 * std::log(2.0 * std::numbers::pi * variance);
        }
    }
    return sum / static_cast<double>(points.size());
}

/// Mean of log p(mean mu_b | c_e), by the conditional distribution that draws are made from.
double score_on(const wear::Campaign& campaign, const wear::Mixture& mixture) {
    double sum = 0.0;
    for (const wear::Point& x : campaign.points) {
        double density = 0.0;
        for (const auto& t : wear::friction_given_energy(mixture, x.c_e_J).terms)
            density += t.weight * std::exp(-0.5 * (x.mean_friction - t.mean) * (x.mean_friction - t.mean) / t.variance) /
                       std::sqrt(2.0 * std::numbers::pi * t.variance);
        sum += std::log(density);
    }
    return sum / static_cast<double>(campaign.points.size());
}

}  // namespace

TEST_CASE("the score of one component is that of a straight line through the other blocks", "[WEAR-003]") {
    const wear::Campaign campaign = physical::campaign(physical::laws().front(), 7);
    const wear::Fit fit = scored(campaign, 1, 1);
    CHECK(fit.orders[0].score.value() == Approx(score_of_a_line(campaign.points)).epsilon(1e-6));
}

TEST_CASE("scores are the same bytes on any number of threads, and no mixture beats the one that made the data", "[WEAR-003]") {
    wear::Generator generator = wear::generator_of(5, 0);
    const wear::Campaign campaign = known::drawn(known::four(), 1000, generator);
    const wear::Fit one = scored(campaign, 6, 5), three = scored(campaign, 6, 5, 3);
    for (std::size_t i = 0; i < one.orders.size(); ++i) CHECK(one.orders[i].score == three.orders[i].score);
    CHECK(*one.orders[3].score > *one.orders[0].score + 0.2);
    const double conditional = score_on(campaign, known::four());
    for (const wear::OrderFit& o : one.orders) CHECK(*o.score < conditional + 0.01);
    CHECK(*one.orders[3].score > conditional - 0.05);
}

TEST_CASE("the greatest score chooses; too short a campaign has none, and says so", "[WEAR-003]") {
    const wear::Fit fit = scored(physical::campaign(physical::laws().front(), 7), 4, 3);
    const std::size_t best = wear::greatest_score(fit.orders);
    for (const wear::OrderFit& o : fit.orders) CHECK(o.score <= fit.orders[best].score);
    const wear::Fit short_one = scored(physical::campaign({}, 7, nullptr, 99), 2, 2);
    CHECK_FALSE(short_one.orders[0].score);
    CHECK_THROWS_WITH(wear::greatest_score(short_one.orders), ContainsSubstring("it takes 100 maneuvers"));
}

TEST_CASE("prints what BIC and score choose, and how that does on another campaign of the brake", "[.choice]") {
    std::vector<physical::BrakeLaw> laws = physical::laws();
    laws.push_back(physical::shipped_law());
    fmt::print("law seed  BIC: M, score on the other  score: M, score on the other\n");
    for (std::size_t law = 0; law < laws.size(); ++law) {
        for (std::uint64_t seed = 31; seed < 35; ++seed) {
            const wear::Fit fit = scored(physical::campaign(laws[law], seed), 15, 100, wear::all_cores());
            const wear::Campaign other = physical::campaign(laws[law], 1000 + seed);
            const wear::OrderFit& by_score = fit.orders[wear::greatest_score(fit.orders)];
            fmt::print("{:3} {:4} {:7} {:10.4f} {:12} {:10.4f}\n", law, seed, fit.best().components, score_on(other, fit.best().mixture),
                       by_score.components, score_on(other, by_score.mixture));
        }
    }
}
