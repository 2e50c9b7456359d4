/// Table III, and that a campaign comes out the same every time and goes on where it was.
#include "plant_sim/endurance/endurance_campaign.hpp"

#include <cmath>

#include "firmware/host/settings/json.hpp"
#include "plant_sim/endurance/table_three.hpp"
#include "plant_sim/wear/brake_state.hpp"
#include "tests/catch.hpp"
#include "tests/endurance/truth.hpp"
#include "tests/settings/refusal.hpp"

using endurance::CampaignResult;
using endurance::kTableThree;
using endurance::TableThree;
using endurance_test::setup;

namespace {

CampaignResult campaign(const std::filesystem::path& ledger, std::int64_t maneuvers, std::uint64_t seed = 1) {
    return endurance::run_campaign(setup("endurance"), {.maneuvers = maneuvers, .seed = seed, .ledger = ledger});
}

/// The printed table, by hand: it must not follow the configuration.
constexpr double kMeans[] = {630.37, 23532.78, 54.86, 16.92, 464.22};
constexpr double kDeviations[] = {4.65, 198.90, 0.18, 0.19, 5.46};

}  // namespace

TEST_CASE("Table III: over 20 maneuvers every mean within one printed standard deviation", "[STUDY-073][figures]") {
    const auto seed = GENERATE(as<std::uint64_t>(), 1, 2, 3);
    CAPTURE(seed);
    const TemporaryDirectory directory;
    const CampaignResult result = campaign(directory / "campaign.sqlite", 20, seed);
    REQUIRE(result.finished.size() == 20);
    const TableThree measured = endurance::measured_table(result.finished);
    for (std::size_t i = 0; i < measured.size(); ++i) {
        INFO(kTableThree[i].name << " " << measured[i].mean);
        CHECK(std::abs(measured[i].mean - kMeans[i]) <= kDeviations[i]);
    }
}

TEST_CASE("Table III: over 500 maneuvers, new to worn out, every standard deviation within 30 % of the printed one", "[STUDY-073][figures]") {
    const TemporaryDirectory directory;
    const CampaignResult result = campaign(directory / "campaign.sqlite", 500);
    REQUIRE(result.finished.size() == 500);
    const TableThree measured = endurance::measured_table(result.finished);
    for (std::size_t i = 0; i < measured.size(); ++i) {
        INFO(kTableThree[i].name << " " << measured[i].mean << " +- " << measured[i].deviation);
        CHECK(std::abs(measured[i].mean - kMeans[i]) <= kDeviations[i]);
        CHECK(measured[i].deviation / kDeviations[i] >= 0.7);
        CHECK(measured[i].deviation / kDeviations[i] <= 1.3);
    }
    // 0.975 MJ a stop, 488 MJ in all; the brake wears as it goes.
    CHECK(result.finished.back().cumulative_energy_J == Approx(488e6).epsilon(0.02));
    CHECK(result.finished.front().figures.mean_friction > 0.28);
    CHECK(result.finished.back().figures.mean_friction < 0.20);
    for (const rig::record::Summary& m : result.finished) {
        REQUIRE((m.faults.empty() && m.figures.standstill));
        REQUIRE(m.out_of_tolerance == std::vector<std::string>{});  // judged, and within
    }
}

TEST_CASE("same seed: the same rows to the last bit; another seed: others", "[STUDY-073]") {
    const TemporaryDirectory directory;
    const auto a = campaign(directory / "a.sqlite", 4).finished;
    const auto b = campaign(directory / "b.sqlite", 4).finished;
    const auto c = campaign(directory / "c.sqlite", 4, 2).finished;
    REQUIRE((a.size() == 4 && b.size() == 4 && c.size() == 4));
    for (std::size_t i = 0; i < 4; ++i) {
        for (const auto& q : kTableThree) CHECK(a[i].figures.*q.figure == b[i].figures.*q.figure);
        CHECK(a[i].figures.mean_friction == b[i].figures.mean_friction);
        CHECK(a[i].figures.energy_brake_J == b[i].figures.energy_brake_J);
        CHECK(a[i].figures.energy_tyre_J == b[i].figures.energy_tyre_J);
        CHECK(a[i].figures.kinetic_energy_J == b[i].figures.kinetic_energy_J);
        CHECK(a[i].figures.j_mu == b[i].figures.j_mu);
        CHECK(a[i].figures.mean_pressure_Pa == b[i].figures.mean_pressure_Pa);
        CHECK(a[i].figures.peak_temperature_C == b[i].figures.peak_temperature_C);
        CHECK(a[i].cumulative_energy_J == b[i].cumulative_energy_J);
        CHECK(a[i].started == b[i].started);
        CHECK(a[i].config_hash == b[i].config_hash);
        CHECK(a[i].figures.mean_torque_Nm != c[i].figures.mean_torque_Nm);
    }
    CHECK(content_of(directory / "a.sqlite") == content_of(directory / "b.sqlite"));
}

TEST_CASE("a campaign that was stopped goes on with the next maneuver and the brake as worn as it was", "[STUDY-073]") {
    const TemporaryDirectory directory;
    const auto ledger = directory / "campaign.sqlite";
    std::atomic<bool> stop{false};
    const CampaignResult first = endurance::run_campaign(setup("endurance"), {.maneuvers = 5, .seed = 1, .ledger = ledger, .stop = &stop},
                                                         [&](const rig::record::Summary& summary, std::int64_t) { stop = summary.number == 3; });
    REQUIRE(first.finished.size() == 3);
    const CampaignResult second = campaign(ledger, 5);
    CHECK(second.earlier == 3);
    REQUIRE(second.finished.size() == 5);
    for (std::size_t i = 0; i < 5; ++i) {
        CHECK(second.finished[i].number == static_cast<std::int64_t>(i + 1));
        if (i > 0)
            CHECK(second.finished[i].cumulative_energy_J ==
                  Approx(second.finished[i - 1].cumulative_energy_J + second.finished[i].figures.energy_brake_J));
    }
    // The same draws and the same wear as without the stop; the sensors' noise and the brake's temperature are new.
    const TemporaryDirectory other;
    const auto whole = campaign(other / "campaign.sqlite", 5).finished;
    for (std::size_t i = 3; i < 5; ++i) {
        CHECK(second.finished[i].figures.brake_on_mps == Approx(whole[i].figures.brake_on_mps).margin(0.02));
        CHECK(second.finished[i].figures.mean_torque_Nm == Approx(whole[i].figures.mean_torque_Nm).epsilon(0.01));
    }
    CHECK(campaign(ledger, 5).earlier == 5);
    CHECK_THROWS_AS(campaign(ledger, 5, 2), settings::Error);
}

TEST_CASE("friction of a maneuver follows from seed, number and what the ledger says of the brake, stopped or not", "[RIG-300]") {
    const TemporaryDirectory directory;
    const auto s = setup("endurance");
    (void)campaign(directory / "campaign.sqlite", 2);
    const auto rows = campaign(directory / "campaign.sqlite", 4).finished;  // goes on after two
    REQUIRE(rows.size() == 4);
    double taken_J = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const wear::WearingBrake brake(s.scenario.rig.wear, {}, {1, i, taken_J});
        // As the meter sees it, over a stop that is not quite of constant deceleration.
        CHECK(rows[i].figures.mean_friction == Approx(brake.next_friction()).epsilon(0.02));
        taken_J = rows[i].cumulative_energy_J;
    }
    const auto worn = endurance::run_campaign(s, {.maneuvers = 2, .seed = 1, .ledger = directory / "worn.sqlite", .taken_J = 470e6});
    REQUIRE(worn.finished.size() == 2);
    CHECK(worn.finished[0].figures.mean_friction < 0.22);
    CHECK(worn.finished[0].cumulative_energy_J == Approx(470e6 + worn.finished[0].figures.energy_brake_J));
    CHECK(worn.brake->state() == wear::BrakeState{1, 2, worn.finished[1].cumulative_energy_J});
    // Another brake or rule is another campaign.
    CHECK_THROWS_AS(campaign(directory / "worn.sqlite", 3), settings::Error);
    CHECK_THROWS_AS(endurance::run_campaign(
                        s, {.maneuvers = 3, .seed = 1, .ledger = directory / "worn.sqlite", .taken_J = 470e6, .by_model = wear::ConditionalRule{}}),
                    settings::Error);
}

TEST_CASE(
    "a campaign keeps its brake's state, goes on where it was killed before it could, and with no other "
    "brake",
    "[RIG-300]") {
    const TemporaryDirectory directory;
    const auto s = setup("endurance");
    const auto file = directory / "brake.json";
    const wear::BrakeWear& wear = s.scenario.rig.wear;
    wear::write_brake_state(file, {9, 40, 39e6}, wear);
    const auto run = [&](std::int64_t maneuvers, const char* ledger) {
        return endurance::run_campaign(s, {.maneuvers = maneuvers, .seed = 1, .ledger = directory / ledger, .brake_state = file});
    };
    const auto kept = [&] { return *wear::find_brake_state(file, wear); };
    (void)run(1, "a.sqlite");
    const wear::BrakeState one = kept();
    CHECK(one.seed == 9);
    CHECK(one.maneuvers == 41);
    CHECK(one.c_e_J == Approx(39.97e6).epsilon(0.01));
    (void)run(2, "a.sqlite");
    const wear::BrakeState two = kept();
    CHECK(two.maneuvers == 42);
    // Killed between ledger and state: the state is one behind.
    wear::write_brake_state(file, one, wear);
    const auto third = run(3, "a.sqlite");
    CHECK(third.brake->state().maneuvers == 43);
    CHECK(third.finished[2].figures.mean_friction == Approx(wear::WearingBrake(wear, {}, two).next_friction()).epsilon(0.02));
    // A brake that was elsewhere meanwhile.
    wear::write_brake_state(file, {9, 44, 100e6}, wear);
    CHECK_THROWS_AS(run(4, "a.sqlite"), settings::Error);
    // A campaign that begins has the kept brake.
    CHECK(run(1, "b.sqlite").brake->state().maneuvers == 45);
}

TEST_CASE("an aborted maneuver stops the campaign and is entered as such", "[STUDY-070]") {
    const TemporaryDirectory directory;
    endurance::EnduranceSetup s = setup("endurance");
    s.scenario.mean.braking_limit_s = 3.0;
    const CampaignResult result = endurance::run_campaign(s, {.maneuvers = 5, .seed = 1, .ledger = directory / "campaign.sqlite"});
    CHECK(result.aborted);
    CHECK(result.finished.empty());
    CHECK(result.last.number == 1);
    CHECK(result.last.outcome == "phase_timeout");
    const auto rows = rig::record::read_ledger(directory / "campaign.sqlite", "endurance");
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].state == rig::record::RowState::aborted);
}

TEST_CASE("each row has the slip reference in force; none where the law has none", "[BRG-510]") {
    const TemporaryDirectory directory;
    const endurance::EnduranceSetup light = setup("light");
    (void)endurance::run_campaign(light, {.maneuvers = 2, .seed = 1, .ledger = directory / "light.sqlite"});
    for (const rig::record::LedgerRow& row : rig::record::read_ledger(directory / "light.sqlite", "light"))
        CHECK(row.slip_reference == light.scenario.mean.slip_reference);
    (void)campaign(directory / "endurance.sqlite", 1);
    CHECK(std::isnan(rig::record::read_ledger(directory / "endurance.sqlite", "endurance").front().slip_reference));
}

TEST_CASE("the table's statistics are those of the textbook", "[STUDY-073]") {
    std::vector<rig::record::Summary> maneuvers(4);
    const double torques[] = {2.0, 4.0, 4.0, 6.0};
    for (std::size_t i = 0; i < 4; ++i) maneuvers[i].figures.mean_torque_Nm = torques[i];
    const TableThree t = endurance::measured_table(maneuvers);
    CHECK(t[0].mean == 4.0);
    CHECK(t[0].deviation == Approx(std::sqrt(8.0 / 3.0)));
    CHECK(endurance::measured_table({})[0].mean == 0.0);
    CHECK(endurance::measured_table({maneuvers.data(), 1})[0].deviation == 0.0);

    const TableThree printed = endurance::printed_table("config");
    for (std::size_t i = 0; i < printed.size(); ++i) {
        CHECK(printed[i].mean == kMeans[i]);
        CHECK(printed[i].deviation == kDeviations[i]);
    }
    const auto json =
        settings::parse_json(endurance::to_json({.scenario = "endurance", .config_hash = "h", .version = "v", .seed = 9}, maneuvers, printed));
    CHECK(json["maneuvers"] == 4);
    CHECK(json["seed"] == 9);
    CHECK(json["quantities"]["torque_Nm"]["mean"] == 4.0);
    CHECK(json["quantities"]["length_m"]["printed_deviation"] == 5.46);
    CHECK_THAT(endurance::to_text(t, printed), ContainsSubstring("630.37"));
    CHECK_THAT(endurance::to_text(t, std::nullopt), !ContainsSubstring("630.37"));
}

TEST_CASE("with a wear model each finished maneuver's row has the brake's health, also of a session without one", "[BRG-500]") {
    const TemporaryDirectory directory;
    const auto ledger = directory / "campaign.sqlite";
    (void)campaign(ledger, 3);
    CHECK(rig::record::read_ledger(ledger, "endurance")[2].health.model.empty());
    const CampaignResult result =
        endurance::run_campaign(setup("endurance"), {.maneuvers = 8, .seed = 1, .ledger = ledger, .wear_model = "config/wear/model.json"});
    const auto rows = rig::record::read_ledger(ledger, "endurance");
    REQUIRE(rows.size() == 8);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        CHECK(rows[i].health.model.size() == 32);
        CHECK(rows[i].health.model == rows[0].health.model);
        CHECK((rows[i].health.state == rig::record::HealthState::unknown) == (i < 5));
        CHECK(std::isnan(rows[i].health.statistic) == (i < 5));
    }
    CHECK(result.health.state == rows.back().health.state);
}
