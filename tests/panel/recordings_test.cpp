// Stops that are tried from the panel, and recorded maneuvers as it asks for them. [STUDY-190]
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>

#include "firmware/can/load_layout.hpp"
#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/json.hpp"
#include "plant_sim/lab/panel_recordings.hpp"
#include "plant_sim/lab/panel_stops.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "tests/catch.hpp"

using namespace plant_sim::lab;
using rig::panel::Query;

namespace {

std::multimap<std::string, std::string> heavy() {
    return {{"maneuver", "heavy"}, {"surface", "dry_asphalt"}, {"law", "slip"}, {"slip", "0.24"}, {"speed", "61"}, {"friction", "0.30"}};
}

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

TEST_CASE("a stop that is tried is the stop of rig-lab stop", "[STUDY-190]") {
    PanelStops stops("config");
    const auto stop = settings::Json::parse(stops.stop(Query(heavy())));
    CHECK(stop["figures"]["stop distance, m"].get<double>() == Approx(197.7).margin(0.05));
    CHECK(stop["figures"]["came to rest"] == "yes");
    const auto& columns = stop["columns"];
    CHECK(columns["t"].size() > 1000);
    for (const char* const key : {"rim", "wheel", "slip", "slip_reference", "demand", "pressure", "current", "load"})
        CHECK(columns[key].size() == columns["t"].size());
}

TEST_CASE("what is not among the fields is refused by name", "[STUDY-190]") {
    PanelStops stops("config");
    const std::multimap<std::string, std::string> wrong{{"maneuver", "../heavy"}, {"surface", ""},  {"law", "open_loop"},
                                                        {"slip", "0.9"},          {"speed", "1e9"}, {"friction", "nan"}};
    for (const auto& [key, value] : wrong) {
        auto query = heavy();
        query.erase(key);
        query.emplace(key, value);
        CHECK_THROWS_WITH(stops.stop(Query(query)), Catch::StartsWith(key + ":"));
    }
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
