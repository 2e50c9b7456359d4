#include "rig_bridge/wear/lining_law.hpp"

#include <cmath>
#include <vector>

#include "rig_bridge/wear/load_brake_wear.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"

namespace {

using wear::LiningLaw;

/// What each maneuver's friction is off the law's own curve, in a run-in brake.
std::vector<double> scatter_of(const LiningLaw& law, std::uint64_t seed, std::uint64_t maneuvers) {
    std::vector<double> out;
    const double worn_J = 100.0e6;
    for (wear::LiningScatter scatter(seed, 0); out.size() < maneuvers; scatter.next())
        out.push_back(scatter.friction(law, worn_J) - wear::expected_friction(law, worn_J));
    return out;
}

double covariance(const std::vector<double>& x, std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < x.size(); ++i) sum += x[i] * x[i - lag];
    return sum / static_cast<double>(x.size() - lag);
}

const std::string kRig = content_of("config/flywheel_rig.toml");

wear::BrakeWear brake_of(const std::string& text) {
    return wear::load_brake_wear(parsed(text).root().table("brake").table("wear"), "config");
}

}  // namespace

TEST_CASE("a lining's friction runs in, wears in proportion and drops where the core is met", "[WEAR-009]") {
    const LiningLaw law{.plateau = 0.25, .run_in = 0.05, .run_in_J = 10e6, .loss = 0.03, .lining_J = 500e6, .core_loss = 0.04, .core_share = 0.1};
    CHECK(wear::expected_friction(law, 0.0) == Approx(0.30));
    CHECK(wear::expected_friction(law, 10e6) == Approx(0.25 + 0.025 - 0.03 * 0.02));        // half of what runs in
    CHECK(wear::expected_friction(law, 450e6) == Approx(0.25 - 0.027).margin(2e-4));        // the core begins
    CHECK(wear::expected_friction(law, 500e6) == Approx(0.25 - 0.03 - 0.04).margin(2e-4));  // used up
    for (double worn_J = 1e6; worn_J < 600e6; worn_J += 1e6) CHECK(wear::expected_friction(law, worn_J) < wear::expected_friction(law, worn_J - 1e6));
}

TEST_CASE("without play scatter is what is new and a temperature that remembers as much as it should", "[WEAR-009]") {
    const LiningLaw law{.per_temperature = -0.003, .memory = 0.7, .play = 0.0, .measurement = 0.002};
    const std::vector<double> scatter = scatter_of(law, 11, 20'000);
    // AR(1): covariances over k maneuvers are sigma^2 memory^k. Standard error of each about 2 %.
    CHECK(covariance(scatter, 0) == Approx(0.003 * 0.003 + 0.002 * 0.002).epsilon(0.06));
    for (const std::size_t k : {std::size_t{1}, std::size_t{2}, std::size_t{4}})
        CHECK(covariance(scatter, k) == Approx(0.003 * 0.003 * std::pow(0.7, static_cast<double>(k))).margin(0.06 * 0.003 * 0.003));
}

TEST_CASE("with play friction stands still until temperature has gone through it", "[WEAR-009]") {
    const std::vector<double> without = scatter_of({.play = 0.0, .measurement = 0.0}, 3, 5'000);
    const std::vector<double> with = scatter_of({.play = 0.8, .measurement = 0.0}, 3, 5'000);
    std::size_t unchanged = 0;
    for (std::size_t n = 0; n < with.size(); ++n) {
        CHECK(std::abs(with[n] - without[n]) <= 0.8 * 0.0035 + 1e-12);
        if (n > 0 && std::abs(with[n] - with[n - 1]) < 1e-6) ++unchanged;  // what is remembered begins elsewhere: 0.6^24 of a deviation
    }
    CHECK(unchanged > with.size() / 4);
    CHECK(unchanged < with.size() * 3 / 4);
}

TEST_CASE("a brake with a law wears by it, scaled; without one by its model", "[WEAR-009]") {
    wear::BrakeWear wear = brake_of(kRig);
    REQUIRE(wear.law);
    wear.scale = {.energy = 8.0, .friction = 1.2};
    for (std::uint64_t n = 0; n < 20; ++n)
        CHECK(wear::WearingBrake(wear, {}, {5, n, 800e6}).next_friction() == 1.2 * wear::LiningScatter(5, n).friction(*wear.law, 100e6));
    wear::WearingBrake goes_on(wear, {}, {5, 0, 0.0});
    for (std::uint64_t n = 0; n < 60; ++n) {
        CHECK(goes_on.next_friction() == wear::WearingBrake(wear, {}, goes_on.state()).next_friction());
        goes_on.take(1e6);
    }
    CHECK_FALSE(wear::WearingBrake(wear, {}, {5, 0, 1e12}).extrapolates());
    CHECK(wear::WearingBrake(wear, {}, {5, 0, 1e12}).next_friction() == wear::kMinFriction);
    const double by_law = wear::WearingBrake(wear, {}, {5, 7, 800e6}).next_friction();
    wear.law.reset();
    CHECK(wear::WearingBrake(wear, {}, {5, 7, 800e6}).next_friction() != by_law);
    CHECK(wear::WearingBrake(wear, {}, {5, 0, 1e12}).extrapolates());
}

TEST_CASE("[brake.wear.law] is read whole or refused with its key", "[WEAR-011]") {
    const LiningLaw law = brake_of(kRig).law.value();
    CHECK(law.lining_J == 488e6);
    CHECK(law.per_temperature == -0.002);
    const auto rejected = [](const char* from, const char* to) { return rejection_of([&] { return brake_of(replaced(kRig, from, to)); }).key(); };
    CHECK(rejected("core_share = 0.12", "core_share = 0.0") == "brake.wear.law.core_share");
    CHECK(rejected("memory = 0.6", "memory = 0.95") == "brake.wear.law.memory");
    CHECK(rejected("plateau = 0.25", "") == "brake.wear.law.plateau");
}
