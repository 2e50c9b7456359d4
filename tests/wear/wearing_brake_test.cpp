#include "rig_bridge/wear/wearing_brake.hpp"

#include <stdexcept>
#include <vector>

#include "rig_bridge/rig/load_rig.hpp"
#include "rig_bridge/wear/load_brake_wear.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"
#include "tests/wear/kolmogorov.hpp"
#include "tests/wear/shipped_wear.hpp"

namespace {

using wear::BrakeWear;
using wear::WearingBrake;

constexpr wear::ConditionalRule kExactMixture{wear::Variance::exact, wear::Choice::mixture};

/// Of a rig file with this [brake.wear].
BrakeWear loaded(const std::string& text, const std::filesystem::path& directory = "config") {
    const settings::Document doc = parsed(text);
    const BrakeWear wear = wear::load_brake_wear(doc.root().table("brake").table("wear"), directory);
    doc.finish();
    return wear;
}

const std::string kGood = "[brake.wear]\nmodel = \"wear/model.json\"\nenergy_scale = 8.0\nfriction_scale = 1.1\nlife_J = 3.9e9\n";

}  // namespace

TEST_CASE("a brake of another size wears by the same model over its own energy, with its own friction", "[WEAR-009]") {
    const BrakeWear small = shipped_wear();
    const BrakeWear large = shipped_wear({.energy = 8.0, .friction = 1.2});
    std::vector<double> draws;
    draws.reserve(2000);
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
        const double theirs = WearingBrake(small, kExactMixture, {seed, 3, 200e6}).next_friction();
        const double ours = WearingBrake(large, kExactMixture, {seed, 3, 1600e6}).next_friction();
        CHECK(ours == Approx(1.2 * theirs).epsilon(1e-12));
        draws.push_back(ours);
    }
    const wear::Conditional c = wear::friction_given_energy(*small.model, 200e6, kExactMixture);
    CHECK(kolmogorov::distance(draws, [&](double x) { return c.cumulative(x / 1.2); }) < kolmogorov::bound_at_0_001(draws.size()));
    CHECK(wear::expected_friction_at(*large.model, large.scale, kExactMixture, 1600e6) == Approx(1.2 * c.mean()).epsilon(1e-12));
    CHECK_FALSE(WearingBrake(large, {}, {1, 0, 488e6 * 8.0}).extrapolates());
    CHECK(WearingBrake(large, {}, {1, 0, 490e6 * 8.0}).extrapolates());
    CHECK_FALSE(WearingBrake(large, {}, {}).extrapolates());
}

TEST_CASE("the next friction follows from seed, number of the maneuver and energy alone", "[WEAR-009]") {
    const BrakeWear wear = shipped_wear({.energy = 8.0, .friction = 1.0});
    WearingBrake whole(wear, {}, {.seed = 9});
    for (int i = 0; i < 50; ++i) {
        const WearingBrake resumed(wear, {}, whole.state());
        CHECK(resumed.next_friction() == whole.next_friction());
        const double before = whole.next_friction();
        whole.take(0.0);
        CHECK(whole.next_friction() != before);
        whole.take(40e6);
    }
    CHECK(whole.state() == wear::BrakeState{9, 100, 2000e6});
    CHECK(whole.next_friction() != WearingBrake(wear, {}, {8, 100, 2000e6}).next_friction());
    CHECK(WearingBrake(wear, {}, {1, 0, 1e12}).next_friction() >= wear::kMinFriction);
}

TEST_CASE("a wearing brake that makes no sense is refused", "[WEAR-009]") {
    WearingBrake brake(shipped_wear(), {}, {});
    CHECK_THROWS_AS(brake.take(-1.0), std::invalid_argument);
    CHECK_THROWS_AS(brake.take(std::nan("")), std::invalid_argument);
    CHECK_THROWS_AS(WearingBrake(shipped_wear(), {}, {1, 0, -1.0}), std::invalid_argument);
    CHECK_THROWS_AS(WearingBrake(shipped_wear({.energy = 0.0}), {}, {}), std::invalid_argument);
    CHECK_THROWS_AS(WearingBrake({}, {}, {}), std::invalid_argument);
}

TEST_CASE("[brake.wear] is read whole or refused with its key", "[WEAR-011]") {
    const BrakeWear good = loaded(kGood);
    CHECK(good.scale == wear::BrakeScale{8.0, 1.1});
    CHECK(good.life_J == 3.9e9);
    CHECK(good.file == "config/wear/model.json");
    CHECK(good.model->data.maneuvers == 500);
    const auto rejected = [](const std::string& from, const std::string& to) {
        std::string text = kGood;
        text.replace(text.find(from), from.size(), to);
        return rejection_of([&] { return loaded(text); });
    };
    CHECK(rejected("energy_scale = 8.0", "").key() == "brake.wear.energy_scale");
    CHECK(rejected("friction_scale = 1.1", "friction_scale = 0.0").key() == "brake.wear.friction_scale");
    CHECK(rejected("life_J", "life_MJ").key() == "brake.wear.life_MJ");
    CHECK(rejected("life_J = 3.9e9", "life_J = 3.9e9\nextra = 1").key() == "brake.wear.extra");
    const settings::Error none = rejected("wear/model.json", "wear/nothing.json");
    CHECK(none.line() == 2);
    CHECK_THAT(none.what(), ContainsSubstring("config/wear/nothing.json is no file"));
    // What is wrong with the model's own file is said of that file.
    const TemporaryDirectory directory;
    std::filesystem::create_directory(directory / "wear");
    put(directory / "wear/model.json", content_of("config/wear/model.json").substr(0, 300));
    CHECK(rejection_of([&] { return loaded(kGood, directory.path()); }).file() == (directory / "wear/model.json").string());
}

TEST_CASE("both rigs' brakes start at their nominal friction and are worn at the end of their life", "[WEAR-011]") {
    for (const char* maneuver : {"heavy", rig::kEndurance}) {
        CAPTURE(maneuver);
        rig::ManeuverChoice choice;
        choice.maneuver = maneuver;
        const rig::LoadedRig rig = rig::load_rig("config", choice);
        const auto at = [&](double c_e_J) { return wear::expected_friction_at(*rig.wear.model, rig.wear.scale, kExactMixture, c_e_J); };
        CHECK(at(0.0) == Approx(rig.rig.mean_friction).margin(0.01));
        CHECK(at(rig.wear.life_J) > 0.17);
        CHECK(at(rig.wear.life_J) < 0.20);
        CHECK(std::find(rig.files.begin(), rig.files.end(), rig.wear.file) != rig.files.end());
    }
}
