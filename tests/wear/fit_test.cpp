#include "rig_bridge/wear/fit.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "rig_bridge/wear/fast_exp.hpp"
#include "rig_bridge/wear/fit_starts.hpp"
#include "rig_bridge/wear/model.hpp"
#include "tests/catch.hpp"
#include "tests/wear/known_mixture.hpp"
#include "tests/wear/physical_campaign.hpp"
#include "tests/wear/small_fit.hpp"

namespace {

wear::StandardPoints standard_points(const wear::Campaign& campaign) {
    std::vector<double> x;
    std::vector<double> y;
    for (const wear::Point& p : campaign.points) {
        x.push_back((p.c_e_J - 250e6) / 140e6);
        y.push_back((p.mean_friction - 0.24) / 0.02);
    }
    return {x, y};
}

struct Moments {
    double c_mean = 0.0, mu_mean = 0.0, c_deviation = 0.0, mu_deviation = 0.0;
};

Moments moments_of(const wear::Campaign& campaign) {
    const auto n = static_cast<double>(campaign.points.size());
    Moments m;
    for (const wear::Point& p : campaign.points) {
        m.c_mean += p.c_e_J / n;
        m.mu_mean += p.mean_friction / n;
    }
    for (const wear::Point& p : campaign.points) {
        m.c_deviation += (p.c_e_J - m.c_mean) * (p.c_e_J - m.c_mean) / n;
        m.mu_deviation += (p.mean_friction - m.mu_mean) * (p.mean_friction - m.mu_mean) / n;
    }
    m.c_deviation = std::sqrt(m.c_deviation);
    m.mu_deviation = std::sqrt(m.mu_deviation);
    return m;
}

/// As fit() does it.
wear::StandardPoints standardised(const wear::Campaign& campaign) {
    const Moments m = moments_of(campaign);
    std::vector<double> x;
    std::vector<double> y;
    for (const wear::Point& p : campaign.points) {
        x.push_back((p.c_e_J - m.c_mean) / m.c_deviation);
        y.push_back((p.mean_friction - m.mu_mean) / m.mu_deviation);
    }
    return {x, y};
}

double standard_scale(const wear::Campaign& campaign) {
    const Moments m = moments_of(campaign);
    return m.c_deviation * m.mu_deviation;
}

}  // namespace

TEST_CASE("the search's exp is exact to 2 units in the last place", "[WEAR-003]") {
    const auto error = [](double x) {
        const long double truth = std::exp(static_cast<long double>(x));
        return static_cast<double>(std::fabs((wear::exp_not_positive(x) - truth) / truth));
    };
    double greatest = 0.0;
    wear::Generator generator = wear::generator_of(4, 0);
    for (int i = 0; i < 300000; ++i) greatest = std::max(greatest, error(-708.0 * wear::uniform(generator)));
    for (int i = 0; i < 300000; ++i) greatest = std::max(greatest, error(-2.0 * wear::uniform(generator)));
    // Where the nearest multiple of ln 2 changes the reduced argument is largest.
    for (int k = 0; k < 1000; ++k) {
        const double edge = -(k + 0.5) * 0.6931471805599453;
        for (const double x : {std::nextafter(edge, -1e9), edge, std::nextafter(edge, 0.0)})
            greatest = std::max(greatest, error(std::max(x, -708.0)));
    }
    CHECK(greatest < 4.5e-16);
    CHECK(wear::exp_not_positive(0.0) == 1.0);
    CHECK(wear::exp_not_positive(-1e300) < 3.4e-308);
    CHECK(wear::exp_not_positive(-1e300) > 0.0);
}

TEST_CASE("the log-likelihood of EM never falls, and is that of the mixture it ends with", "[WEAR-003]") {
    int refused = 0;
    for (const physical::BrakeLaw& law : physical::laws()) {
        const wear::StandardPoints points = standard_points(physical::campaign(law, 3));
        for (const double floor : {1e-6, 1e-4, 1e-2}) {
            for (std::size_t m = 1; m <= wear::kMaxComponents; m += 2) {
                wear::Generator generator = wear::generator_of(5, m);
                double before = -1e300;
                double greatest_fall = 0.0;
                wear::EmSettings settings;
                settings.covariance_floor = floor;
                const wear::EmRun run = wear::em(points, wear::random_start(points, m, 0, floor, generator), settings, [&](double now) {
                    greatest_fall = std::max(greatest_fall, before - now);
                    before = now;
                });
                INFO(m << " components, floor " << floor);
                CHECK(run.converged);
                refused += run.refused;
                // The first start is wider than the floor allows to be optimal; rounding is 1e-12 of some 1000.
                CHECK(greatest_fall < 1e-9);
                CHECK(wear::log_likelihood(points, run.mixture) >= run.log_likelihood - 1e-9);
            }
        }
    }
    // Extrapolations that lost were met, and left.
    CHECK(refused > 10);
}

TEST_CASE("extrapolation ends where single EM steps end, and sooner", "[WEAR-003]") {
    wear::Generator generator = wear::generator_of(7, 0);
    const wear::StandardPoints points = standard_points(known::drawn(known::four(), 300, generator));
    for (const std::size_t m : {2UL, 3UL, 4UL}) {
        wear::EmSettings settings;
        const wear::StandardMixture start = wear::random_start(points, m, 10, settings.covariance_floor, generator);
        settings.max_iterations = 1;
        wear::EmRun single{start, 0.0, 0, 0, false};
        int steps = 0;
        for (double before = -1e300; single.log_likelihood - before > 1e-13 && steps < 100000; ++steps) {
            before = steps == 0 ? -1e300 : single.log_likelihood;
            single = wear::em(points, single.mixture, settings);
        }
        settings.max_iterations = 100000;
        settings.tolerance = 1e-15;
        const wear::EmRun run = wear::em(points, start, settings);
        INFO(m << " components, " << steps << " single steps, " << run.iterations << " with extrapolation");
        CHECK(run.converged);
        CHECK(std::abs(run.log_likelihood - single.log_likelihood) < 1e-9);
        CHECK(run.iterations < steps);
        for (std::size_t j = 0; j < m; ++j) {
            for (const auto list : {&wear::StandardMixture::weight, &wear::StandardMixture::mx, &wear::StandardMixture::my,
                                    &wear::StandardMixture::xx, &wear::StandardMixture::xy, &wear::StandardMixture::yy})
                CHECK(std::abs((run.mixture.*list)[j] - (single.mixture.*list)[j]) < 1e-6);
        }
    }
}

TEST_CASE("the search is at least as good as EM carried to the end from each of 100 random starts", "[WEAR-003]") {
    const wear::Campaign campaign = physical::campaign(physical::laws()[3], 5);
    wear::FitSettings settings = small(6, 100);
    const wear::Fit fit = wear::fit(campaign, settings);
    const wear::StandardPoints points = standardised(campaign);
    const double per_point = std::log(standard_scale(campaign));
    for (std::size_t m = 1; m <= 6; ++m) {
        double greatest = -1e300;
        for (std::uint64_t start = 0; start < 100; ++start) {
            wear::Generator generator = wear::generator_of(8, 100 * m + start);
            const wear::StandardMixture from = wear::random_start(points, m, 10, settings.em.covariance_floor, generator);
            greatest = std::max(greatest, wear::em(points, from, settings.em).log_likelihood);
        }
        INFO(m << " components");
        CHECK(fit.orders[m - 1].log_likelihood + static_cast<double>(points.size()) * per_point > greatest - 1e-3);
    }
}

TEST_CASE("the log-likelihood of the search is that of eq. (13)", "[WEAR-003]") {
    // Two ways of computing it: in blocks of standardised points, and point by point in SI units.
    for (const std::size_t count : {12UL, 63UL, 64UL, 65UL, 500UL}) {
        wear::Generator generator = wear::generator_of(6, count);
        const wear::Campaign campaign = known::drawn(known::four(), count, generator);
        const wear::Fit fit = wear::fit(campaign, small(std::min<std::size_t>(count / 6, 5), 5));
        for (const wear::OrderFit& o : fit.orders) {
            INFO(count << " points, " << o.components << " components");
            // The last M step may still gain what the tolerance allows.
            const double direct = o.mixture.log_likelihood(campaign.points);
            CHECK(direct >= o.log_likelihood - 1e-6);
            CHECK(direct - o.log_likelihood < 2e-8 * std::abs(direct) + 1e-6);
        }
    }
}

TEST_CASE("one component is mean and covariance of the points", "[WEAR-003]") {
    const wear::Campaign campaign = physical::campaign({}, 1);
    const wear::Fit fit = wear::fit(campaign, small(1, 1));
    const wear::Component& c = fit.best().mixture.components()[0];
    const auto n = static_cast<double>(campaign.points.size());
    double mc = 0.0;
    double mm = 0.0;
    for (const wear::Point& p : campaign.points) {
        mc += p.c_e_J / n;
        mm += p.mean_friction / n;
    }
    double cc = 0.0;
    double cm = 0.0;
    double mumu = 0.0;
    for (const wear::Point& p : campaign.points) {
        cc += (p.c_e_J - mc) * (p.c_e_J - mc) / n;
        cm += (p.c_e_J - mc) * (p.mean_friction - mm) / n;
        mumu += (p.mean_friction - mm) * (p.mean_friction - mm) / n;
    }
    CHECK(c.weight == Approx(1.0));
    CHECK(c.mean_c_e_J == Approx(mc));
    CHECK(c.mean_friction == Approx(mm));
    CHECK(c.variance_c_e_J2 == Approx(cc));
    CHECK(c.covariance_J == Approx(cm));
    CHECK(c.variance_friction == Approx(mumu));
}

TEST_CASE("more components never explain less", "[WEAR-003]") {
    const wear::Fit fit = wear::fit(physical::campaign(physical::laws()[1], 2), small(15, 2));
    for (std::size_t i = 1; i < fit.orders.size(); ++i) CHECK(fit.orders[i].log_likelihood > fit.orders[i - 1].log_likelihood - 1e-3);
}

TEST_CASE("BIC finds the four components of a known mixture in nine of ten draws of 500 points", "[WEAR-003]") {
    // M up to 8 and 3 starts each (and the splits) to 1e-6, instead of 15, 100 and 1e-8.
    int four = 0;
    for (std::uint64_t seed = 1; seed <= std::uint64_t{DRAWS}; ++seed) {
        wear::Generator generator = wear::generator_of(seed, 99);
        wear::FitSettings settings = small(8, 3);
        settings.seed = seed;
        settings.em.tolerance = 1e-6;
        four += wear::fit(known::drawn(known::four(), 500, generator), settings).best().components == 4 ? 1 : 0;
    }
    CAPTURE(four);
    CHECK(10 * four >= 9 * DRAWS);
}

TEST_CASE("no component collapses onto points or a line", "[WEAR-003]") {
    // Half of the campaign lies on a straight line exactly, and friction takes few values.
    wear::Campaign campaign;
    campaign.source = "line";
    for (int i = 1; i <= 200; ++i) campaign.points.push_back({i * 1e6, i <= 100 ? 0.3 - 1e-4 * i : 0.25 + 0.01 * (i % 3)});
    for (const double floor : {1e-6, 1e-4}) {
        wear::FitSettings settings = small(15, 2);
        settings.em.tolerance = 1e-6;
        settings.em.covariance_floor = floor;
        const wear::Fit fit = wear::fit(campaign, settings);
        for (const wear::OrderFit& o : fit.orders) {
            REQUIRE(std::isfinite(o.log_likelihood));
            for (const wear::Component& c : o.mixture.components()) {
                // In standardised units the eigenvalues' sum and product bound the least one from below.
                const double xx = c.variance_c_e_J2 / 3.3332e15;
                double mean = 0.0;
                double yy = 0.0;
                for (const wear::Point& p : campaign.points) mean += p.mean_friction / 200.0;
                for (const wear::Point& p : campaign.points) yy += (p.mean_friction - mean) * (p.mean_friction - mean) / 200.0;
                const double det = (c.variance_c_e_J2 * c.variance_friction - c.covariance_J * c.covariance_J) / 3.3332e15 / yy;
                const double trace = xx + c.variance_friction / yy;
                const double min = 0.5 * trace - std::sqrt(std::max(0.0, 0.25 * trace * trace - det));
                CHECK(min > 0.99 * floor);
            }
        }
    }
}

TEST_CASE("a fit that the data do not bear is refused", "[WEAR-001]") {
    const wear::Campaign campaign = physical::campaign({}, 1);
    wear::Campaign few = campaign;
    few.points.resize(30);
    CHECK_THROWS_WITH(wear::fit(few, small(6, 1)), ContainsSubstring("30 maneuvers are too few for 6 components"));
    CHECK_THROWS_WITH(wear::fit(few, small(6, 1)), ContainsSubstring("at most 5 can be learnt"));
    CHECK_NOTHROW(wear::fit(few, small(5, 1)));
    wear::Campaign bad = campaign;
    bad.points[7].mean_friction = std::nan("");
    CHECK_THROWS_WITH(wear::fit(bad, small(2, 1)), ContainsSubstring("physical law:8: mean_friction"));
    CHECK_THROWS_AS(wear::fit(campaign, small(16, 1)), std::invalid_argument);
    CHECK_THROWS_AS(wear::fit(campaign, small(0, 1)), std::invalid_argument);
    CHECK_THROWS_AS(wear::fit(campaign, small(2, 0)), std::invalid_argument);
    CHECK_THROWS_AS(wear::fit(campaign, small(2, 1), {0, {}, {}}), std::invalid_argument);
}
