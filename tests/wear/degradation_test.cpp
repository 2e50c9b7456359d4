#include "plant_sim/wear/degradation.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

#include "plant_sim/wear/resimulation.hpp"
#include "tests/catch.hpp"
#include "tests/wear/kolmogorov.hpp"
#include "tests/wear/physical_campaign.hpp"

namespace {

wear::Model fitted(const wear::Campaign& campaign) {
    wear::FitSettings settings;
    settings.most_components = 10;
    settings.starts = 5;
    return wear::model_of(campaign, wear::fit(campaign, settings), settings);
}

constexpr wear::ConditionalRule kMixture{wear::Variance::exact, wear::Choice::mixture};

}  // namespace

TEST_CASE("friction of the next maneuver is drawn at the energy taken so far, for each maneuver anew",
          "[WEAR-020]") {
    const wear::Model model = fitted(physical::campaign({}, 31));
    wear::Degradation brake(model, kMixture, {5, 0, 100e6});
    CHECK(brake.next_friction() == brake.next_friction());
    const double before = brake.next_friction();
    brake.take(0.0);
    CHECK(brake.next_friction() != before);
    brake.take(0.975e6);
    CHECK(brake.state() == wear::BrakeState{5, 2, 100.975e6});
    // Draws over many seeds have the model's conditional distribution.
    std::vector<double> draws;
    draws.reserve(3000);
    for (std::uint64_t seed = 0; seed < 3000; ++seed)
        draws.push_back(wear::Degradation(model, kMixture, {seed, 7, 100e6}).next_friction());
    const wear::Conditional c = wear::friction_given_energy(model, 100e6, kMixture);
    CHECK(kolmogorov::distance(draws, [&](double x) { return c.cumulative(x); }) <
          kolmogorov::bound_at_0_001(draws.size()));
}

TEST_CASE("a brake that was put down and taken up again goes on as if it had not been", "[WEAR-020]") {
    const wear::Model model = fitted(physical::campaign({}, 32));
    wear::Degradation whole(model, {}, {9, 0, 0.0});
    wear::BrakeState kept = whole.state();
    for (int i = 0; i < 50; ++i) {
        wear::Degradation resumed(model, {}, kept);
        CHECK(resumed.next_friction() == whole.next_friction());
        whole.take(1e6);
        resumed.take(1e6);
        kept = resumed.state();
    }
    CHECK(kept == whole.state());
}

TEST_CASE("worn far beyond the data the brake says so, and keeps some friction", "[WEAR-020]") {
    const wear::Model model = fitted(physical::campaign({}, 33));
    wear::Degradation brake(model, {}, {1, 0, model.data.last_c_e_J});
    CHECK_FALSE(brake.extrapolates());
    brake.take(1e9);
    CHECK(brake.extrapolates());
    CHECK(brake.next_friction() >= wear::Degradation::kLeastFriction);
    CHECK_THROWS_AS(brake.take(-1.0), std::invalid_argument);
    CHECK_THROWS_AS(brake.take(std::nan("")), std::invalid_argument);
    CHECK_THROWS_AS(wear::Degradation(model, {}, {1, 0, -1.0}), std::invalid_argument);
}

TEST_CASE("the campaign simulated again has its trend and scatter", "[WEAR-021]") {
    for (const physical::BrakeLaw& law : physical::laws()) {
        const wear::Campaign recorded = physical::campaign(law, 34);
        const wear::Model model = fitted(recorded);
        const wear::Campaign simulated = wear::resimulated(recorded, model, kMixture, 1);
        REQUIRE(simulated.points.size() == recorded.points.size());
        CHECK(simulated == wear::resimulated(recorded, model, kMixture, 1));
        CHECK(simulated.points != wear::resimulated(recorded, model, kMixture, 2).points);
        const wear::Comparison c = wear::compare(recorded, simulated, model, kMixture);
        std::size_t all = 0;
        for (const wear::EnergyBand& band : c.bands) {
            all += band.maneuvers;
            CAPTURE(band.from_J, band.mean_error, band.deviation_recorded, band.deviation_simulated);
            // Four standard errors of the difference of two means; draws are made one maneuver early in energy.
            const double error = std::hypot(band.deviation_recorded, band.deviation_simulated) /
                                 std::sqrt(static_cast<double>(band.maneuvers));
            CHECK(std::abs(band.mean_error) < 4.0 * error);
        }
        CHECK(all == 500);
        // 90 % within 4 standard deviations of a share of 500.
        CHECK(c.coverage_90 > 0.9 - 4.0 * std::sqrt(0.09 / 500.0));
        CHECK(c.coverage_90 < 0.9 + 4.0 * std::sqrt(0.09 / 500.0));
        CHECK(c.ks_probability > 0.001);
    }
}

TEST_CASE("the measures notice a brake that is another", "[WEAR-021]") {
    const wear::Campaign recorded = physical::campaign(physical::laws()[0], 35);
    const wear::Campaign other = physical::campaign(physical::laws()[2], 35);
    const wear::Model model = fitted(other);
    const wear::Comparison c =
        wear::compare(recorded, wear::resimulated(recorded, model, kMixture, 1), model, kMixture);
    CHECK(c.coverage_90 < 0.8);
    CHECK(c.ks_probability < 0.001);
}

TEST_CASE("the two-sample probability is Kolmogorov's", "[WEAR-021]") {
    // Large samples: the table's quantiles 1.2238, 1.3581, 1.6276, 1.9495 at 10, 5, 1, 0.1 %.
    constexpr std::size_t kMany = 100'000'000;
    const double root = std::sqrt(kMany / 2.0);
    CHECK(wear::ks_probability(1.2238 / root, kMany, kMany) == Approx(0.10).epsilon(1e-3));
    CHECK(wear::ks_probability(1.3581 / root, kMany, kMany) == Approx(0.05).epsilon(1e-3));
    CHECK(wear::ks_probability(1.6276 / root, kMany, kMany) == Approx(0.01).epsilon(1e-3));
    CHECK(wear::ks_probability(1.9495 / root, kMany, kMany) == Approx(0.001).epsilon(1e-3));
    CHECK(wear::ks_probability(0.0, 10, 10) == 1.0);
}
