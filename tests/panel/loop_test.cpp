// What a loop hands to its panel: no lock is waited for, and a served rig's loop allocates nothing. [BRG-520]
#include "plant_sim/plc/load_served_rig.hpp"
#include "plant_sim/virtual_rig/serve_panel.hpp"
#include "rig_bridge/rig/scenario.hpp"
#include "tests/catch.hpp"
#include "tests/host/traps.hpp"

namespace traps = host_test::traps;

TEST_CASE("a served rig's loop copies numbers for its panel, and nothing else", "[BRG-520]") {
    const rig::Scenario scenario = rig::load_scenario("config/scenarios/heavy.toml");
    plc::ServedRig rig(scenario.rig, plc::load_served_rig("config", plc::Bench::landing), 1);
    plant_sim::ServePanel panel("127.0.0.1:0", "test");
    const plant_sim::ServeState state;
    traps::clear();
    for (int i = 0; i < 500; ++i) {
        rig.advance(0.0);
        const traps::Armed armed;
        panel.show(rig, state);
    }
    for (std::size_t call = 0; call < traps::kCalls; ++call) {
        INFO(traps::kNames.at(call));
        CHECK(traps::caught(static_cast<traps::Call>(call)) == 0);
    }
}

TEST_CASE("samples and states of a loop wait for no lock", "[BRG-520]") {
    rig::panel::LiveFeed feed;
    traps::clear();
    for (int i = 0; i < 100; ++i) {
        rig::panel::LiveFeed::Text text = [facts = std::string(100, 'x')] { return facts; };
        const traps::Armed armed;
        feed.sample({});
        feed.state(std::move(text), i);
    }
    for (const traps::Call call : {traps::Call::lock, traps::Call::wait_condition, traps::Call::sleep, traps::Call::allocate})
        CHECK(traps::caught(call) == 0);
}
