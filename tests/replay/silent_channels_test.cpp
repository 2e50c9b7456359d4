// Channels of a recording that fall silent: what is held must not pass for what was measured.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "rig_bridge/record/meter.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "tests/catch.hpp"
#include "tests/replay/imports.hpp"

using namespace replay_test;

namespace {

double brake_on_s() {
    for (const Row& row : truth().rows)
        if (row.pressure_Pa >= 3e5) return row.time_s;
    return 0.0;
}

/// One stop, with the cell of `column` (0: time) empty where `empty(time since brake-on, row)`.
template <class Empty>
std::string with_empty_cells(std::size_t column, double shift_s, Empty empty) {
    std::string csv;
    std::size_t n = 0;
    for (const Row& row : truth().rows) {
        std::string line = csv_row(row, shift_s);
        std::size_t from = 0;
        for (std::size_t i = 0; i < column; ++i) from = line.find(';', from) + 1;
        if (empty(row.time_s - brake_on_s(), n++)) line.erase(from, line.find_first_of(";\n", from) - from);
        csv += line;
    }
    return csv;
}

constexpr std::size_t kWheelColumn = 1, kFlywheelColumn = 2, kPressureColumn = 3, kLoadColumn = 4, kTorqueColumn = 5;

bool by_speeds(const Import& import, std::size_t i) {
    const auto warnings = rig::record::read_summary(import.report.maneuvers.at(i).folder / "summary.json").warnings;
    return std::any_of(warnings.begin(), warnings.end(), [](const auto& text) { return text.starts_with(rig::record::kEnergyBySpeeds); });
}

}  // namespace

TEST_CASE("a load cell that falls silent is not taken for one that reads the same: the speeds give the energy", "[BRG-350]") {
    const TempDir dir;
    rig::replay::ImportMap map = example();
    map.after_s = 0.1;
    const double energy_J = truth().figures.energy_brake_J;
    const auto import = [&](const std::string& csv) { return std::make_unique<Import>(dir.write("r.csv", kHead + csv), map); };
    const auto three_s = [](double since_s, std::size_t) { return since_s >= -0.05 && since_s < 3.0; };
    for (const std::size_t column : {kTorqueColumn, kLoadColumn}) {
        CAPTURE(column);
        const auto silent = import(with_empty_cells(column, 0.0, three_s));
        REQUIRE(silent->report.maneuvers.size() == 1);
        CHECK(silent->report.maneuvers[0].outcome == "finished");
        CHECK(silent->report.maneuvers[0].figures.energy_brake_J == Approx(energy_J).epsilon(0.01));
        CHECK(by_speeds(*silent, 0));
        CHECK(silent->counts.at("silent") == 1);
        CHECK_THAT(silent->said, ContainsSubstring(fmt::format("silent: column '{}'", column == kTorqueColumn ? "M_Bremse" : "F_z")));
        CHECK(silent->rebuilt().different() == 0);
    }
    // From some place in the braking to its end, and through a whole maneuver, the first or a later one.
    const auto late = import(with_empty_cells(kTorqueColumn, 0.0, [](double since_s, std::size_t) { return since_s > 2.0; }));
    CHECK(late->report.maneuvers.at(0).figures.energy_brake_J == Approx(energy_J).epsilon(0.01));
    CHECK(by_speeds(*late, 0));
    const auto always = [](double, std::size_t) { return true; };
    const auto never = [](double, std::size_t) { return false; };
    for (const std::size_t whole : {std::size_t{0}, std::size_t{1}}) {
        CAPTURE(whole);
        const auto two = import(whole == 0 ? with_empty_cells(kTorqueColumn, 0.0, always) + with_empty_cells(kTorqueColumn, 30.0, never)
                                           : with_empty_cells(kTorqueColumn, 0.0, never) + with_empty_cells(kTorqueColumn, 30.0, always));
        REQUIRE(two->report.maneuvers.size() == 2);
        for (std::size_t i = 0; i < 2; ++i) {
            CHECK(two->report.maneuvers[i].figures.energy_brake_J == Approx(energy_J).epsilon(0.02));
            CHECK(by_speeds(*two, i) == (i == whole));
        }
    }
}

TEST_CASE("without a speed or the pressure there is no maneuver to measure, which a silent channel breaks as a gap does", "[BRG-350]") {
    const TempDir dir;
    for (const std::size_t column : {kWheelColumn, kFlywheelColumn, kPressureColumn}) {
        CAPTURE(column);
        const auto third = [](double since_s, std::size_t) { return since_s >= 2.0 && since_s < 2.3; };
        const Import import(dir.write("r.csv", kHead + with_empty_cells(column, 0.0, third)), example());
        REQUIRE(import.report.maneuvers.size() == 1);
        CHECK(import.report.maneuvers[0].outcome == "recording_broken");
        CHECK(import.report.maneuvers[0].figures.duration_s < 2.2);
        CHECK(import.counts.at("silent") == 1);
        CHECK_THAT(import.said, ContainsSubstring("has had no number for") && ContainsSubstring("longest_gap_s"));
        // Shorter than a gap may be: it goes on.
        const auto brief = [](double since_s, std::size_t) { return since_s >= 2.0 && since_s < 2.04; };
        const Import whole(dir.write("r.csv", kHead + with_empty_cells(column, 0.0, brief)), example());
        REQUIRE(whole.report.maneuvers.size() == 1);
        CHECK(whole.report.maneuvers[0].outcome == "finished");
        CHECK(whole.counts.count("silent") == 0);
    }
    // Before its first number a channel is not 0: the wheel would stand on a rim that turns.
    const Import late(dir.write("r.csv", kHead + with_empty_cells(kWheelColumn, 0.0, [](double since_s, std::size_t) { return since_s < 1.0; })),
                      example());
    CHECK(late.report.maneuvers.empty());
}

TEST_CASE("a slow channel in a table of fast ones is held from number to number", "[BRG-350]") {
    const TempDir dir;
    const auto slow = [](double, std::size_t row) { return row % 50 != 0; };  // 10 Hz of 500
    for (const std::size_t column : {kTorqueColumn, kLoadColumn, kPressureColumn}) {
        CAPTURE(column);
        rig::replay::ImportMap map = example();
        map.after_s = 0.1;
        map.longest_gap_s = 0.12;
        const Import import(dir.write("r.csv", kHead + with_empty_cells(column, 0.0, slow)), map);
        REQUIRE(import.report.maneuvers.size() == 1);
        CHECK(import.report.maneuvers[0].outcome == "finished");
        CHECK(import.report.maneuvers[0].figures.energy_brake_J == Approx(truth().figures.energy_brake_J).epsilon(0.02));
        CHECK_FALSE(by_speeds(import, 0));
        CHECK(import.counts.count("silent") == 0);
    }
}

TEST_CASE("load cells that fall silent in a log of frames are not held either", "[BRG-360]") {
    const TempDir dir;
    std::string bus = can_test::replaced(can_test::contents("config/import_bus_example.toml"), "foreign.dbc",
                                         std::filesystem::absolute("config/antiskid.dbc").string());
    bus = can_test::replaced(bus, "foreign_binding.toml", std::filesystem::absolute("config/antiskid_binding.toml").string());
    rig::replay::ImportMap map = rig::replay::load_import_map(dir.write("map.toml", can_test::replaced(bus, "after_s = 0.5", "after_s = 0.05")));
    const std::string cells = fmt::format(" {:03X}#", can_test::ours()[antiskid::can::Role::load_cells].id);
    std::string whole;
    std::string text;
    std::size_t seen = 0;
    const auto lines = lines_of(landing(scenarios::options({"dry_asphalt", "endurance"}, "deceleration")));
    for (const std::string& each : lines) {
        ++seen;
        whole += each;
        const bool silent = seen > lines.size() / 4 && seen < lines.size() / 2;
        if (!silent || each.find(cells) == std::string::npos) text += each;
    }
    const Import complete(dir.write("whole.log", whole), map);
    REQUIRE(complete.report.maneuvers.size() == 1);
    CHECK_FALSE(by_speeds(complete, 0));
    CHECK(complete.counts.count("silent") == 0);
    const Import import(dir.write("cut.log", text), map);
    REQUIRE(import.report.maneuvers.size() == 1);
    CHECK(import.report.maneuvers[0].figures.energy_brake_J == Approx(complete.report.maneuvers[0].figures.energy_brake_J).epsilon(0.01));
    CHECK(by_speeds(import, 0));
}
