// The plant that made the log is the truth: what is left are the sensors.
#include "plant_sim/study/validation/plant_validation.hpp"

#include <cmath>

#include "firmware/host/settings/json.hpp"
#include "tests/catch.hpp"
#include "tests/replay/landings.hpp"

using namespace replay_test;

namespace {

validation::Validation validate(const std::filesystem::path& log, const plant_sim::StopOptions& options) {
    const plant_sim::StopInputs s = plant_sim::load_scenario(options);
    rig::replay::LogWarnings warnings("bus.log", {});
    rig::replay::LogOptions of_log;
    of_log.layout = &s.layout;
    rig::replay::LogReader reader(log, of_log, warnings);
    rig::replay::MeasuredSignals signals(reader, s.layout, 1e-3);
    return validation::validate_plant(signals, s.plant.rig);
}

plant_sim::StopOptions stop(const std::string& maneuver, const std::string& surface, double slip) {
    auto o = scenarios::options({surface, maneuver});
    o.slip = slip;
    if (maneuver == rig::kEndurance) o.law = "deceleration";
    return o;
}

/// RMS of a mean speed between two edges, each stamped with the encoder's jitter of 1 us, in a window of 10 ms; the
/// largest of a thousand such stays below four and a half times that.
double resolution_mps(double speed_mps) {
    return speed_mps * std::sqrt(2.0) * 1e-6 / 0.01;
}

}  // namespace

TEST_CASE("on a log of the virtual rig speed and slip agree to the resolution of its sensors", "[BRG-320]") {
    const TempDir dir;
    for (const auto& options : {stop("heavy", "dry_asphalt", 0.06), stop("light", "dry_asphalt", 0.06), stop("endurance", "dry_asphalt", 0.0)}) {
        INFO(options.choice.maneuver);
        const validation::Validation v = validate(dir.write("bus.log", landing(options)), options);
        REQUIRE(v.braked);
        CHECK(v.lockstep);
        CHECK(v.ended == "standstill of the simulation");
        CHECK(v.gaps == 0);
        CHECK(v.past_peak < 0.005);
        REQUIRE(v.rows.size() > 500);
        for (std::size_t i = 0; i < v.bands.size(); ++i) {
            const validation::ValidationErrors& band = v.bands[i];
            if (band.speed_mps.count < 20) continue;
            INFO("band " << i);
            const double top = static_cast<double>(i + 1) * validation::Validation::kBand_mps;
            // The start and the noise of 20 kPa on the pressure, integrated over the stop, add some mm/s.
            constexpr double kIntegrated_mps = 0.005;
            CHECK(band.speed_mps.rms() < resolution_mps(top) + kIntegrated_mps);
            CHECK(band.speed_mps.largest < 4.5 * resolution_mps(top) + kIntegrated_mps);
            CHECK(band.wheel_rim_mps.rms() < 2.0 * resolution_mps(top) + kIntegrated_mps);
            // Slip has both speeds in it, and both windows: they may lie an edge apart, which is 7 ms at 5 m/s.
            CHECK(band.slip.rms() < (i == 0 ? 1e-3 : 5e-4));
            CHECK(band.speed_mps.rms() > 0.0);
        }
    }
}

TEST_CASE("a brake that is 3 % weaker than the recorded one shows", "[BRG-320]") {
    const TempDir dir;
    const auto options = stop("endurance", "dry_asphalt", 0.0);
    auto weaker = options;
    weaker.choice.friction = 0.97 * 0.30;
    const validation::Validation v = validate(dir.write("bus.log", landing(options)), weaker);
    CHECK(v.all.speed_mps.largest > 0.5);
    CHECK(v.all.speed_mps.rms() > 20.0 * resolution_mps(30.0));
}

TEST_CASE("slip beyond the peak of the friction curve is told", "[BRG-320]") {
    const TempDir dir;
    const auto options = stop("light", "dry_asphalt", 0.24);
    const validation::Validation v = validate(dir.write("bus.log", landing(options)), options);
    CHECK(v.past_peak > 0.5);
    CHECK_THAT(validation::to_text(v), ContainsSubstring("unstable"));
}

TEST_CASE("without SYNC the stamps are the time; lost samples are gaps", "[BRG-320]") {
    const TempDir dir;
    const auto options = stop("light", "dry_asphalt", 0.06);
    std::string text;
    for (const std::string& line : lines_of(landing(options))) {
        const double time = std::stod(line.substr(1));
        if (line.find(" 080#") != std::string::npos || (time > 3.0 && time < 3.1)) continue;
        text += line;
    }
    const validation::Validation v = validate(dir.write("bus.log", text), options);
    CHECK_FALSE(v.lockstep);
    CHECK(v.gaps == 1);
    CHECK(v.longest_gap_s == Approx(0.101));
    CHECK(v.all.speed_mps.rms() < resolution_mps(50.0) + 0.005);
    CHECK_THAT(validation::to_text(v), ContainsSubstring("1 gaps"));
}

TEST_CASE("a log without a braking says so; reports hold their rows", "[BRG-320]") {
    const TempDir dir;
    const auto options = stop("light", "dry_asphalt", 0.06);
    const std::string text = landing(options);
    CHECK_FALSE(validate(dir.write("bus.log", text.substr(0, text.find("(0000000001.4"))), options).braked);
    const validation::Validation v = validate(dir.write("bus.log", text), options);
    const auto json = settings::parse_json(validation::to_json(v, R"({"log": "x"})"));
    CHECK(json["log"] == "x");
    CHECK(json["bands"].size() == v.bands.size());
    CHECK(json["all"]["speed_mps"]["rms"].get<double>() == v.all.speed_mps.rms());
    CHECK(lines_of(validation::to_csv(v)).size() == v.rows.size() + 1);
}
