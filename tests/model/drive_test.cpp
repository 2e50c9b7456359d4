/// Open loop from a table: what is read, what is written, and that it is the plant's motion.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "plant_sim/study/drive.hpp"
#include "tests/catch.hpp"
#include "tests/model/reference/profiles.hpp"
#include "tests/model/scenarios.hpp"
#include "tests/settings/refusal.hpp"

namespace {

using study::DriveInput;

study::DriveProfile read(const std::string& text) {
    const TemporaryDirectory directory;
    put(directory / "in.csv", text);
    return study::read_profile(directory / "in.csv");
}

settings::Error rejected(const std::string& text) {
    return rejection_of([&] { return read(text); });
}

/// The table as numbers; the header is checked.
std::vector<std::vector<double>> table(const std::string& csv) {
    std::istringstream in(csv);
    std::string line;
    std::getline(in, line);
    CHECK(line ==
          "time_s,speed_mps,wheel_speed_radps,slip,pressure_Pa,brake_torque_Nm,F_x_N,F_z_N,radius_m,mu,"
          "energy_brake_J,"
          "energy_tyre_J");
    std::vector<std::vector<double>> rows;
    while (std::getline(in, line)) {
        std::vector<double> row;
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
        REQUIRE(row.size() == 12);
        rows.push_back(row);
    }
    return rows;
}

enum Column { kTime, kSpeed, kOmega, kSlip, kPressure, kTorque, kF_x, kF_z, kRadius, kMu, kBrake_J, kTyre_J };

}  // namespace

TEST_CASE("drive: every bad input names its line", "[RIG-090]") {
    const std::string good = "time_s,pressure_Pa\n0,0\n";
    struct Bad {
        std::string text;
        std::uint32_t line;
        const char* says;
    };
    for (const Bad& bad : std::vector<Bad>{
             {"", 0, "empty"},
             {"\n\n", 2, "empty"},
             {"time_s\n", 1, "expected time_s,pressure_Pa"},
             {"time_s,pressure_bar\n0,0\n1,1\n", 1, "pressure_bar"},
             {"time_ms,pressure_Pa\n0,0\n1,1\n", 1, "time_ms"},
             {"pressure_Pa,time_s\n0,0\n1,1\n", 1, "expected time_s"},
             {"time_s,pressure_Pa,more\n0,0\n1,1\n", 1, "expected time_s"},
             {"0,0\n1,1\n", 1, "expected time_s"},
             {good, 2, "two rows"},
             {good + "1\n", 3, "two columns"},
             {good + "1,2,3\n", 3, "two columns"},
             {good + "1;2\n", 3, "two columns"},
             {good + "1,\n", 3, "pressure_Pa"},
             {good + ",1\n", 3, "time_s"},
             {good + "one,1\n", 3, "'one'"},
             {good + "1,1e6Pa\n", 3, "'1e6Pa'"},
             {good + "1,nan\n", 3, "'nan'"},
             {good + "1,inf\n", 3, "'inf'"},
             {good + "1,1e999\n", 3, "'1e999'"},
             {good + "1,-1\n", 3, "from 0 to"},
             {good + "1,2e8\n", 3, "from 0 to 1e+08"},
             {good + "0,1\n", 3, "increase"},
             {good + "1,1\n\n0.5,1\n", 5, "increase"},
             {good + "1,1\r\n2,x\r\n", 4, "'x'"},
             {"time_s,current_mA\n0,0\n1,-3\n", 3, "current_mA"},
             {good + "1e9,0\n", 3, "3600"},
         }) {
        CAPTURE(bad.text);
        const settings::Error error = rejected(bad.text);
        INFO(error.what());
        CHECK_THAT(error.what(), ContainsSubstring(bad.says));
        CHECK_THAT(error.what(), ContainsSubstring("in.csv"));
        CHECK(error.line() == bad.line);
    }
    CHECK_THAT(rejection_of([] { return study::read_profile("no/such.csv"); }).what(), ContainsSubstring("no/such.csv"));
    CHECK_THROWS_AS(study::read_profile("config"), settings::Error);
}

TEST_CASE("drive: what is well-formed is read, with blank lines, spaces, CRLF and a byte order mark", "[RIG-090]") {
    const auto p = read("\xEF\xBB\xBFtime_s , current_mA\r\n\r\n-1.5, 3\r\n 0 ,4e0\r\n2.5,12.25");
    CHECK(p.input == DriveInput::current_mA);
    CHECK(p.time_s == std::vector<double>{-1.5, 0.0, 2.5});
    CHECK(p.value == std::vector<double>{3.0, 4.0, 12.25});
    CHECK(read("time_s,pressure_Pa\n0,0\n1,2e6\n").input == DriveInput::pressure_Pa);
    // A start between two milliseconds is kept.
    const auto rows = table(study::drive(rig::load_rig("config", {}).rig, read("time_s,pressure_Pa\n0.0005,0\n0.0035,0\n")));
    REQUIRE(rows.size() == 4);
    for (std::size_t i = 0; i < rows.size(); ++i) CHECK(rows[i][kTime] == Approx(0.0005 + 1e-3 * static_cast<double>(i)).epsilon(1e-12));
}

TEST_CASE("drive: the table is the motion that the reference integrates", "[RIG-001][figures]") {
    for (const NamedScenario& s : all_scenarios()) {
        CAPTURE(s.name);
        const rig::RigParameters& rig = s.loaded.rig;
        const NamedProfile triangles = profiles(rig).at(1);
        study::DriveProfile profile;
        for (const reference::Knot& knot : triangles.pressure_Pa) {
            profile.time_s.push_back(knot.time_s);
            profile.value.push_back(knot.value);
        }
        const auto rows = table(study::drive(rig, profile));
        REQUIRE(rows.size() > 5000);
        double worst_v = 0.0;
        double worst_omega = 0.0;
        std::size_t at = 0;
        reference::Options options;
        options.longest_s = 60.0;
        reference::integrate(rig, reference::Input::pressure, triangles.pressure_Pa, options, [&](const reference::Motion& truth) {
            const auto& row = rows.at(at++);
            worst_v = std::max(worst_v, std::abs(row[kSpeed] / truth.v_mps - 1.0));
            worst_omega = std::max(worst_omega, std::abs(row[kOmega] / truth.omega_radps - 1.0));
        });
        CHECK(worst_v <= 1e-4);
        CHECK(worst_omega <= 1e-4);
    }
}

TEST_CASE("drive: the columns obey the equations row by row", "[RIG-001]") {
    rig::ManeuverChoice choice;
    choice.surface = "wet_asphalt";
    const rig::RigParameters rig = rig::load_rig("config", choice).rig;
    const auto rows = table(study::drive(rig, read("time_s,pressure_Pa\n0.25,0\n1.25,4e6\n60,4e6\n")));
    CHECK(rows.front()[kTime] == 0.25);
    CHECK(rows.front()[kSpeed] == rig.brake_on_mps);
    CHECK(rows.back()[kSpeed] <= 0.05);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& r = rows[i];
        REQUIRE(r[kTime] == Approx(0.25 + 1e-3 * static_cast<double>(i)).margin(1e-9));
        REQUIRE(r[kPressure] == Approx(std::min(4e6 * (r[kTime] - 0.25), 4e6)).margin(1.0));
        if (r[kSpeed] < 1.0) continue;
        REQUIRE(r[kF_z] == Approx(rig.load.base_N - rig.load.lift_Ns2pm2 * r[kSpeed] * r[kSpeed]).epsilon(1e-8));
        REQUIRE(r[kRadius] == Approx(rig.wheel.free_radius_m - r[kF_z] / rig.wheel.stiffness_Npm).epsilon(1e-8));
        REQUIRE(r[kSlip] == Approx(1.0 - r[kOmega] * r[kRadius] / r[kSpeed]).margin(1e-7));
        REQUIRE(r[kF_x] == Approx(r[kF_z] * r[kMu]).epsilon(1e-8).margin(1e-6));
        REQUIRE(r[kMu] == Approx(rig::friction(rig.surface, r[kSlip]).mu).margin(1e-7));
    }
    const double start_J = 0.5 * rig.wheel.mass_kg * std::pow(rows[0][kSpeed], 2) + 0.5 * rig.wheel.inertia_kgm2 * std::pow(rows[0][kOmega], 2);
    CHECK(rows.back()[kBrake_J] + rows.back()[kTyre_J] == Approx(start_J).epsilon(2e-6));
}

TEST_CASE("drive: driven by current it is the valve in front of the same plant", "[RIG-001]") {
    const rig::RigParameters rig = rig::load_rig("config", {}).rig;
    const auto rows = table(study::drive(rig, read("time_s,current_mA\n0,0\n0.5,3\n1.5,12\n2.5,12\n2.501,0\n3.5,0\n")));
    REQUIRE(rows.size() == 3501);
    plant::Valve valve(rig.valve, 1e-3);
    plant::Rig plant(rig, 1e-3, 9);
    plant.start_rolling();
    const auto current = [](double t) {
        if (t < 0.5) return 6.0 * t;
        if (t < 1.5) return 3.0 + 9.0 * (t - 0.5);
        if (t <= 2.5) return 12.0;
        return t < 2.501 ? 12.0 * (2.501 - t) / 1e-3 : 0.0;
    };
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const double from = current(static_cast<double>(i - 1) * 1e-3);
        const double to = current(static_cast<double>(i) * 1e-3);
        static_cast<void>(valve.advance(rig.pressure_map.pressure_Pa(from), rig.pressure_map.pressure_Pa(to)));
        plant.advance_current(from, to);
        REQUIRE(rows[i][kPressure] == Approx(valve.pressure_Pa()).epsilon(1e-6).margin(5.0));
        REQUIRE(rows[i][kSpeed] == Approx(plant.wheel().v_mps).epsilon(1e-8));
        REQUIRE(rows[i][kOmega] == Approx(plant.wheel().omega_radps).epsilon(1e-6));
    }
    CHECK(rows[1500][kPressure] > 3.5e6);
    CHECK(rows[3400][kPressure] == Approx(0.0).margin(1.0));
}

TEST_CASE("drive: a step or a knot between two rows of output acts at its own time", "[RIG-001]") {
    const rig::RigParameters rig = rig::load_rig("config", {}).rig;
    const double peak = min_peak_pressure_Pa(rig);
    for (const double at_s : {1.0, 1.0003, 1.0009}) {
        CAPTURE(at_s);
        study::DriveProfile profile;
        profile.time_s = {0.0, at_s, at_s + 1e-6, 1.5, 1.5004, 2.0};
        profile.value = {0.1 * peak, 0.1 * peak, 0.8 * peak, 0.6 * peak, 0.2 * peak, 0.2 * peak};
        reference::Profile knots;
        for (std::size_t i = 0; i < profile.time_s.size(); ++i) knots.push_back({profile.time_s[i], profile.value[i]});
        const auto rows = table(study::drive(rig, profile));
        std::size_t at = 0;
        double worst = 0.0;
        reference::Options options;
        options.longest_s = 2.0;
        reference::integrate(rig, reference::Input::pressure, knots, options, [&](const reference::Motion& truth) {
            worst = std::max(worst, std::abs(rows.at(at++)[kOmega] / truth.omega_radps - 1.0));
        });
        CHECK(worst <= 1e-4);
    }
}

TEST_CASE("drive: rows that miss a millisecond by rounding alone, and a step between two of them, change nothing", "[RIG-001]") {
    const rig::RigParameters rig = rig::load_rig("config", {}).rig;
    const double peak = min_peak_pressure_Pa(rig);
    constexpr int kStep = 700;
    for (const double off_s : {-1e-10, -1e-13, 1e-16, 1e-13, 1e-10}) {
        CAPTURE(off_s);
        study::DriveProfile whole, rounded;
        for (int i = 0; i <= 1500; ++i) {
            whole.time_s.push_back(i * 1e-3);
            whole.value.push_back((i <= kStep ? 2e-4 : 4e-4) * i * peak);
            rounded.time_s.push_back(whole.time_s.back() + (i % 3 == 0 ? 0.0 : off_s));
            rounded.value.push_back(whole.value.back());
            if (i != kStep) continue;
            for (auto* profile : {&whole, &rounded}) {
                profile->time_s.push_back(profile->time_s.back() + (profile == &whole ? 1e-6 : 1e-12));
                profile->value.push_back(4e-4 * i * peak);
            }
        }
        const auto expected = table(study::drive(rig, whole));
        const auto rows = table(study::drive(rig, rounded));
        REQUIRE(rows.size() == expected.size());
        double worst = 0.0;
        for (std::size_t i = 0; i < rows.size(); ++i) worst = std::fmax(worst, std::abs(rows[i][kOmega] / expected[i][kOmega] - 1.0));
        CHECK(worst <= 1e-5);
        CHECK(std::ranges::none_of(rows, [](const std::vector<double>& row) { return std::isnan(row[kOmega]); }));
    }
}
