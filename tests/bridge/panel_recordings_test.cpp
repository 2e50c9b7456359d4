// Recorded maneuvers as the panel asks for them. [STUDY-190]
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "firmware/can/load_layout.hpp"
#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/json.hpp"
#include "rig_bridge/bridge/panel_recordings.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "tests/catch.hpp"

using rig::bridge::PanelRecordings;

namespace {

std::filesystem::path campaign() {
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / "panel_recordings_test";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    rig::record::Ledger ledger(folder / "campaign.sqlite");
    (void)ledger.open_campaign({.name = "c", .scenario = "heavy", .seed = 1, .planned = 2, .config_hash = "h", .version = "v", .created = "now"},
                               rig::record::IfChanged::reject);
    rig::record::Summary summary;
    summary.campaign = "c";
    summary.number = 1;
    summary.scenario = "heavy";
    summary.outcome = "finished";
    summary.figures.length_m = 200.5;
    (void)ledger.begin(1, "2026-11-26T00:00:00Z", 0.24);
    ledger.finish(summary);
    return folder;
}

}  // namespace

TEST_CASE("maneuvers without a ledger are their folders with a summary", "[STUDY-190]") {
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / "panel_folders_test";
    std::filesystem::remove_all(folder);
    rig::record::Summary summary;
    summary.number = 1;
    summary.scenario = "heavy";
    for (const char* const place : {"a", "night/0001", "deeper/than/two"}) {
        std::filesystem::create_directories(folder / place);
        summary.outcome = *place == 'a' ? "finished" : "recording_broken";
        summary.figures.length_m += 100.0;
        rig::record::write_summary(folder / place / "summary.json", summary);
    }
    const auto layout = antiskid::can::load_layout("config/antiskid.dbc", "config/antiskid_binding.toml");
    const PanelRecordings recordings(folder, "config", layout);
    const auto runs = settings::parse_json(recordings.runs())["runs"];
    REQUIRE(runs.size() == 2);
    CHECK(runs[0]["campaign"] == "a");
    CHECK(runs[0]["state"] == "finished");
    CHECK(runs[1]["campaign"] == "night/0001");
    CHECK(runs[1]["number"] == 2);
    CHECK(runs[1]["state"] == "aborted: recording_broken");
    CHECK(runs[1]["figures"]["length, m"] == 200.0);
    CHECK_THROWS_WITH(recordings.run("night/0001", 2, 1), Catch::Contains("night/0001: has no bus.log"));
    CHECK_THROWS_WITH(recordings.run("../panel_folders_test/a", 1, 1), Catch::Contains("no attempt"));
    CHECK_FALSE(recordings.with_ledger());
    CHECK_THROWS_WITH(recordings.note("a", 1, 1, "A. Rossi", "text"), Catch::Contains("campaign.sqlite"));
    CHECK_FALSE(std::filesystem::exists(folder / "campaign.sqlite"));
    // One maneuver's own folder, however its path is written.
    const PanelRecordings one(folder / "a" / "", "config", layout);
    CHECK(settings::parse_json(one.runs())["runs"].at(0)["figures"]["length, m"] == 100.0);
    std::filesystem::remove_all(folder);
}

TEST_CASE("a damaged summary.json is named, and hides no other maneuver", "[STUDY-190]") {
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / "panel_damaged_test";
    std::filesystem::remove_all(folder);
    for (const char* const place : {"a", "b"}) std::filesystem::create_directories(folder / place);
    std::ofstream(folder / "a/summary.json") << R"({"campaign": "c",)";
    rig::record::Summary summary;
    summary.number = 1;
    summary.scenario = "heavy";
    summary.outcome = "finished";
    rig::record::write_summary(folder / "b/summary.json", summary);
    const PanelRecordings recordings(folder, "config", antiskid::can::load_layout("config/antiskid.dbc", "config/antiskid_binding.toml"));
    const auto runs = settings::parse_json(recordings.runs())["runs"];
    REQUIRE(runs.size() == 2);
    CHECK(runs[0]["state"] == "summary.json cannot be read");
    CHECK_THAT(runs[0]["configuration"]["notes"].get<std::string>(), Catch::Contains("a/summary.json"));
    CHECK(runs[0]["figures"].empty());
    CHECK(runs[1]["state"] == "finished");
    CHECK_THROWS_WITH(recordings.run("a", 1, 1), Catch::Contains("a/summary.json"));
}

TEST_CASE("attempts of a ledger, and a note to one", "[STUDY-190]") {
    const std::filesystem::path folder = campaign();
    const PanelRecordings recordings(folder, "config", antiskid::can::load_layout("config/antiskid.dbc", "config/antiskid_binding.toml"));
    auto run = settings::parse_json(recordings.runs())["runs"].at(0);
    CHECK(run["number"] == 1);
    CHECK(run["figures"]["length, m"] == 200.5);
    CHECK(run["configuration"]["slip reference"] == 0.24);
    CHECK(run["notes"].empty());
    (void)recordings.note("c", 1, 1, "A. Rossi", "tread <b>cut</b>");
    run = settings::parse_json(recordings.runs())["runs"].at(0);
    CHECK(run["notes"].at(0)["text"] == "tread <b>cut</b>");
    CHECK_THROWS_AS(recordings.note("c", 1, 1, "", "text"), rig::record::LedgerError);
    CHECK_THROWS_AS(recordings.note("c", 1, 1, "who", "two\nlines"), std::invalid_argument);
    CHECK_THROWS_AS(recordings.note("c", 7, 1, "who", "text"), rig::record::LedgerError);
    CHECK_THROWS_WITH(recordings.run("c", 1, 1), Catch::Contains("no bus.log"));
    CHECK_THROWS_WITH(recordings.run("c", 2, 1), Catch::Contains("no attempt"));
    CHECK_THROWS_AS(PanelRecordings("config", "config", {}), settings::Error);
    std::filesystem::remove_all(folder);
}
