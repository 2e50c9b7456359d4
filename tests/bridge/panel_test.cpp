// What the panel shows of the bridge, and that its abort is the first Ctrl-C and nothing more. [BRG-522]
#include <fmt/core.h>

#include <cmath>
#include <csignal>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/stop_signals.hpp"
#include "rig_bridge/bridge/landings_left.hpp"
#include "rig_bridge/bridge/panel_state.hpp"
#include "rig_bridge/bridge/view_model.hpp"
#include "tests/bridge/fakes.hpp"
#include "tests/catch.hpp"

using namespace rig::bridge;
using bridge_test::good_bus;
using bridge_test::good_plc;
using rig::panel::Signal;

namespace {

/// In braking, everything fresh.
Moment moment() {
    Moment m;
    m.rig_s = 12.5;
    m.plc = good_plc();
    m.bus = good_bus(std::chrono::seconds(1));
    m.bus.slip = 0.21;
    m.bus.view.controller.slip_reference = 0.24F;
    m.inputs.plc_fresh = m.inputs.plc_ready = m.inputs.bus_up = m.inputs.bus_read = m.inputs.sensors_fresh = m.inputs.controller_fresh = true;
    m.inputs.emergency_stop_clear = m.inputs.hydraulics_ready = m.inputs.drive_healthy = true;
    m.inputs.wheel_on_rim = true;
    m.inputs.rim_mps = 50.0;
    m.inputs.load_N = 4e4;
    m.outputs.phase = rig::Phase::braking;
    m.outputs.demand_Pa = 2e7;
    return m;
}

settings::Json state_of(const Moment& m) {
    return settings::parse_json(panel_state(view_of(m, {}), m, std::nullopt));
}

}  // namespace

TEST_CASE("signals that are fresh are shown, others are not known", "[BRG-522]") {
    Moment m = moment();
    auto sample = live_sample(m);
    CHECK(sample.time_s == 12.5);
    CHECK(sample[Signal::rim] == 50.0);
    CHECK(sample[Signal::slip] == 0.21);
    CHECK(sample[Signal::slip_reference] == Approx(0.24));
    CHECK(sample[Signal::demand] == 2e7);
    CHECK(sample[Signal::load] == 4e4);
    m.inputs.sensors_fresh = m.inputs.controller_fresh = m.inputs.plc_fresh = false;
    sample = live_sample(m);
    for (const Signal silent : {Signal::rim, Signal::wheel, Signal::slip, Signal::slip_reference, Signal::current, Signal::load, Signal::temperature})
        CHECK(std::isnan(sample[silent]));
}

TEST_CASE("interlocks, and what is wrong with what to do", "[BRG-522]") {
    Moment m = moment();
    auto state = state_of(m);
    CHECK(state["interlocks"]["guard closed"] == false);
    CHECK(state["interlocks"]["drive healthy"] == true);
    CHECK(state["alarms"].empty());
    m.outputs.abort = rig::Abort::guard_open;
    m.bus.view.controller.faults.insert(antiskid::control::Fault::wheel_lost);
    state = state_of(m);
    REQUIRE(state["alarms"].size() == 2);
    CHECK(state["alarms"][0]["name"] == "abort: guard_open");
    CHECK(state["alarms"][0]["happened"] == "the guard opened");
    CHECK(state["alarms"][0]["next"].get<std::string>().starts_with("find out who opened it"));
    CHECK(state["alarms"][1]["name"] == "fault: wheel_lost");
    ViewModel view = view_of(m, {});
    view.record_lost = true;
    view.note = "disk full";
    CHECK(settings::parse_json(panel_state(view, m, std::nullopt))["alarms"][0]["happened"] == "disk full");
    m.inputs.plc_fresh = false;
    CHECK(state_of(m)["interlocks"].empty());
}

TEST_CASE("campaign and landings left are among the facts", "[BRG-522]") {
    const Moment m = moment();
    ViewModel view = view_of(m, {});
    view.campaign = CampaignView{.number = 3, .finished = 2, .planned = 500, .left_s = 3700.0, .health = "healthy", .landings_left = "132"};
    const auto facts = settings::parse_json(panel_state(view, m, std::nullopt))["facts"];
    CHECK(facts["campaign"] == "maneuver 3, 2 of 500 finished");
    CHECK(facts["brake's health"] == "healthy");
    CHECK(facts["landings left"] == "132");
    CHECK_FALSE(facts.contains("regulation"));
}

TEST_CASE("the page is told what may be asked of the campaign", "[BRG-522]") {
    const Moment m = moment();
    const ViewModel view = view_of(m, {});
    CHECK(state_of(m)["campaign"].is_null());
    CHECK(settings::parse_json(panel_state(view, m, HoldStatus::runs))["campaign"] == "runs");
    CHECK(settings::parse_json(panel_state(view, m, HoldStatus::waits))["campaign"] == "waits");
    CHECK(settings::parse_json(panel_state(view, m, HoldStatus::held))["campaign"] == "held");
}

TEST_CASE("landings left come with their interval, and with what the model was learnt from", "[BRG-522]") {
    std::vector<rig::record::LedgerRow> rows(40);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].state = rig::record::RowState::finished;
        rows[i].has_figures = true;
        rows[i].summary.cumulative_energy_J = 0.97e6 * static_cast<double>(i + 1);
        rows[i].summary.figures.mean_friction = 0.300;
    }
    const std::string left = landings_left("config/wear/population.json", rows, 0.25);
    INFO(left);
    CHECK(left.find("10 to 90 %) to mean friction 0.25, by brakes made up by the law of tests/wear/physical_campaign.hpp, 40 lives") !=
          std::string::npos);
    CHECK(landings_left("config/wear/population.json", rows, 0.9).starts_with("none:"));
    std::vector<rig::record::LedgerRow> of_two_discs(20, rows.front());
    for (std::size_t i = 0; i < 20; ++i) of_two_discs[i].summary.cumulative_energy_J = 0.97e6 * static_cast<double>(i + 1);
    for (rig::record::LedgerRow row : rows) {
        row.summary.cumulative_energy_J += 20 * 0.97e6;
        row.summary.specimen.disc = "D2";
        of_two_discs.push_back(row);
    }
    CHECK(landings_left("config/wear/population.json", of_two_discs, 0.25) == left);  // the newer disc's landings
    CHECK(landings_left("config/wear/population.json", rows, 0.0).empty());
    rows.resize(1);
    CHECK(landings_left("config/wear/population.json", rows, 0.25).empty());
}

TEST_CASE("an abort that is asked for is the first signal, and no second one", "[BRG-522]") {
    antiskid::host::StopSignals stops;
    CHECK(stops.ask_first(SIGTERM));
    CHECK_FALSE(stops.ask_first(SIGTERM));
    CHECK(stops.count() == 1);
    CHECK(stops.number() == SIGTERM);
    CHECK(stops.stop());
}
