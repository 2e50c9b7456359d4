// Recordings made from the plant's true state: what comes out must be what was there.
#include <fmt/format.h>
#include <matio.h>

#include <cmath>

#include "firmware/host/controller_config.hpp"
#include "plant_sim/study/validation/plant_validation.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/campaign_table.hpp"
#include "rig_bridge/replay/foreign_log.hpp"
#include "rig_bridge/replay/importer.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"
#include "rig_bridge/rig/scenario.hpp"
#include "tests/catch.hpp"
#include "tests/replay/imports.hpp"

using namespace replay_test;

namespace {

void check(const rig::record::Figures& f) {
    const study::StopFigures& t = truth().figures;
    CHECK(f.standstill);
    CHECK(f.brake_on_mps == Approx(54.88).margin(0.05));
    CHECK(f.energy_brake_J == Approx(t.energy_brake_J).epsilon(5e-3));
    CHECK(f.mean_torque_Nm == Approx(t.mean_torque_Nm).epsilon(0.01));
    CHECK(f.mean_load_N == Approx(t.mean_load_N).epsilon(1e-3));
    CHECK(f.mean_friction == Approx(t.mean_friction).epsilon(0.01));
    CHECK(f.duration_s == Approx(t.duration_s).margin(0.25));
}

}  // namespace

TEST_CASE("a continuous recording becomes maneuvers, and their figures are those of the plant", "[BRG-350]") {
    const TempDir dir;
    rig::replay::ImportMap map = example();
    map.after_s = 0.1;  // the recording ends soon after standstill
    const Import import(dir.write("r.csv", two_stops()), map);
    REQUIRE(import.report.maneuvers.size() == 2);
    for (const auto& maneuver : import.report.maneuvers) {
        CHECK(maneuver.outcome == "finished");
        check(maneuver.figures);
    }
    INFO(import.said);
    // The jump from one stop to the next is a gap in time; nothing else is wrong.
    CHECK(import.counts == std::map<std::string, std::uint64_t>{{"gap", 1}});
    CHECK_THAT(import.said, ContainsSubstring("r.csv:" + std::to_string(truth().rows.size() + 4)));
    const rig::record::Summary summary = rig::record::read_summary(import.out / "0002/summary.json");
    CHECK(summary.number == 2);
    CHECK(summary.cumulative_energy_J == import.report.maneuvers[0].figures.energy_brake_J + import.report.maneuvers[1].figures.energy_brake_J);
    // Every verb works on it: the campaign is its own summaries, the plant finds the braking.
    CHECK(import.rebuilt().different() == 0);
    rig::replay::LogWarnings warnings("bus.log", {});
    rig::replay::LogOptions options;
    options.layout = &can_test::ours();
    rig::replay::LogReader reader(import.out / "0001/bus.log", options, warnings);
    rig::replay::MeasuredSignals signals(reader, can_test::ours(), 1e-3);
    const validation::Validation v = validation::validate_plant(signals, import.scenario.rig.rig);
    REQUIRE(v.braked);
    CHECK(v.all.speed_mps.rms() < 0.2);
    CHECK(v.rows.size() > 1000);
    CHECK_FALSE(warnings.any());
}

TEST_CASE("times that no log can have, as those before a trigger, give the same maneuvers, and their logs can be read", "[BRG-350]") {
    const TempDir dir;
    rig::replay::ImportMap map = example();
    map.after_s = 0.1;
    const Import usual(dir.write("r.csv", two_stops()), map);
    // From below zero across it, back below zero at a reset, and an epoch in milliseconds that is called seconds.
    for (const std::array<double, 2>& shifts_s :
         {std::array{-30.0, 0.0}, std::array{0.0, -30.0}, std::array{-1e6, -30.0}, std::array{1e10, 1e10 + 30.0}}) {
        CAPTURE(shifts_s);
        const Import import(dir.write("r.csv", two_stops(1e-5, shifts_s)), map);
        CHECK_THAT(import.said, ContainsSubstring("time_shifted"));
        CHECK(import.counts.at("time_shifted") >= 1);
        REQUIRE(import.report.maneuvers.size() == 2);
        for (std::size_t i = 0; i < 2; ++i) {
            CHECK(import.report.maneuvers[i].outcome == "finished");
            for (const rig::record::FigureField& field : rig::record::kFigureFields) {
                CAPTURE(field.key);
                CHECK(import.report.maneuvers[i].figures.*field.value ==
                      Approx(usual.report.maneuvers[i].figures.*field.value).epsilon(2e-4).margin(1e-6));
            }
        }
        const rig::replay::CampaignTable table = import.rebuilt();
        CHECK(table.counted() == 2);
        CHECK(table.different() == 0);
    }
}

TEST_CASE("what is said of the specimen at an import is that of every maneuver in it, exports included", "[BRG-270]") {
    const TempDir dir;
    rig::replay::ImportMap map = example();
    map.after_s = 0.1;
    const rig::record::Specimen said{
        .brake = "B12", .disc = "D7", .tyre = "T3", .specimen = "S-2026-4", .operator_name = "A. Rossi", .notes = "by night"};
    const Import import(dir.write("r.csv", two_stops()), map, said);
    REQUIRE(import.report.maneuvers.size() == 2);
    for (const auto& maneuver : import.report.maneuvers) CHECK(rig::record::read_summary(maneuver.folder / "summary.json").specimen == said);
    const std::string csv = to_csv(import.rebuilt());
    CHECK_THAT(csv, ContainsSubstring(",B12,D7,T3,S-2026-4,A. Rossi,by night,"));
    // Nothing is written of a text that would not be one line.
    CHECK_THROWS_WITH(Import(dir.write("r.csv", two_stops()), map, {.notes = "two\nlines"}), ContainsSubstring("control character"));
}

TEST_CASE("MATLAB files give the same maneuvers", "[BRG-350]") {
    const auto write = [](const std::filesystem::path& path, mat_ft version) {
        mat_t* const file = Mat_CreateVer(path.c_str(), nullptr, version);
        if (file == nullptr) return false;
        const auto& rows = truth().rows;
        const auto put = [&](const char* name, double Row::*member, double factor) {
            std::vector<double> values;
            for (const Row& row : rows) values.push_back(row.*member * factor);
            std::array<std::size_t, 2> dims{values.size(), 1};
            matvar_t* const variable = Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims.data(), values.data(), 0);
            const int status = Mat_VarWrite(file, variable, MAT_COMPRESSION_ZLIB);
            Mat_VarFree(variable);
            return status == 0;
        };
        const bool all = put("Zeit", &Row::time_s, 1.0) && put("n_Rad", &Row::wheel_radps, 30.0 / std::numbers::pi) &&
                         put("v_Schwungrad", &Row::v_mps, 3.6) && put("p_Bremse", &Row::pressure_Pa, 1e-5) && put("F_z", &Row::load_N, 1e-3) &&
                         put("M_Bremse", &Row::torque_Nm, 1.0);
        Mat_Close(file);
        return all;
    };
    rig::replay::ImportMap map = example();
    map.mat = true;
    const TempDir dir;
    const auto folder = dir.write("x", "").parent_path();
    for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
        const auto file = folder / (version == MAT_FT_MAT5 ? "five.mat" : "seven.mat");
        REQUIRE(write(file, version));
        const Import import(file, map);
        REQUIRE(import.report.maneuvers.size() == 1);
        check(import.report.maneuvers[0].figures);
    }
    map.channels[5]->column = "M";
    CHECK_THROWS_WITH(Import(folder / "five.mat", map), ContainsSubstring("no variable 'M'; there are: Zeit, n_Rad"));
    CHECK_THROWS_WITH(Import(dir.write("no.mat", "text"), map), ContainsSubstring("cannot be read as a MATLAB file"));
}

TEST_CASE("what is wrong in a recording is reported with row and column", "[BRG-350]") {
    const TempDir dir;
    std::vector<std::string> lines = lines_of(two_stops());
    const auto cell = [&](std::size_t row, const std::string& from, const std::string& to) {
        lines[row - 1] = can_test::replaced(lines[row - 1], from, to);
    };
    const auto pressure_of = [&](std::size_t row) {
        std::string line = lines[row - 1];
        for (int i = 0; i < 3; ++i) line.erase(0, line.find(';') + 1);
        return line.substr(0, line.find(';'));
    };
    cell(1000, ";" + pressure_of(1000) + ";", ";NaN;");
    cell(1001, ";" + pressure_of(1001) + ";", ";;");
    cell(1002, ";" + pressure_of(1002) + ";", ";9999999;");
    lines[2000] = lines[1999];
    const Import import(dir.write("r.csv",
                                  [&] {
                                      std::string text;
                                      for (const auto& line : lines) text += line;
                                      return text;
                                  }()),
                        example());
    REQUIRE(import.report.maneuvers.size() == 2);
    check(import.report.maneuvers[0].figures);
    CHECK_THAT(import.said, ContainsSubstring("r.csv:1000: not_a_number: column 4 (p_Bremse): 'NaN'"));
    CHECK_THAT(import.said, ContainsSubstring("r.csv:1001: not_a_number: column 4 (p_Bremse): ''"));
    CHECK_THAT(import.said, ContainsSubstring("r.csv:1002: implausible: column 'p_Bremse': 1e+07 bar"));
    CHECK_THAT(import.said, ContainsSubstring("r.csv:2001: time_repeated"));
}

TEST_CASE("gaps and resets of time end a maneuver, the next is whole", "[BRG-350]") {
    const TempDir dir;
    std::string csv = kHead;
    const auto& rows = truth().rows;
    for (std::size_t i = 0; i < rows.size() / 2; ++i) csv += csv_row(rows[i], 100.0);
    for (const Row& row : rows) csv += csv_row(row, 0.0);  // time starts again
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (i < 3000 || i > 3100) csv += csv_row(rows[i], 40.0);  // 0.2 s are missing
    const Import import(dir.write("r.csv", csv), example());
    REQUIRE(import.report.maneuvers.size() == 3);
    CHECK(import.report.maneuvers[0].outcome == "recording_broken");
    CHECK(import.report.maneuvers[1].outcome == "finished");
    CHECK(import.report.maneuvers[2].outcome == "recording_broken");
    check(import.report.maneuvers[1].figures);
    CHECK(import.counts.at("time_reset") == 1);
    CHECK(import.counts.at("gap") == 2);
    CHECK_THAT(import.said, ContainsSubstring("0001 while braking"));
}

TEST_CASE("swapped units end the import with the likely one, and nothing is written", "[BRG-350]") {
    const TempDir dir;
    const auto file = dir.write("r.csv", two_stops());
    const auto rejected = [&](std::size_t channel, const char* unit, const char* quantity_of, const std::string& words) {
        rig::replay::ImportMap map = example();
        map.channels[channel]->unit_name = unit;
        map.channels[channel]->unit = *antiskid::can::find_unit(quantity_of);
        map.unit_row = 0;
        CHECK_THROWS_WITH(Import(file, map), ContainsSubstring(words));
    };
    rejected(2, "Pa", "Pa", "likely unit: bar");
    rejected(2, "MPa", "MPa", "column 'p_Bremse' (pressure) goes from");
    rejected(3, "N", "N", "kN");
    rejected(1, "rpm", "rpm", "likely unit of 'v_Schwungrad': km/h");
    rejected(1, "m/s", "m/s", "km/h");
    rig::replay::ImportMap map = example();
    map.unit_row = 3;
    map.channels[5]->unit_name = "kNm";
    map.channels[5]->unit = *antiskid::can::find_unit("kNm");
    CHECK_THROWS_WITH(Import(file, map), ContainsSubstring("likely unit: Nm"));
}

TEST_CASE("a pressure in another unit than the map's shows in the friction, which is named with the likely unit", "[BRG-261]") {
    const TempDir dir;
    rig::replay::ImportMap map = example();
    map.unit_row = 0;
    CHECK_THAT(Import(dir.write("r.csv", two_stops()), map).said, !ContainsSubstring("friction"));
    // MPa that are taken for bar, and bar for psi.
    const Import tenth(dir.write("r.csv", two_stops(1e-6)), map);
    CHECK_THAT(tenth.said, ContainsSubstring("friction_implausible: mean mu_b 2.9") &&
                               ContainsSubstring("is the brake's; is column 'p_Bremse' in MPa") && ContainsSubstring("not bar?"));
    CHECK(tenth.counts.at("figures") == 2);
    CHECK(rig::record::read_summary(tenth.out / "0001/summary.json").warnings.size() == 1);
    map.channels[2]->unit_name = "psi";
    map.channels[2]->unit = *antiskid::can::find_unit("psi");
    map.released_Pa = 1e4;
    map.brake_on_Pa = 2e4;
    CHECK_THAT(Import(dir.write("r.csv", two_stops()), map).said,
               ContainsSubstring("mean mu_b 4.") && ContainsSubstring("is column 'p_Bremse' in bar, not psi?"));
}

TEST_CASE("maps are refused with file, line and key", "[BRG-350]") {
    const TempDir dir;
    const std::string good = can_test::contents("config/import_example.toml");
    const auto rejected = [&](const std::string& from, const std::string& to, const std::string& words) {
        INFO(to);
        CHECK_THROWS_WITH(rig::replay::load_import_map(dir.write("map.toml", can_test::replaced(good, from, to))), ContainsSubstring(words));
    };
    rejected("unit = \"bar\"", "unit = \"baar\"", "pressure.unit: 'baar' is none of");
    rejected("unit = \"bar\"", "unit = \"km/h\"", "is none of");
    rejected("wheel_speed = {", "wheel_sped = {", "wheel_speed");
    rejected("separator = \";\"", "separator = \"ab\"", "one character");
    rejected("separator = \";\"", "separator = \",\"", "decimal sign");
    rejected("released_Pa = 1.5e5", "released_Pa = 5e5", "below brake_on_Pa");
    rejected("first_data_row = 4", "first_data_row = 2", "after header_row");
    rejected("before_s = 1.0", "before = 1.0", "before_s");
    const std::string bus = can_test::contents("config/import_bus_example.toml");
    CHECK_THROWS_WITH(rig::replay::load_import_map(dir.write("map.toml", bus)), ContainsSubstring("foreign.dbc"));  // not beside it
    CHECK_THROWS_WITH(rig::replay::load_import_map(dir.write("map.toml", can_test::replaced(bus, "format = \"bus\"", "format = \"can\""))),
                      ContainsSubstring("file.format") && ContainsSubstring("bus"));
    const auto file = dir.write("r.csv", two_stops());
    rig::replay::ImportMap map = example();
    map.channels[0]->column = "n";
    CHECK_THROWS_WITH(Import(file, map), ContainsSubstring("no column 'n'; there are: Zeit, n_Rad, v_Schwungrad"));
}

TEST_CASE("a map of a log of frames has the channels of its layout, in SI", "[BRG-360]") {
    const rig::replay::ImportMap map = rig::replay::load_import_map("config/import_bus_example.toml");
    REQUIRE(map.layout);
    CHECK((*map.layout)[antiskid::can::Role::wheel].id == can_test::foreign()[antiskid::can::Role::wheel].id);
    // No load cells, and no maneuver state with a temperature.
    for (std::size_t i = 0; i < rig::replay::kChannelCount; ++i) CHECK(map.channels[i].has_value() == (i <= 2 || i == 6));
    CHECK(map.channels[1]->unit == antiskid::can::find_unit("rad/s"));
}

TEST_CASE("what a log is says the file itself, plain or gzip", "[BRG-360]") {
    using rig::replay::LogFormat;
    const TempDir dir;
    const auto format = [&](const std::string& text) { return rig::replay::log_format(dir.write("log", text)); };
    CHECK(format("(1000000000.000100) vcan0 110#0011\n") == LogFormat::candump);
    CHECK(format("") == LogFormat::candump);
    CHECK(format("date Sat Sep 30 15:06:13 2023\nbase hex") == LogFormat::vector_asc);
    CHECK(format(";$FILEVERSION=1.1\n") == LogFormat::peak_trc);
    CHECK(format(";##########\n") == LogFormat::peak_trc);
    CHECK(format("LOGG\x90") == LogFormat::vector_blf);
    CHECK(format("MDF     4.10") == LogFormat::mdf);
    CHECK(rig::replay::log_format(write_gzip(dir.path() / "x.gz", "LOGG")) == LogFormat::vector_blf);
    CHECK(rig::replay::log_format(dir.path()) == LogFormat::candump);
    CHECK(rig::replay::log_format(dir.path() / "none") == LogFormat::candump);
}

TEST_CASE("a load that the layout's field cannot carry is refused, not cut off at its end", "[BRG-350]") {
    const TempDir dir;
    const auto heavier = [](double times) {
        std::string csv = kHead;
        for (Row row : truth().rows) {
            row.load_N *= times;
            csv += csv_row(row, 0.0);
        }
        return csv;
    };
    CHECK_NOTHROW(Import(dir.write("heavy.csv", heavier(2.0)), example()));
    CHECK_THROWS_WITH(Import(dir.write("heavier.csv", heavier(4.0)), example()),
                      ContainsSubstring("column 'F_z'") && ContainsSubstring("goes from 0 to 65535") && ContainsSubstring("--dbc"));
}
