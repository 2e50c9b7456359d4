/// Whether a finished maneuver was the one that was asked for.
#include "rig_bridge/rig/acceptance.hpp"

#include <algorithm>
#include <limits>

#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"

using Keys = std::vector<std::string>;

namespace {

rig::Scenario from_config(const std::string& name) {
    return rig::load_scenario("config/scenarios/" + name + ".toml");
}

/// Figures of an endurance stop that was just what the plan says.
rig::record::Figures as_planned(const rig::Plan& plan) {
    rig::record::Figures f;
    f.brake_on_mps = plan.speed_mps;
    f.mean_load_N = plan.load_base_N;
    f.duration_s = plan.speed_mps / plan.deceleration_mps2;
    f.length_m = 0.5 * plan.speed_mps * plan.speed_mps / plan.deceleration_mps2;
    return f;
}

rig::Scenario changed(const std::string& name, const std::string& acceptance) {
    const TemporaryDirectory directory;
    const auto file = directory / (name + ".toml");
    std::string text = content_of("config/scenarios/" + name + ".toml");
    if (const auto at = text.find("[acceptance]"); at != std::string::npos) text.erase(at);
    put(file, text + acceptance);
    return rig::load_scenario(file);
}

}  // namespace

TEST_CASE("a scenario that scatters is held to three deviations of its own scatter, about what was drawn", "[BRG-140]") {
    const rig::Scenario s = from_config("endurance");
    const rig::Plan plan = rig::plan(s, 5, 17);
    REQUIRE(plan.load_base_N != s.mean.load_base_N);
    const auto bands = rig::acceptance(s, plan);
    const rig::record::Figures good = as_planned(plan);
    CHECK(rig::out_of_tolerance(bands, good).empty());
    CHECK(rig::what_is_outside(bands, good).empty());
    struct Edge {
        double rig::record::Figures::*figure;
        double deviation;
        const char* key;
    };
    // Of duration and length: 16.92 s and 464.1 m times the printed relative deviations' sums of squares, 0.9 and 1.07 %.
    for (const Edge& edge :
         {Edge{&rig::record::Figures::brake_on_mps, 0.18, "brake_on_mps"}, Edge{&rig::record::Figures::mean_load_N, 198.9, "mean_load_N"},
          Edge{&rig::record::Figures::duration_s, good.duration_s * 0.0090079, "duration_s"},
          Edge{&rig::record::Figures::length_m, good.length_m * 0.0106508, "length_m"}}) {
        CAPTURE(edge.key);
        for (const double sign : {-1.0, 1.0}) {
            rig::record::Figures f = good;
            f.*edge.figure = good.*edge.figure + sign * 2.9 * edge.deviation;
            CHECK(rig::out_of_tolerance(bands, f).empty());
            f.*edge.figure = good.*edge.figure + sign * 3.1 * edge.deviation;
            CHECK(rig::out_of_tolerance(bands, f) == Keys{edge.key});
        }
    }
    rig::record::Figures off = good;
    off.mean_load_N = 16'505.0;
    off.length_m = 652.0;
    CHECK(rig::out_of_tolerance(bands, off) == Keys{"mean_load_N", "length_m"});
    CHECK_THAT(rig::what_is_outside(bands, off), ContainsSubstring("mean load 16505 N (") && ContainsSubstring(", length 652 m ("));
    off = good;
    off.duration_s = std::numeric_limits<double>::quiet_NaN();
    CHECK(rig::out_of_tolerance(bands, off) == Keys{"duration_s"});
}

TEST_CASE("every shipped scenario says what speed and load its maneuvers may have", "[BRG-140]") {
    for (const auto& entry : std::filesystem::directory_iterator("config/scenarios")) {
        const rig::Scenario s = rig::load_scenario(entry.path());
        CAPTURE(s.name);
        const auto bands = rig::acceptance(s, s.mean);
        const auto band = [&](const std::string& key) {
            return std::find_if(bands.begin(), bands.end(), [&](const rig::Band& b) { return b.figure->key == key; });
        };
        REQUIRE(band("brake_on_mps") != bands.end());
        CHECK(band("brake_on_mps")->min < s.mean.speed_mps);
        CHECK(band("brake_on_mps")->max > s.mean.speed_mps);
        REQUIRE(band("mean_load_N") != bands.end());
        // No load of a third less passes.
        CHECK(band("mean_load_N")->min > 0.67 * band("mean_load_N")->max);
    }
}

TEST_CASE("a band that the file declares stands instead of the scatter's", "[BRG-140]") {
    const rig::Scenario s = changed("endurance", "\n[acceptance]\nlength_m = [400.0, 500.0]\nmean_friction = [0.1, 0.4]\n");
    const auto bands = rig::acceptance(s, s.mean);
    rig::record::Figures f = as_planned(s.mean);
    f.mean_friction = 0.3;
    f.length_m = 499.0;
    CHECK(rig::out_of_tolerance(bands, f).empty());
    f.length_m = 501.0;
    f.mean_friction = 0.41;
    CHECK(rig::out_of_tolerance(bands, f) == Keys{"length_m", "mean_friction"});
}

TEST_CASE("without scatter or bands nothing is judged", "[BRG-140]") {
    const rig::Scenario s = changed("light", "");
    CHECK(rig::acceptance(s, s.mean).empty());
}

TEST_CASE("a band that is none is refused with file, line and key", "[BRG-120]") {
    const auto rejected = [](const std::string& line) { return rejection_of([&] { return changed("light", "\n[acceptance]\n" + line + "\n"); }); };
    CHECK_THAT(rejected("length_m = [100.0]").key(), ContainsSubstring("acceptance.length_m"));
    CHECK_THAT(rejected("length_m = [200.0, 100.0]").key(), ContainsSubstring("acceptance.length_m"));
    CHECK_THAT(rejected("length_ft = [100.0, 200.0]").key(), ContainsSubstring("acceptance.length_ft"));
}
