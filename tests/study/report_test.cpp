#include "plant_sim/study/report.hpp"

#include "firmware/host/settings/json.hpp"
#include "plant_sim/study/drive.hpp"
#include "tests/catch.hpp"

TEST_CASE("result.json has the keys that users read, and the faults by name", "[STUDY-030]") {
    study::StopReport report;
    report.figures.stop_distance_m = 197.4;
    report.figures.valve_travel_mAps = 41.2;
    report.faults.insert(antiskid::control::Fault::wheel_lost);
    report.seed = 7;
    const auto json = settings::parse_json(study::to_json(report));
    for (const char* key : {"stop_distance_m", "duration_s", "j_mu", "energy_brake_J", "energy_tyre_J", "energy_residual", "peak_slip",
                            "valve_travel_mAps", "frames_sent", "frames_lost", "overruns", "seed", "version", "config_hash"}) {
        INFO(key);
        CHECK(json.contains(key));
    }
    CHECK(json["stop_distance_m"] == 197.4);
    CHECK(json["valve_travel_mAps"] == 41.2);
    CHECK(json["seed"] == 7);
    CHECK(json["faults"] == settings::Json::array({"wheel_lost"}));
    CHECK(study::to_table(report).find("wheel_lost") != std::string::npos);
}
