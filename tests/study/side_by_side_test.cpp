/// Maneuvers side by side in vector lanes end with the bits of the same maneuvers run alone.
#include "tests/catch.hpp"
#include "tests/study/scenarios.hpp"

#include <vector>

#include "plant_sim/study/side_by_side.hpp"
#include "rig_bridge/rig/random.hpp"

namespace {

/// As different as they come: every law, runways from ice to dry asphalt, references that lock wheels, brakes that hold none, plants
/// whose valve delay is no whole number of periods.
std::vector<study::Maneuver> random_maneuvers(std::size_t count, antiskid::can::Layout& layout) {
    const std::vector<scenarios::Name> names = scenarios::all();
    rig::Random random(16);
    const auto below = [&random](std::size_t n) { return random.bits() % n; };
    std::vector<study::Maneuver> maneuvers;
    maneuvers.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        constexpr const char* kLaws[] = {"slip", "slip", "threshold", "deceleration"};
        auto options = scenarios::options(names[below(names.size())], kLaws[below(4)]);
        options.deceleration_mps2 = 2.0 + 0.5 * static_cast<double>(below(8));
        options.slip = 0.06 + 0.01 * static_cast<double>(below(45));
        options.seed = random.bits();
        plant_sim::StopInputs s = plant_sim::load_scenario(options);
        if (below(4) == 0) s.plant.rig.valve.delay_s += 0.3e-3;
        if (below(8) == 0) s.plant.rig.mean_friction *= 1.3;
        if (below(8) == 0) s.session.longest_s = 3.0;
        s.session.drop_out_mps = 5.0;
        maneuvers.push_back({s.controller, s.plant.rig, s.session});
        layout = s.layout;
    }
    return maneuvers;
}

}  // namespace

TEST_CASE("side by side: every result is that of the maneuver alone, bit for bit", "[STUDY-160]") {
    antiskid::can::Layout layout;
    std::vector<study::Maneuver> maneuvers = random_maneuvers(40, layout);
    // A controller of 2 ms does not fit into a lane and is run all the same.
    maneuvers[5].controller.period_s = 2e-3F;
    maneuvers[5].options.period_s = 2e-3;
    std::vector<study::RunResult> together(maneuvers.size());
    std::vector<int> told(maneuvers.size(), 0);
    std::size_t next = 0;
    study::run_side_by_side(
        layout,
        [&]() -> std::optional<study::Maneuver> {
            if (next == maneuvers.size()) return std::nullopt;
            return maneuvers[next++];
        },
        [&](std::size_t number, const study::RunResult& result) {
            together.at(number) = result;
            ++told.at(number);
        });
    for (std::size_t i = 0; i < maneuvers.size(); ++i) {
        INFO("maneuver " << i);
        const study::Maneuver& m = maneuvers[i];
        CHECK(told[i] == 1);
        CHECK(together[i].steps > 1000);
        CHECK(together[i] == study::run_in_process(m.controller, layout, m.rig, m.options, study::Link::rounded));
    }
}

TEST_CASE("side by side: what a caller throws ends the run; no maneuvers are none", "[STUDY-160]") {
    antiskid::can::Layout layout;
    const std::vector<study::Maneuver> one = random_maneuvers(1, layout);
    const auto none = []() -> std::optional<study::Maneuver> { return std::nullopt; };
    int done = 0;
    study::run_side_by_side(layout, none, [&done](std::size_t, const study::RunResult&) { ++done; });
    CHECK(done == 0);
    bool given = false;
    const auto once = [&]() -> std::optional<study::Maneuver> {
        if (given) return std::nullopt;
        given = true;
        return one.front();
    };
    CHECK_THROWS_AS(study::run_side_by_side(layout, once, [](std::size_t, const study::RunResult&) { throw std::runtime_error("full"); }),
                    std::runtime_error);
}
