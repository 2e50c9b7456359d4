// Stops that are tried from the panel. [STUDY-190]
#include <map>
#include <string>

#include "firmware/host/settings/json.hpp"
#include "plant_sim/lab/panel_stops.hpp"
#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/in_process.hpp"
#include "tests/catch.hpp"

using namespace plant_sim::lab;
using rig::panel::Query;

namespace {

std::multimap<std::string, std::string> heavy() {
    return {{"maneuver", "heavy"}, {"surface", "dry_asphalt"}, {"law", "slip"}, {"slip", "0.24"}, {"speed", "61"}, {"friction", "0.30"}};
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

TEST_CASE("a runway is tried as a surface is", "[STUDY-190]") {
    PanelStops stops("config");
    const auto distance_m = [&](const std::string& road) {
        auto query = heavy();
        query.erase("surface");
        query.emplace("surface", road);
        return settings::Json::parse(stops.stop(Query(query)))["figures"]["stop distance, m"].get<double>();
    };
    plant_sim::StopOptions options;
    options.choice.runway = "config/runways/wet_middle.toml";
    options.choice.speed_mps = 61.0;
    options.choice.friction = 0.30;
    const plant_sim::StopInputs inputs = plant_sim::load_scenario(options);
    const auto stop = study::run_in_process(inputs.controller, inputs.layout, inputs.plant.rig, inputs.session, study::Link::rounded);
    CHECK(distance_m("runway wet_middle") == stop.figures.stop_distance_m);
    CHECK(distance_m("dry_concrete") < distance_m("runway wet_middle"));
    CHECK_THROWS_WITH(distance_m("wet_middle"), Catch::StartsWith("surface: expected one of"));
    CHECK_THROWS_WITH(distance_m("runway ../../config/runways/wet_middle"), Catch::StartsWith("surface: expected one of"));
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
