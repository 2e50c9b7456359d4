#include "rig_bridge/bridge/status.hpp"

#include <memory>

#include "firmware/host/settings/json.hpp"
#include "rig_bridge/bridge/view.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using can_test::TempDir;

namespace {

/// Two maneuvers of a megajoule each, the second flagged, and a third that was begun.
struct Begun {
    Begun() {
        ledger->open_campaign(
            {.name = "brake7", .scenario = "endurance", .seed = 7, .planned = 9, .config_hash = "abc", .version = "0.1.0", .created = "t0"},
            rig::record::IfChanged::reject);
        for (const char* warning : {"", "energy_unbalanced: brake and tyre took 9 MJ of 1 MJ kinetic energy"}) {
            rig::record::Summary s;
            s.campaign = "brake7";
            s.number = ledger->begin(*ledger->next_number(), "t1").number;
            s.outcome = "finished";
            s.figures.energy_brake_J = 1e6;
            if (*warning != '\0') s.warnings = {warning};
            s.cumulative_energy_J = ledger->cumulative_energy_J() + counted_energy_J(s);
            ledger->finish(s);
        }
        static_cast<void>(ledger->begin(3, "t2"));
    }
    [[nodiscard]] settings::Json json() const { return settings::parse_json(rig::bridge::status_json(path))[0]; }

    TempDir dir;
    std::filesystem::path path = dir.write("x", "").parent_path() / "campaign.sqlite";
    std::unique_ptr<rig::record::Ledger> ledger = std::make_unique<rig::record::Ledger>(path);
};

}  // namespace

TEST_CASE("Status has the energy so far while a maneuver runs, and warnings beside their maneuver", "[BRG-261]") {
    const Begun begun;
    const std::string text = rig::bridge::status_text(begun.path);
    CHECK_THAT(text, ContainsSubstring("2 of 9 maneuvers finished; 0 aborted, 0 unfinished, 1 running; 1.000 MJ"));
    CHECK_THAT(text, ContainsSubstring("energy_unbalanced: brake and tyre took 9 MJ"));
    const auto json = begun.json();
    CHECK(json["cumulative_energy_J"] == 1e6);
    CHECK(json["running"] == 1);
    CHECK(json["left"] == 0);
    CHECK(json["maneuvers"][2]["state"] == "running");
    CHECK(json["maneuvers"][1]["warnings"].size() == 1);
}

TEST_CASE("A maneuver whose bridge is dead does not run", "[BRG-261]") {
    Begun begun;
    begun.ledger.reset();
    CHECK_THAT(rig::bridge::status_text(begun.path),
               ContainsSubstring("1 left by a dead bridge; 1.000 MJ") && ContainsSubstring("      3       1  left"));
    const auto json = begun.json();
    CHECK(json["running"] == 0);
    CHECK(json["left"] == 1);
    CHECK(json["maneuvers"][2]["state"] == "left");
    // Looking takes no lock away from a bridge that starts.
    CHECK_NOTHROW(rig::record::Ledger(begun.path));
}

TEST_CASE("Amendments stand in the status with who and why", "[BRG-261]") {
    Begun begun;
    begun.ledger->mark_unfinished();
    begun.ledger->amend(2, 1, {.counted_J = 0.9e6, .who = "A. Rossi", .made = "t9", .why = "node restarted"});
    CHECK_THAT(rig::bridge::status_text(begun.path),
               ContainsSubstring("1.900 MJ") && ContainsSubstring("counts 0.900 MJ, says A. Rossi, t9: node restarted"));
    CHECK(begun.json()["maneuvers"][1]["amendments"][0]["who"] == "A. Rossi");
    CHECK(begun.json()["cumulative_energy_J"] == 1.9e6);
}

TEST_CASE("A record that the disk did not take is not an abort on request", "[BRG-261]") {
    rig::bridge::ViewModel view;
    view.abort = rig::Abort::requested;
    CHECK_THAT(rig::bridge::plain_line(view), ContainsSubstring("ABORT requested"));
    view.record_lost = true;
    CHECK_THAT(rig::bridge::plain_line(view), ContainsSubstring("ABORT record_lost"));
}
