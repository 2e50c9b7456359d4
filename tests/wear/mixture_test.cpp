#include "rig_bridge/wear/mixture.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "rig_bridge/wear/conditional.hpp"
#include "tests/catch.hpp"
#include "tests/wear/known_mixture.hpp"
#include "tests/wear/kolmogorov.hpp"

namespace {

using wear::Component;
using wear::Mixture;
using wear::Point;

double normal_cdf(double x, double mean, double variance) {
    return 0.5 * std::erfc((mean - x) / std::sqrt(2.0 * variance));
}

/// Eq. (10) as printed: inverse and determinant of the 2 x 2 matrix.
double printed_density(const Mixture& mixture, const Point& x) {
    double sum = 0.0;
    for (const Component& c : mixture.components()) {
        const double det = c.variance_c_e_J2 * c.variance_friction - c.covariance_J * c.covariance_J;
        const double dc = x.c_e_J - c.mean_c_e_J;
        const double dm = x.mean_friction - c.mean_friction;
        const double q = (c.variance_friction * dc * dc - 2.0 * c.covariance_J * dc * dm + c.variance_c_e_J2 * dm * dm) / det;
        sum += c.weight * std::exp(-0.5 * q) / std::sqrt(std::pow(2.0 * std::numbers::pi, 2) * det);
    }
    return sum;
}

/// Mean and variance of mu given a, and the marginal density of a, from the joint density alone (Simpson's rule).
struct Integrated {
    double mass = 0.0, mean = 0.0, variance = 0.0;
};
Integrated integrated(const Mixture& mixture, double a_J) {
    constexpr int kSteps = 40000;
    constexpr double kLow = -0.2;
    constexpr double kHigh = 0.8;
    constexpr double h = (kHigh - kLow) / kSteps;
    double m0 = 0.0;
    double m1 = 0.0;
    double m2 = 0.0;
    for (int i = 0; i <= kSteps; ++i) {
        const double mu = kLow + h * i;
        const double simpson = (i == 0 || i == kSteps ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0)) * h / 3.0;
        const double p = simpson * printed_density(mixture, {a_J, mu});
        m0 += p;
        m1 += p * mu;
        m2 += p * mu * mu;
    }
    return {m0, m1 / m0, m2 / m0 - m1 / m0 * (m1 / m0)};
}

}  // namespace

TEST_CASE("density and log-likelihood are eq. (10) and (13)", "[WEAR-003]") {
    const Mixture mixture = known::four();
    wear::Generator generator = wear::generator_of(1, 1);
    std::vector<Point> points;
    double expected = 0.0;
    for (int i = 0; i < 500; ++i) {
        const Point p{wear::uniform(generator) * 500e6, 0.18 + 0.15 * wear::uniform(generator)};
        const double density = printed_density(mixture, p);
        CHECK(mixture.density(p) == Approx(density).epsilon(1e-9));
        if (density > 1e-300) {
            points.push_back(p);
            expected += std::log(density);
        }
    }
    REQUIRE(points.size() > 300);
    CHECK(mixture.log_likelihood(points) == Approx(expected).epsilon(1e-11));
    // Where the density itself is below the least double its logarithm is not.
    CHECK(std::isfinite(mixture.log_density({5e9, 3.0})));
    CHECK(mixture.density({5e9, 3.0}) == 0.0);
}

TEST_CASE("a mixture that is none is refused", "[WEAR-003]") {
    const Component good = known::component(1.0, 100.0, 10.0, 0.3, 0.01, -0.5);
    const auto rejected = [&](auto spoil) {
        Component c = good;
        spoil(c);
        CHECK_THROWS_AS(Mixture({c}), std::invalid_argument);
    };
    CHECK_NOTHROW(Mixture({good}));
    CHECK_THROWS_AS(Mixture(std::vector<Component>{}), std::invalid_argument);
    rejected([](Component& c) { c.weight = 0.9; });
    rejected([](Component& c) { c.weight = 0.0; });
    rejected([](Component& c) { c.mean_friction = std::nan(""); });
    rejected([](Component& c) { c.variance_friction = 0.0; });
    rejected([](Component& c) { c.covariance_J = std::sqrt(c.variance_c_e_J2 * c.variance_friction) * 1.001; });
}

TEST_CASE("BIC counts 6 M - 1 parameters", "[WEAR-003]") {
    CHECK(wear::parameters_of(1) == 5);
    CHECK(wear::parameters_of(4) == 23);
    CHECK(wear::bic(-1000.0, 4, 500) == Approx(2000.0 + 23.0 * 6.214608098422191));
}

TEST_CASE("the exact conditional agrees with numerical integration of the joint density", "[WEAR-009]") {
    const Mixture mixture = known::four();
    for (const double a_MJ : {0.0, 15.0, 60.0, 100.0, 220.0, 225.0, 300.0, 430.0, 440.0, 490.0}) {
        const Integrated truth = integrated(mixture, a_MJ * 1e6);
        const wear::Conditional c = wear::friction_given_energy(mixture, a_MJ * 1e6, {wear::Variance::exact, wear::Choice::mixture});
        INFO(a_MJ << " MJ");
        CHECK(c.mean() == Approx(truth.mean).epsilon(1e-8));
        CHECK(c.variance() == Approx(truth.variance).epsilon(1e-6));
    }
}

TEST_CASE("for one component eq. (14) with 1 - rho^2 is exact, the printed 1 - rho is not", "[WEAR-009]") {
    for (const double rho : {-0.95, -0.5, 0.0, 0.3, 0.9}) {
        const Mixture one({known::component(1.0, 200.0, 50.0, 0.25, 0.01, rho)});
        const double a_J = 260e6;
        const Integrated truth = integrated(one, a_J);
        const wear::Conditional exact = wear::friction_given_energy(one, a_J, {wear::Variance::exact, wear::Choice::nearest});
        const wear::Conditional printed = wear::friction_given_energy(one, a_J, {wear::Variance::printed, wear::Choice::nearest});
        CHECK(exact.mean() == Approx(truth.mean).epsilon(1e-9));
        CHECK(exact.variance() == Approx(truth.variance).epsilon(1e-7));
        CHECK(exact.mean() == Approx(0.25 + 0.01 / 50e6 * rho * 60e6));
        CHECK(printed.mean() == exact.mean());
        CHECK(printed.variance() == Approx((1.0 - rho) * 1e-4));
    }
}

TEST_CASE("nearest asks the component whose mean is nearest in energy, mixture all of them", "[WEAR-009]") {
    const Mixture mixture = known::four();
    const auto nearest = [&](double a_MJ) {
        return wear::friction_given_energy(mixture, a_MJ * 1e6, {wear::Variance::exact, wear::Choice::nearest});
    };
    REQUIRE(nearest(224.0).terms.size() == 1);
    // Between 130 and 320 MJ the middle is 225 MJ, however wide the components are.
    CHECK(nearest(224.9).mean() == Approx(0.262 - 0.70 * 0.006 / 40.0 * 94.9));
    CHECK(nearest(225.1).mean() == Approx(0.240 + 0.60 * 0.005 / 60.0 * 94.9));
    const wear::Conditional all = wear::friction_given_energy(mixture, 224.9e6, {wear::Variance::exact, wear::Choice::mixture});
    double weights = 0.0;
    for (const auto& term : all.terms) weights += term.weight;
    CHECK(weights == Approx(1.0));
    CHECK(all.terms.size() > 1);
}

TEST_CASE("samples reproduce the mixture", "[WEAR-003]") {
    // Each comparison fails with a probability of 0.001 for a right sampler; the seeds are fixed.
    const Mixture mixture = known::four();
    constexpr std::size_t kCount = 40000;
    wear::Generator generator = wear::generator_of(20, 0);
    std::vector<double> energy;
    std::vector<double> friction;
    std::vector<double> conditional;
    for (std::size_t i = 0; i < kCount; ++i) {
        const Point p = mixture.sample(generator);
        energy.push_back(p.c_e_J);
        friction.push_back(p.mean_friction);
        // If energy and friction belong together, friction's place in its conditional distribution is uniform.
        conditional.push_back(
            wear::friction_given_energy(mixture, p.c_e_J, {wear::Variance::exact, wear::Choice::mixture}).cumulative(p.mean_friction));
    }
    const auto marginal = [&](auto of) {
        return [&mixture, of](double x) {
            double sum = 0.0;
            for (const Component& c : mixture.components()) sum += of(c, x);
            return sum;
        };
    };
    const double bound = kolmogorov::bound_at_0_001(kCount);
    CHECK(kolmogorov::distance(
              energy, marginal([](const Component& c, double x) { return c.weight * normal_cdf(x, c.mean_c_e_J, c.variance_c_e_J2); })) < bound);
    CHECK(kolmogorov::distance(friction, marginal([](const Component& c, double x) {
                                   return c.weight * normal_cdf(x, c.mean_friction, c.variance_friction);
                               })) < bound);
    CHECK(kolmogorov::distance(conditional, [](double u) { return u; }) < bound);
    // The same comparison notices a correlation of the wrong sign.
    std::vector<Component> wrong = mixture.components();
    wrong[2].covariance_J = -wrong[2].covariance_J;
    std::vector<double> off;
    wear::Generator again = wear::generator_of(20, 0);
    for (std::size_t i = 0; i < kCount; ++i) {
        const Point p = mixture.sample(again);
        off.push_back(
            wear::friction_given_energy(Mixture(wrong), p.c_e_J, {wear::Variance::exact, wear::Choice::mixture}).cumulative(p.mean_friction));
    }
    CHECK(kolmogorov::distance(off, [](double u) { return u; }) > bound);
}

TEST_CASE("draws of the conditional have its distribution", "[WEAR-003]") {
    const Mixture mixture = known::four();
    for (const auto& rule :
         {wear::ConditionalRule{wear::Variance::exact, wear::Choice::mixture}, wear::ConditionalRule{wear::Variance::exact, wear::Choice::nearest},
          wear::ConditionalRule{wear::Variance::printed, wear::Choice::nearest}}) {
        const wear::Conditional c = wear::friction_given_energy(mixture, 60e6, rule);
        wear::Generator generator = wear::generator_of(21, 0);
        std::vector<double> draws;
        draws.reserve(20000);
        for (int i = 0; i < 20000; ++i) draws.push_back(c.sample(generator));
        CHECK(kolmogorov::distance(draws, [&](double x) { return c.cumulative(x); }) < kolmogorov::bound_at_0_001(draws.size()));
    }
}
