/// The search on several threads: what the thread sanitizer is to see. All that one thread does is in fit_test.cpp.
#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "rig_bridge/wear/fit.hpp"
#include "rig_bridge/wear/model_io.hpp"
#include "tests/catch.hpp"
#include "tests/wear/physical_campaign.hpp"
#include "tests/wear/small_fit.hpp"

TEST_CASE("the model is the same bytes whatever the number of threads, and another with another seed", "[WEAR-003]") {
    const wear::Campaign campaign = physical::campaign({}, 4);
    const auto bytes = [&](unsigned threads, std::uint64_t seed) {
        wear::FitSettings settings = small(6, 8);
        settings.seed = seed;
        const wear::Fit fit = wear::fit(campaign, settings, {threads, {}, {}});
        std::string all = wear::to_json(wear::model_of(campaign, fit, settings));
        for (const wear::OrderFit& o : fit.orders) {
            wear::Fit only{{o}, 0};
            all += wear::to_json(wear::model_of(campaign, only, settings));
        }
        return all;
    };
    const std::string one = bytes(1, 1);
    CHECK(bytes(2, 1) == one);
    CHECK(bytes(3, 1) == one);
    CHECK(bytes(8, 1) == one);
    CHECK(bytes(1, 2) != one);
}

TEST_CASE("a search tells how far it is, and ends when asked to", "[WEAR-003]") {
    const wear::Campaign campaign = physical::campaign({}, 1);
    std::vector<std::size_t> seen;
    std::size_t total = 0;
    (void)wear::fit(campaign, small(3, 5), {2, {}, [&](std::size_t done, std::size_t all) {
                                                seen.push_back(done);
                                                total = all;
                                            }});
    REQUIRE(seen.size() == total);
    for (std::size_t i = 0; i < seen.size(); ++i) CHECK(seen[i] == i + 1);

    std::stop_source stop;
    std::size_t runs = 0;
    CHECK_THROWS_AS(wear::fit(campaign, small(3, 50),
                              {2, stop.get_token(),
                               [&](std::size_t done, std::size_t) {
                                   runs = done;
                                   if (done == 10) stop.request_stop();
                               }}),
                    wear::Cancelled);
    CHECK(runs < 20);
}
