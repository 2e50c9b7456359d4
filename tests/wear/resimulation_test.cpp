#include "plant_sim/wear/resimulation.hpp"

#include <cmath>

#include "rig_bridge/wear/fit.hpp"
#include "tests/catch.hpp"
#include "tests/wear/physical_campaign.hpp"

namespace {

wear::Model fitted(const wear::Campaign& campaign) {
    wear::FitSettings settings;
    settings.max_components = 10;
    settings.starts = 5;
    return wear::model_of(campaign, wear::fit(campaign, settings), settings);
}

constexpr wear::ConditionalRule kMixture{wear::Variance::exact, wear::Choice::mixture};

}  // namespace

TEST_CASE("the campaign simulated again has its trend and scatter", "[WEAR-009]") {
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
            const double error = std::hypot(band.deviation_recorded, band.deviation_simulated) / std::sqrt(static_cast<double>(band.maneuvers));
            CHECK(std::abs(band.mean_error) < 4.0 * error);
        }
        CHECK(all == 500);
        // 90 % within 4 standard deviations of a share of 500.
        CHECK(c.coverage_90 > 0.9 - 4.0 * std::sqrt(0.09 / 500.0));
        CHECK(c.coverage_90 < 0.9 + 4.0 * std::sqrt(0.09 / 500.0));
        CHECK(c.ks_probability > 0.001);
    }
}

TEST_CASE("the measures notice a brake that is another", "[WEAR-009]") {
    const wear::Campaign recorded = physical::campaign(physical::laws()[0], 35);
    const wear::Campaign other = physical::campaign(physical::laws()[2], 35);
    const wear::Model model = fitted(other);
    const wear::Comparison c = wear::compare(recorded, wear::resimulated(recorded, model, kMixture, 1), model, kMixture);
    CHECK(c.coverage_90 < 0.8);
    CHECK(c.ks_probability < 0.001);
}

TEST_CASE("the two-sample probability is Kolmogorov's", "[WEAR-009]") {
    // Large samples: the table's quantiles 1.2238, 1.3581, 1.6276, 1.9495 at 10, 5, 1, 0.1 %.
    constexpr std::size_t kMany = 100'000'000;
    const double root = std::sqrt(kMany / 2.0);
    CHECK(wear::ks_probability(1.2238 / root, kMany, kMany) == Approx(0.10).epsilon(1e-3));
    CHECK(wear::ks_probability(1.3581 / root, kMany, kMany) == Approx(0.05).epsilon(1e-3));
    CHECK(wear::ks_probability(1.6276 / root, kMany, kMany) == Approx(0.01).epsilon(1e-3));
    CHECK(wear::ks_probability(1.9495 / root, kMany, kMany) == Approx(0.001).epsilon(1e-3));
    CHECK(wear::ks_probability(0.0, 10, 10) == 1.0);
}
