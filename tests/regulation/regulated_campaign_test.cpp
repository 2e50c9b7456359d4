/// A regulated campaign of the bridge: its rows, its view, and the same logic on rig, PLC and controller in one process.
#include <cmath>
#include <limits>
#include <vector>

#include "firmware/host/settings/atomic_file.hpp"
#include "rig_bridge/bridge/status.hpp"
#include "rig_bridge/bridge/view.hpp"
#include "rig_bridge/bridge/wear_regulation.hpp"
#include "rig_bridge/rig/friction_curve.hpp"
#include "rig_bridge/wear/population.hpp"
#include "tests/catch.hpp"
#include "tests/endurance/truth.hpp"

using rig::bridge::WearRegulation;
using rig::record::LedgerRow;
using rig::record::RowState;
using wear::RegulationConfig;

namespace {

constexpr double kNotRecorded = std::numeric_limits<double>::quiet_NaN();

RegulationConfig shipped() {
    return wear::load_regulation_config("config/regulation.toml");
}

LedgerRow row(RowState state, double reference, double share, double cumulative_J) {
    LedgerRow row;
    row.state = state;
    row.slip_reference = reference;
    row.summary.figures.kinetic_energy_J = 8.3e6;
    row.summary.figures.energy_brake_J = (1.0 - share) * 8.3e6;
    row.summary.figures.energy_tyre_J = share * 8.3e6;
    row.summary.figures.j_mu = 0.95;
    row.summary.cumulative_energy_J = cumulative_J;
    row.has_figures = state == RowState::finished || state == RowState::aborted;
    row.counted_J = row.summary.figures.energy_brake_J;
    return row;
}

/// A folder of this test alone.
std::filesystem::path fresh(const char* name) {
    const auto path = std::filesystem::temp_directory_path() / name;
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
    return path;
}

rig::record::Campaign campaign(std::int64_t planned) {
    return {.name = "pair", .scenario = "heavy", .seed = 1, .planned = planned, .config_hash = "h", .version = "v", .created = "t"};
}

}  // namespace

TEST_CASE("the references follow from the rows alone, each as what it is", "[BRG-510]") {
    const WearRegulation shares(shipped(), endurance_test::setup("heavy").scenario);
    CHECK(shares.plan().landings == 256);
    CHECK(shares.plan().landing_J == Approx(8.3e6).epsilon(0.01));
    std::vector<LedgerRow> rows;
    CHECK(shares.after(rows).reference() == 0.24);
    double cumulative_J = 0.0;
    for (int i = 0; i < 12; ++i) {
        const double reference = shares.after(rows).reference();
        cumulative_J += 0.77 * 8.3e6;
        rows.push_back(row(RowState::finished, reference, 0.23, cumulative_J));
    }
    const wear::Regulator finished = shares.after(rows);
    CHECK(finished.landings() == 12);
    CHECK(finished.brake_used_J() == Approx(2.95e9 + cumulative_J));
    CHECK(finished.tyre_used_J() == Approx(12 * 0.23 * 8.3e6));
    CHECK(finished.reference() > 0.26);  // more to the tyre: 0.281 is wanted

    // What is running or was left unfinished has not been.
    rows.push_back(row(RowState::unfinished, 0.3, 0.3, kNotRecorded));
    rows.push_back(row(RowState::running, 0.3, 0.3, kNotRecorded));
    CHECK(shares.after(rows).landings() == 12);
    CHECK(shares.after(rows).reference() == finished.reference());
    // An aborted one has spent energy, but is no landing.
    rows.push_back(row(RowState::aborted, 0.3, 0.5, cumulative_J + 0.5 * 8.3e6));
    const wear::Regulator aborted = shares.after(rows);
    CHECK(aborted.landings() == 12);
    CHECK(aborted.tyre_used_J() == Approx(finished.tyre_used_J() + 0.5 * 8.3e6));
    CHECK(aborted.brake_used_J() == Approx(finished.brake_used_J() + 0.5 * 8.3e6));
    // Figures that lack frames, or are none, are not believed.
    LedgerRow lossy = row(RowState::finished, 0.3, 0.3, cumulative_J + 10e6);
    lossy.summary.frames_dropped = 3;
    rows.push_back(lossy);
    CHECK(shares.after(rows).missed() == 1);
    rows.push_back(row(RowState::finished, 0.3, kNotRecorded, kNotRecorded));
    CHECK(shares.after(rows).missed() == 2);
    CHECK(shares.after(rows).last_reading() == wear::Reading::missing);
    // After those the ledger's sum is too small, and nobody takes it for a counter that went back.
    rows.push_back(row(RowState::finished, 0.3, 0.28, cumulative_J + 11e6));
    CHECK(shares.after(rows).last_reading() == wear::Reading::measured);
    CHECK(shares.after(rows).brake_used_J() > 2.95e9 + cumulative_J + 15e6);
    // A sum that goes back without a reason is.
    std::vector<LedgerRow> back{row(RowState::finished, 0.24, 0.23, 8e6), row(RowState::finished, 0.24, 0.23, 7e6)};
    CHECK(shares.after(back).last_reading() == wear::Reading::counter_back);
}

TEST_CASE("a campaign that cannot be regulated is refused with the file", "[BRG-510]") {
    const RegulationConfig config = shipped();
    CHECK_THROWS_WITH(WearRegulation(config, endurance_test::setup("endurance").scenario),
                      ContainsSubstring("endurance.toml") && ContainsSubstring("law.law") && ContainsSubstring("slip"));
    rig::Scenario heavy = endurance_test::setup("heavy").scenario;
    heavy.choice.surface = "grass";
    CHECK_THROWS_WITH(WearRegulation(config, heavy), ContainsSubstring("regulation.toml") && ContainsSubstring("grass"));
    heavy.choice.surface = "snow";
    heavy.rig.wear.life_J = 1e9;
    CHECK_THROWS_WITH(WearRegulation(config, heavy), ContainsSubstring("plan.brake_taken_J"));
}

TEST_CASE("a campaign reckons with the surfaces that it is told, and with its own", "[BRG-510]") {
    RegulationConfig config = shipped();
    const rig::Scenario scenario = endurance_test::setup("heavy").scenario;  // dry asphalt
    const wear::Range all = WearRegulation(config, scenario).after({}).range();
    config.surfaces = {"ice"};
    const wear::Range own = WearRegulation(config, scenario).after({}).range();
    CHECK(own == config.range_on("dry_asphalt"));
    CHECK(own.lowest < all.lowest);
    CHECK(own.highest > all.highest);
}

TEST_CASE("what was read of lining and tread corrects their lives", "[BRG-510]") {
    const rig::Scenario scenario = endurance_test::setup("heavy").scenario;
    const WearRegulation shares(shipped(), scenario);
    const wear::WearPlan& plan = shares.plan();
    const double brake_J = 0.9 * plan.brake_life_J, tyre_J = 1.2 * plan.tyre_life_J;  // true lives
    std::vector<LedgerRow> rows;
    double cumulative_J = 0.0;
    for (int i = 0; i < 40; ++i) rows.push_back(row(RowState::finished, 0.24, 0.23, cumulative_J += 0.77 * 8.3e6));
    CHECK(shares.after(rows).plan().tyre_life_J == plan.tyre_life_J);
    const double required_share = shares.after(rows).required_share();
    rows[9].worn.lining = (plan.brake_taken_J + 10 * 0.77 * 8.3e6) / brake_J;
    rows[39].worn.lining = (plan.brake_taken_J + 40 * 0.77 * 8.3e6) / brake_J;
    const wear::Regulator lining = shares.after(rows);
    // Two readings of 2 % at 0.85 of life, a life of 12 %: little of the plan is left.
    CHECK(lining.plan().brake_life_J == Approx(brake_J).epsilon(0.005));
    CHECK(lining.plan().tyre_life_J == plan.tyre_life_J);
    CHECK(lining.required_share() > required_share + 0.05);  // less is left to the brake
    rows[39].worn.tread = 40 * 0.23 * 8.3e6 / tyre_J;
    const wear::Regulator both = shares.after(rows);
    CHECK(both.plan().tyre_life_J > 1.05 * plan.tyre_life_J);
    CHECK(both.plan().tyre_life_J < tyre_J);
    // The plan is for the first tyre: what is read of another one says nothing of its life.
    rows[39].summary.specimen.tyre = "T2";
    CHECK(shares.after(rows).plan().tyre_life_J == plan.tyre_life_J);
}

TEST_CASE("the brake's life is what its friction foretells; without friction it is the plan's", "[BRG-510]") {
    const rig::Scenario scenario = endurance_test::setup("heavy").scenario;
    const WearRegulation shares(shipped(), scenario);
    const wear::BrakeWear& brake = scenario.rig.wear;
    // A brake that lasts a tenth of the budget longer than planned, as the meter would see it.
    const double life_J = brake.life_J + 0.1 * shares.plan().brake_budget_J();
    const wear::MeanCurve curve(*brake.model);
    const auto campaign_of = [&](auto&& measured) {
        std::vector<LedgerRow> rows;
        for (double taken_J = 10e6; shares.plan().brake_taken_J + taken_J < life_J - 50e6; taken_J += 10e6) {
            rows.push_back(row(RowState::finished, 0.3, 0.28, taken_J));
            const double c_e_J = shares.plan().brake_taken_J + taken_J;
            const double friction = curve(c_e_J * brake.life_J / life_J / brake.scale.energy);
            rows.back().summary.figures.brake_on_mps = 61.0;
            rows.back().summary.figures.mean_friction = measured(rig::measured_friction(scenario.rig.rig.friction_curve, friction, 5.0 / 61.0));
        }
        return rows;
    };
    const auto as_it_is = shares.after(campaign_of([](double friction) { return friction; }));
    CHECK(as_it_is.plan().brake_life_J == Approx(life_J).epsilon(0.005));
    const auto none = shares.after(campaign_of([](double) { return kNotRecorded; }));
    CHECK(none.plan().brake_life_J == shares.plan().brake_life_J);
    CHECK(none.missed() == 0);  // the energies are measured all the same
    RegulationConfig without = shipped();
    without.forecast_widest = 0.0;
    CHECK(WearRegulation(without, scenario).after(campaign_of([](double friction) { return friction; })).plan().brake_life_J ==
          shares.plan().brake_life_J);
}

TEST_CASE("the ledger keeps the reference in force", "[BRG-510]") {
    const auto path = fresh("regulation_ledger") / "campaign.sqlite";
    {
        rig::record::Ledger ledger(path, {.durable = false});
        static_cast<void>(ledger.open_campaign(campaign(2), rig::record::IfChanged::reject));
        static_cast<void>(ledger.begin(1, "t", 0.275));
        ledger.mark_unfinished();
        static_cast<void>(ledger.begin(1, "t"));
    }
    const auto rows = rig::record::read_ledger(path, "pair");
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].slip_reference == 0.275);
    CHECK(std::isnan(rows[1].slip_reference));
}

TEST_CASE("view and status show reference, shares and landings to the limits", "[BRG-510]") {
    const WearRegulation shares(shipped(), endurance_test::setup("heavy").scenario);
    const wear::Regulator one = shares.after({row(RowState::finished, 0.24, 0.231, 6.4e6)});
    const std::string text = rig::bridge::line(one);
    CHECK_THAT(text, ContainsSubstring("slip reference 0.260") && ContainsSubstring("0.231 measured") && ContainsSubstring("0.281 wanted") &&
                         ContainsSubstring("(brake)") && ContainsSubstring("early"));  // 256 heavy landings bring more than is left
    rig::bridge::ViewModel view;
    view.campaign = rig::bridge::CampaignView{.number = 2, .finished = 1, .planned = 3, .left_s = {}, .regulation = text};
    CHECK(rig::bridge::screen(view, 200).at(1) == text);
    view.campaign->regulation.clear();
    CHECK(rig::bridge::screen(view, 200).size() == 6);

    const auto folder = fresh("regulation_status");
    {
        rig::record::Ledger ledger(folder / "campaign.sqlite", {.durable = false});
        static_cast<void>(ledger.open_campaign(campaign(2), rig::record::IfChanged::reject));
        static_cast<void>(ledger.begin(1, "t", 0.24));
        rig::record::Summary summary = row(RowState::finished, 0.24, 0.231, 6.4e6).summary;
        summary.campaign = "pair";
        summary.number = 1;
        summary.outcome = "finished";
        ledger.finish(summary);
    }
    CHECK_THAT(rig::bridge::status_text(folder / "campaign.sqlite"), !ContainsSubstring("regulation:") && ContainsSubstring(" 0.240"));
    std::filesystem::create_directories(folder / "pair");
    rig::bridge::write_regulation(rig::bridge::regulation_file(folder, "pair"), one);
    CHECK_THAT(rig::bridge::status_text(folder / "campaign.sqlite"), ContainsSubstring("regulation: " + text));
    CHECK_THAT(rig::bridge::status_json(folder / "campaign.sqlite"),
               ContainsSubstring("\"slip_reference\": 0.24") && ContainsSubstring("\"brake_limit_landing\""));
    // A torn file is no reason not to show the ledger.
    settings::write_file(rig::bridge::regulation_file(folder, "pair"), "{\"line\": ");
    CHECK_THAT(rig::bridge::status_text(folder / "campaign.sqlite"), !ContainsSubstring("regulation:"));
}

TEST_CASE("a regulated campaign in one process: rows, references, resumption", "[BRG-510]") {
    const endurance::EnduranceSetup setup = endurance_test::setup("light");
    RegulationConfig config = shipped();
    config.plan.brake_taken_J = setup.scenario.rig.wear.life_J - 12 * 2.30e6;
    config.plan.tyre_life_J = 12 * 1.06e6;
    config.plan.landings = 12;
    const WearRegulation shares(config, setup.scenario);
    const auto path = fresh("regulation_cell") / "campaign.sqlite";
    auto cell = endurance_test::cell(setup);
    constexpr int kPlanned = 5;
    double taken_J = 0.0;
    for (int number = 1; number <= kPlanned; ++number) {
        // As after a kill: nothing is left but the ledger.
        rig::record::Ledger ledger(path, {.durable = false});
        static_cast<void>(ledger.open_campaign(campaign(kPlanned), rig::record::IfChanged::reject));
        const wear::Regulator before = shares.after(rig::record::read_ledger(path, "pair"));
        static_cast<void>(ledger.begin(number, "t", before.reference()));
        rig::Plan maneuver = rig::plan(setup.scenario, 1, number);
        maneuver.slip_reference = before.reference();
        const endurance::Outcome outcome = cell.run(maneuver);
        REQUIRE(outcome.phase == rig::Phase::finished);
        taken_J += outcome.figures.energy_brake_J;
        rig::record::Summary summary;
        summary.campaign = "pair";
        summary.number = number;
        summary.outcome = "finished";
        summary.figures = outcome.figures;
        summary.cumulative_energy_J = taken_J;
        ledger.finish(summary);
    }
    const auto rows = rig::record::read_ledger(path, "pair");
    REQUIRE(rows.size() == kPlanned);
    const wear::Regulator after = shares.after(rows);
    CHECK(after.landings() == kPlanned);
    CHECK(after.missed() == 0);
    CHECK(rows[0].slip_reference == 0.24);
    CHECK(rows[4].slip_reference == Approx(0.32).margin(0.011));  // by steps of 0.02 towards 0.315 of the energy
    CHECK(after.measured_share() == Approx(rows[4].slip_reference * 0.97).margin(0.02));
    CHECK(after.brake_used_J() - config.plan.brake_taken_J == Approx(taken_J));
}
