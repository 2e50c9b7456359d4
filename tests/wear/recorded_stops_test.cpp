// The virtual rig's own curve is the truth: what is left are the sensors and the bus.
#include "plant_sim/lab/recorded_stops.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "firmware/host/settings/json.hpp"
#include "plant_sim/lab/dynamics_report.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/wear/draw.hpp"
#include "tests/catch.hpp"
#include "tests/replay/landings.hpp"

using namespace replay_test;

namespace {

const std::map<std::string, wear::Curve> kTruth{
    {"light", {1.10, -0.16, -0.06, 0.0}}, {"medium", {1.15, -0.60, 0.45, 0.0}}, {"heavy", {1.22, -1.02, 0.72, 0.20}}};

double friction_at(const wear::Curve& c, double x) {
    return c[0] + x * (c[1] + x * (c[2] + x * c[3]));
}

plant_sim::lab::StopFiles quiet() {
    return {.config = "config", .dbc = {}, .binding = {}, .warn = [](const std::string&) {}};
}

/// The curve over the measured x: the plant counts x from the prescribed brake-on speed, of which spin-up takes 0.3 %.
double truth_at(const std::string& name, double x, double measured_mps, double prescribed_mps) {
    const wear::Curve& c = kTruth.at(name);
    const double per = measured_mps / prescribed_mps;
    const double mean = c[0] + c[1] * per / 2.0 + c[2] * per * per / 3.0 + c[3] * per * per * per / 4.0;
    return friction_at(c, std::min(x * per, 1.0)) / mean;
}

std::string landing_of(const std::string& maneuver, std::uint64_t seed, const std::string& surface = "dry_asphalt") {
    auto o = scenarios::options({surface, maneuver});
    o.seed = seed;
    return landing(o);
}

std::filesystem::path write_log(const TempDir& dir, const std::string& folder, const std::string& log) {
    std::filesystem::create_directories(dir.path() / folder);
    return dir.write(folder + "/bus.log", log);
}

}  // namespace

TEST_CASE("curves learnt from bus logs of the virtual rig are its own", "[WEAR-040]") {
    const TempDir dir;
    std::vector<plant_sim::lab::StopSource> sources;
    for (const char* maneuver : {"light", "medium_b", "heavy"})
        for (std::uint64_t seed = 1; seed <= 6; ++seed) {
            const std::string folder = fmt::format("{}-{}", maneuver, seed);
            write_log(dir, folder, landing_of(maneuver, seed, seed % 2 == 0 ? "wet_asphalt" : "dry_asphalt"));
            sources.push_back({maneuver, dir.path() / folder});
        }
    const auto classes = plant_sim::lab::load_stops(sources, quiet());
    REQUIRE(classes.size() == 3);
    const std::map<std::string, double> prescribed{{"light", 49.0}, {"medium", 53.0}, {"heavy", 61.0}};
    for (const plant_sim::lab::ClassStops& c : classes) {
        INFO(c.friction_class);
        REQUIRE(c.stops.size() == 6);
        const wear::FrictionDynamics found = wear::learn_dynamics(c.stops, {});
        CHECK(found.by_stops);
        CHECK(found.order == (c.friction_class == "heavy" ? 3 : 2));
        for (const wear::StopShape& s : found.stops) CHECK(s.mean_friction == Approx(0.30).epsilon(0.01));
        // Torque comes in counts of 1 N m of some 8,000, way in edges 6 cm apart: no sample says more.
        constexpr double kResolution = 2e-4;
        int held = 0;
        for (int i = 0; i <= 20; ++i) {
            const double x = i / 20.0;
            INFO("x " << x);
            const double error = std::abs(found.at(x) - truth_at(c.friction_class, x, c.stops[0].brake_on_mps, prescribed.at(c.friction_class)));
            CHECK(error < 2.0 * found.half_width_at(x) + kResolution);
            held += error <= found.half_width_at(x) + kResolution ? 1 : 0;
            CHECK(found.half_width_at(x) < 0.005);
        }
        CHECK(held >= 18);
    }
}

TEST_CASE("a folder's summary says which maneuver it was; what was aborted is passed over", "[WEAR-040]") {
    const TempDir dir;
    const std::string log = landing_of("light", 1);
    rig::record::Summary summary;
    summary.scenario = "light";
    summary.outcome = "finished";
    for (const char* folder : {"campaign/0001", "campaign/0002", "campaign/0003"}) {
        write_log(dir, folder, log);
        rig::record::write_summary(dir.path() / folder / "summary.json", summary);
        summary.outcome = summary.outcome == "finished" ? "load lost" : "finished";
    }
    std::vector<std::string> said;
    plant_sim::lab::StopFiles files = quiet();
    files.warn = [&](const std::string& line) { said.push_back(line); };
    const auto classes = plant_sim::lab::load_stops({{"", dir.path()}}, files);
    REQUIRE(classes.size() == 1);
    CHECK(classes[0].friction_class == "light");
    CHECK(classes[0].stops.size() == 2);
    REQUIRE(said.size() == 1);
    CHECK_THAT(said[0], ContainsSubstring("load lost"));
    CHECK_THROWS_WITH(plant_sim::lab::load_stops({{"", write_log(dir, "alone", log).parent_path()}}, files), ContainsSubstring("write e.g. light="));
    CHECK_THROWS_WITH(plant_sim::lab::load_stops({{"leight", dir.path()}}, files),
                      ContainsSubstring("neither a friction class (light, medium, heavy) nor a maneuver"));
    CHECK_THROWS_WITH(plant_sim::lab::load_stops({{"light", dir.path() / "nowhere"}}, files), ContainsSubstring("is not there"));
    CHECK_THROWS_WITH(plant_sim::lab::load_stops({{"light", write_log(dir, "cut", log.substr(0, 40000))}}, files),
                      ContainsSubstring("no braking in it"));
}

TEST_CASE("of a stop's pressure counts what is above the brake's contact pressure", "[WEAR-040]") {
    const TempDir dir;
    std::filesystem::copy("config", dir.path() / "config", std::filesystem::copy_options::recursive);
    std::ofstream(dir.path() / "config/landing_gear.toml", std::ios::app)
        << "\n[brake.clamping]\ncontact_Pa = 4e5\npiston_friction = 0.0\nrun_out = 0.0\nwarp = 0.0\n";
    const auto csv = dir.write("stop.csv", "time_s,speed_mps,pressure_Pa,brake_torque_Nm\n0,50,1e5,0\n1,49,1e6,900\n");
    plant_sim::lab::StopFiles files = quiet();
    files.config = dir.path() / "config";
    const auto classes = plant_sim::lab::load_stops({{"light", csv}}, files);
    REQUIRE(classes.size() == 1);
    CHECK(classes[0].stops[0].samples[0].pressure_Pa == 0.0);
    CHECK(classes[0].stops[0].samples[1].pressure_Pa == Approx(6e5));
}

TEST_CASE("a CSV is a stop when its columns say so", "[WEAR-040]") {
    const std::string head = "time_s,speed_mps,pressure_Pa,brake_torque_Nm\n";
    const wear::RecordedStop stop =
        plant_sim::lab::parse_stop("a.csv",
                                   "# "
                                   "said\nnote,pressure_Pa,time_s,brake_torque_Nm,speed_mps\nx,0,0,0,51\nx,0,1,0,50\n\nx,1e6,2,900,49\n",
                                   3e-3);
    REQUIRE(stop.samples.size() == 3);
    CHECK(stop.brake_on_mps == 50.0);
    CHECK(stop.samples[2].brake_torque_Nm == 900.0);
    const auto rejection = [](const std::string& csv) {
        try {
            (void)plant_sim::lab::parse_stop("a.csv", csv, 3e-3);
        } catch (const settings::Error& e) {
            return std::string(e.what());
        }
        return std::string("accepted");
    };
    CHECK_THAT(rejection(""), ContainsSubstring("a.csv: empty"));
    CHECK_THAT(rejection(head), ContainsSubstring("no row"));
    CHECK_THAT(rejection("time_s,speed,pressure_Pa,brake_torque_Nm\n"), ContainsSubstring("a.csv:1: speed_mps: no such column"));
    CHECK_THAT(rejection(head + "0,50,1e6,nan\n"), ContainsSubstring("a.csv:2: brake_torque_Nm: 'nan'"));
    CHECK_THAT(rejection(head + "0,50,1e6\n"), ContainsSubstring("a.csv:2: has 3 fields"));
    CHECK_THAT(rejection(head + "1,50,1e6,9\n0,50,1e6,9\n"), ContainsSubstring("a.csv:3: time_s"));
    CHECK_THAT(rejection(head + "0,50,0,0\n1,49,0,0\n"), ContainsSubstring("no pressure"));
}

TEST_CASE("the plant takes learnt curves over, class by class, and refuses what is none", "[WEAR-040]") {
    const TempDir dir;
    plant_sim::lab::ClassDynamics learnt;
    learnt.data.friction_class = "heavy";
    learnt.data.stops.resize(3);
    learnt.found.curve = {1.3, -0.9, 0.45, 0.0};
    learnt.found.order = 2;
    rig::ManeuverChoice choice;
    choice.friction_curves = dir.write("curves.toml", plant_sim::lab::to_toml({learnt}, {"c", "d"}));
    const rig::LoadedRig with = rig::load_rig("config", choice);
    for (std::size_t k = 0; k < 4; ++k) CHECK(with.rig.friction_curve[k] == Approx(0.30 * learnt.found.curve[k]));
    CHECK(with.friction_class == "heavy");
    CHECK(std::count(with.files.begin(), with.files.end(), choice.friction_curves) == 1);
    choice.maneuver = "light";
    CHECK(rig::load_rig("config", choice).rig.friction_curve[0] == Approx(0.30 * 1.10));
    choice.friction_curves = dir.write("zero.toml", "[brake.relative_friction]\nheavy = [1.0, -2.0, 0.0, 0.0]\n");
    CHECK_THROWS_WITH(rig::load_rig("config", choice), ContainsSubstring("zero.toml:2: brake.relative_friction.heavy: falls to zero"));
    choice.friction_curves = dir.write("none.toml", "[brake.relative_friction]\nhaevy = [1.0, 0.0, 0.0, 0.0]\n");
    CHECK_THROWS_WITH(rig::load_rig("config", choice), ContainsSubstring("none.toml:2: brake.relative_friction.haevy"));
    choice.friction_curves = dir.write("empty.toml", "[brake.relative_friction]\n");
    CHECK_THROWS_WITH(rig::load_rig("config", choice), ContainsSubstring("expected one or more of light, medium, heavy"));
}

TEST_CASE("the report's JSON has what was learnt", "[WEAR-011]") {
    const TempDir dir;
    const auto classes = plant_sim::lab::load_stops({{"medium", write_log(dir, "one", landing_of("medium_a", 4))}}, quiet());
    plant_sim::lab::ClassDynamics learnt{classes.at(0), wear::learn_dynamics(classes.at(0).stops, {}), kTruth.at("medium")};
    const auto json = settings::parse_json(plant_sim::lab::to_json({learnt}, {"c", "d"}));
    CHECK(json["config_hash"] == "c");
    CHECK(json["classes"][0]["class"] == "medium");
    CHECK(json["classes"][0]["coefficients"].get<wear::Curve>() == learnt.found.curve);
    CHECK(json["classes"][0]["half_widths_95"].get<wear::Curve>() == learnt.found.half_width);
    CHECK(json["classes"][0]["orders"].size() == 4);
    CHECK(json["classes"][0]["greatest_difference_from_in_force"].get<double>() < 0.01);
    CHECK_THAT(plant_sim::lab::to_text({learnt}), ContainsSubstring("medium"));
}
