/// The plant with steps as long as the motion allows, against the reference.
#include <algorithm>
#include <span>
#include <stdexcept>

#include "plant_sim/model/open_loop.hpp"
#include "tests/catch.hpp"
#include "tests/model/reference/comparison.hpp"
#include "tests/model/scenarios.hpp"

using plant::OpenLoop;
using reference::Input;

namespace {

void check_all(std::size_t first, std::size_t count, double tolerance) {
    for (const Input input : {Input::pressure, Input::valve}) {
        Comparison worst;
        for (const NamedScenario& s : all_scenarios()) {
            const auto all = profiles(s.loaded.rig);
            for (const NamedProfile& p : std::span(all).subspan(first, count)) {
                CAPTURE(s.name, p.name, input == Input::valve);
                reference::Options options;
                options.longest_s = p.longest_s;
                const Comparison c = compare_open_loop(s.loaded.rig, input, p.pressure_Pa, options, tolerance);
                CHECK(c.v <= 1e-4);
                CHECK(c.omega <= 1e-4);
                CHECK(c.residual <= 1e-6);
                worst.v = std::max(worst.v, c.v);
                worst.omega = std::max(worst.omega, c.omega);
                worst.residual = std::max(worst.residual, c.residual);
            }
        }
        SUCCEED("worst error of v " << worst.v << ", of omega " << worst.omega << ", residual " << worst.residual);
    }
}

}  // namespace

TEST_CASE("open loop: below the peak long steps agree with the reference, at their ends and between", "[RIG-001]") {
    check_all(0, 2, OpenLoop::kCoarse);
}

TEST_CASE("open loop: locks and release too, at the tighter tolerance", "[RIG-001][figures]") {
    check_all(2, 2, OpenLoop::kFine);
}

TEST_CASE("open loop: what it cannot do is refused", "[RIG-001]") {
    rig::ManeuverChoice choice;
    choice.carrier = rig::Carrier::flywheel;
    const rig::RigParameters lagging = rig::load_rig("config", choice).rig;
    const rig::RigParameters rig = rig::load_rig("config", {}).rig;
    const std::vector<OpenLoop::Point> good{{0.0, 0.0}, {1.0, 1e6}};
    const std::vector<OpenLoop::Point> back{{0.0, 0.0}, {1.0, 1e6}, {0.5, 0.0}};
    CHECK_THROWS_AS(OpenLoop(rig, OpenLoop::Input::valve, {}), std::invalid_argument);
    CHECK_THROWS_AS(OpenLoop(rig, OpenLoop::Input::valve, back), std::invalid_argument);
    CHECK_THROWS_AS(OpenLoop(lagging, OpenLoop::Input::valve, good), std::invalid_argument);
    rig::RigParameters ring = rig, line = rig, patches = rig;
    ring.wheel.compliance.ring = {.belt_share = 0.3, .frequency_Hz = 80.0, .damping = 0.06};
    line.valve.line_s = 4e-3;
    patches.runway.patches = {{10.0, rig.surface}};
    for (const rig::RigParameters& hard : {ring, line, patches})
        CHECK_THROWS_AS(OpenLoop(hard, OpenLoop::Input::pressure, good), std::invalid_argument);
    OpenLoop plant(rig, OpenLoop::Input::pressure, good);
    while (plant.step(2.0)) {
    }
    CHECK(plant.time_s() == 2.0);
    CHECK(plant.pressure_Pa() == 1e6);
    CHECK_FALSE(plant.step(2.0));
    // To standstill and no further.
    const std::vector<OpenLoop::Point> hard{{0.0, 0.0}, {1.0, 2e7}};
    OpenLoop stops(rig, OpenLoop::Input::pressure, hard);
    while (stops.step(1000.0)) {
    }
    CHECK(stops.wheel().v_mps <= plant::Wheel::kSlowest_mps);
    CHECK(stops.time_s() < 30.0);
}
