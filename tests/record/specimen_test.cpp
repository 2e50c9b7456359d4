#include "rig_bridge/record/specimen.hpp"

#include <sqlite3.h>

#include <cmath>

#include "firmware/host/settings/csv_field.hpp"
#include "firmware/host/settings/error.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using namespace rig;
using can_test::TempDir;

namespace {

rig::record::Campaign campaign_of(const rig::record::Specimen& specimen) {
    return {.name = "brake7",
            .scenario = "light",
            .seed = 7,
            .planned = 5,
            .config_hash = "abc",
            .version = "0.1.0",
            .created = "t0",
            .specimen = specimen};
}

/// The next maneuver, which takes a megajoule.
void finish_next(rig::record::Ledger& ledger) {
    rig::record::Summary s;
    s.campaign = "brake7";
    s.number = ledger.begin(*ledger.next_number(), "t1").number;
    s.outcome = "finished";
    s.figures.energy_brake_J = 1e6;
    s.cumulative_energy_J = ledger.cumulative_energy_J() + 1e6;
    ledger.finish(s);
}

}  // namespace

TEST_CASE("Texts of people are one line of UTF-8", "[BRG-270]") {
    CHECK_NOTHROW(rig::record::check_text("--notes", "Zoë, \"Ω\" 刹车 😀"));
    for (const char* const bad : {"a\nb", "a\tb", "\x7f", "\xC3", "\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF0\x80\x80\x80", "\xF4\x90\x80\x80",
                                  "\xF5\x80\x80\x80", "\x80"}) {
        INFO(bad);
        CHECK_THROWS_WITH(rig::record::check_text("--notes", bad), ContainsSubstring("--notes: byte "));
    }
    CHECK_NOTHROW(rig::record::check_text("--disc", std::string(rig::record::kLongestText, 'x')));
    CHECK_THROWS_WITH(rig::record::check_text("--disc", std::string(rig::record::kLongestText + 1, 'x')), ContainsSubstring("too long"));
    rig::record::Specimen specimen;
    specimen.operator_name = "a\rb";
    CHECK_THROWS_WITH(rig::record::check_texts(specimen), ContainsSubstring("--operator"));
}

TEST_CASE("Fields of a CSV are quoted where they must be", "[BRG-270]") {
    CHECK(settings::csv_field("D7") == "D7");
    CHECK(settings::csv_field("").empty());
    CHECK(settings::csv_field("a, \"b\"") == "\"a, \"\"b\"\"\"");
    CHECK(settings::csv_field("#1") == "\"#1\"");
    CHECK(settings::csv_field(" a") == "\" a\"");
    CHECK(settings::csv_field("a\nb") == "\"a\nb\"");
}

TEST_CASE("Each maneuver keeps the specimen that was said when it began", "[BRG-270]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "campaign.sqlite";
    {
        rig::record::Ledger ledger(path);
        ledger.open_campaign(campaign_of({.brake = "B1", .disc = "D7", .operator_name = "Rossi"}), rig::record::IfChanged::reject);
        finish_next(ledger);
    }
    rig::record::Ledger ledger(path);
    // What is not said again stays.
    ledger.open_campaign(campaign_of({.tyre = "T2", .notes = "new tyre"}), rig::record::IfChanged::reject);
    CHECK(ledger.specimen() == rig::record::Specimen{.brake = "B1", .disc = "D7", .tyre = "T2", .operator_name = "Rossi", .notes = "new tyre"});
    finish_next(ledger);
    const auto rows = rig::record::read_ledger(path, "brake7");
    CHECK(rows[0].summary.specimen == rig::record::Specimen{.brake = "B1", .disc = "D7", .operator_name = "Rossi"});
    CHECK(rows[1].summary.specimen == ledger.specimen());
    CHECK(rig::record::read_campaigns(path)[0].specimen == ledger.specimen());
    CHECK(rig::record::to_text(rows[0].summary.specimen) == "brake B1, disc D7, operator Rossi");
}

TEST_CASE("Another brake or disc in a campaign is refused unless it is meant", "[BRG-270]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "campaign.sqlite";
    rig::record::Ledger ledger(path);
    ledger.open_campaign(campaign_of({.disc = "D7"}), rig::record::IfChanged::reject);
    CHECK_NOTHROW(ledger.open_campaign(campaign_of({.brake = "B1"}), rig::record::IfChanged::reject));
    CHECK_THROWS_WITH(ledger.open_campaign(campaign_of({.disc = "D8"}), rig::record::IfChanged::reject), ContainsSubstring("disc was D7, is D8"));
    CHECK_THROWS_WITH(ledger.open_campaign(campaign_of({.brake = "B2"}), rig::record::IfChanged::reject), ContainsSubstring("brake was B1, is B2"));
    CHECK(rig::record::read_campaigns(path)[0].specimen == rig::record::Specimen{.brake = "B1", .disc = "D7"});
    const rig::record::Resumed resumed = ledger.open_campaign(campaign_of({.disc = "D8"}), rig::record::IfChanged::go_on);
    CHECK(resumed.changed == std::vector<std::string>{"disc was D7, is D8"});
    CHECK(ledger.specimen() == rig::record::Specimen{.brake = "B1", .disc = "D8"});
}

TEST_CASE("Energy is counted disc by disc", "[BRG-270]") {
    rig::record::DiscEnergy energy;
    CHECK(energy.after({.disc = "D7"}, 1.0) == 1.0);
    CHECK(energy.after({.disc = "D7"}, 3.0) == 3.0);
    CHECK(energy.after({.disc = "D8"}, 4.0) == 1.0);
    CHECK(energy.after({.brake = "B2", .disc = "D8"}, 9.0) == 5.0);
    CHECK(energy.after({.disc = "D7"}, 10.0) == 4.0);
}

TEST_CASE("What people note afterwards holds, and nothing is overwritten", "[BRG-270]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "campaign.sqlite";
    {
        rig::record::Ledger ledger(path);
        CHECK_THROWS_WITH(ledger.note(1, 1, {}), ContainsSubstring("no campaign is open"));
        ledger.open_campaign(campaign_of({.disc = "D7", .notes = "first"}), rig::record::IfChanged::reject);
        finish_next(ledger);
        ledger.note(1, 1, {.field = "disc_serial", .text = "D8", .who = "A. Rossi", .made = "t8"});
        ledger.note(1, 1, {.field = "notes", .text = "second", .who = "B", .made = "t9"});
        const auto rejected = [&](std::int64_t number, const rig::record::Note& note, const char* why) {
            CHECK_THROWS_WITH(ledger.note(number, 1, note), ContainsSubstring(why));
        };
        rejected(2, {.field = "notes", .text = "x", .who = "B"}, "maneuver 2, attempt 1 is not in campaign");
        rejected(1, {.field = "wheel", .text = "x", .who = "B"}, "nothing is called 'wheel'");
        rejected(1, {.field = "notes", .text = "", .who = "B"}, "only with who and what");
        rejected(1, {.field = "notes", .text = "x", .who = ""}, "only with who and what");
        rejected(1, {.field = "notes", .text = "x\ny", .who = "B"}, "notes: byte 2");
    }
    const auto rows = rig::record::read_ledger(path, "brake7");
    CHECK(rows[0].summary.specimen == rig::record::Specimen{.disc = "D8", .notes = "first; second"});
    CHECK(rows[0].recorded == rig::record::Specimen{.disc = "D7", .notes = "first"});
    REQUIRE(rows[0].notes.size() == 2);
    CHECK(rows[0].notes[0].who == "A. Rossi");
    CHECK(rows[0].notes[1].made == "t9");
}

TEST_CASE("Wear that people read after a maneuver is a note; the newest holds", "[BRG-270]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "campaign.sqlite";
    {
        rig::record::Ledger ledger(path);
        ledger.open_campaign(campaign_of({}), rig::record::IfChanged::reject);
        finish_next(ledger);
        finish_next(ledger);
        ledger.note(2, 1, {.field = "lining_worn", .text = "0.31", .who = "A. Rossi", .made = "t8"});
        ledger.note(2, 1, {.field = "tread_worn", .text = "-0.01", .who = "A. Rossi", .made = "t8"});
        ledger.note(2, 1, {.field = "lining_worn", .text = "0.13", .who = "A. Rossi", .made = "t9"});
        ledger.note(1, 1, {.field = "lining_worn", .text = "0.13", .who = "B", .made = "t9"});
        ledger.note(1, 1, {.field = "lining_worn", .text = "none", .who = "B", .made = "t9"});  // it was the other maneuver
        for (const char* const bad : {"31", "1.21", "-0.11", "nan", "a third", "0.31 mm", ""})
            CHECK_THROWS(ledger.note(2, 1, {.field = "lining_worn", .text = bad, .who = "B"}));
        CHECK_THROWS_WITH(ledger.note(2, 1, {.field = "tread_worn", .text = "31", .who = "B"}),
                          ContainsSubstring("tread_worn: '31' is no worn share"));
    }
    const auto rows = rig::record::read_ledger(path, "brake7");
    CHECK(std::isnan(rows[0].worn.lining));
    CHECK(std::isnan(rows[0].worn.tread));
    CHECK(rows[1].worn.lining == 0.13);
    CHECK(rows[1].worn.tread == -0.01);
    CHECK(rows[1].notes.size() == 3);
}

TEST_CASE("Notes of a ledger of schema 6 are kept", "[BRG-223]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "campaign.sqlite";
    {
        rig::record::Ledger ledger(path);
        ledger.open_campaign(campaign_of({}), rig::record::IfChanged::reject);
        finish_next(ledger);
    }
    {
        sqlite3* database = nullptr;
        REQUIRE(sqlite3_open(path.c_str(), &database) == SQLITE_OK);
        CHECK(sqlite3_exec(
                  database,
                  "CREATE TABLE said (id INTEGER PRIMARY KEY, maneuver INTEGER NOT NULL, field TEXT NOT NULL, text TEXT NOT NULL, who TEXT NOT "
                  "NULL, made TEXT NOT NULL) STRICT;"
                  "INSERT INTO said (maneuver, field, text, who, made) VALUES (1, 'disc_serial', 'D8', 'A. Rossi', 't8');"
                  "DROP TABLE noted; PRAGMA user_version = 6",
                  nullptr, nullptr, nullptr) == SQLITE_OK);
        sqlite3_close(database);
    }
    CHECK(rig::record::read_ledger(path, "brake7")[0].summary.specimen.disc == "D8");
    rig::record::Ledger(path).choose("brake7");
    const auto rows = rig::record::read_ledger(path, "brake7");
    CHECK(rows[0].summary.specimen.disc == "D8");
    CHECK(rows[0].notes[0].who == "A. Rossi");
}

TEST_CASE("A summary keeps its specimen, and an older one has none", "[BRG-270]") {
    const TempDir dir;
    const auto path = dir.write("summary.json", "");
    rig::record::Summary s;
    s.campaign = "brake7";
    s.number = 1;
    s.scenario = "light";
    s.outcome = "finished";
    s.specimen = {.brake = "B1", .disc = "D\"7\\", .tyre = "T", .specimen = "S", .operator_name = "Zoë", .notes = "a, b"};
    rig::record::write_summary(path, s);
    CHECK(rig::record::read_summary(path).specimen == s.specimen);
    CHECK_THAT(rig::record::summary_table(s), ContainsSubstring("notes                   a, b"));
    std::string old = can_test::contents(path);
    for (const rig::record::SpecimenField& field : rig::record::kSpecimenFields) {
        const auto begin = old.find(std::string("  \"") + field.key);
        REQUIRE(begin != std::string::npos);
        old.erase(begin, old.find('\n', begin) - begin + 1);
    }
    CHECK(rig::record::read_summary(dir.write("summary.json", old)).specimen == rig::record::Specimen{});
}
