// Each key of the controller's configuration, spoilt in every way in turn: refused with file, line and key.
#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <new>
#include <set>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include "firmware/host/controller_config.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"

using antiskid::load_controller_config;

namespace {

/// One `key = value` line of the file.
struct Entry {
    std::size_t line;  // from 0
    std::string table, key, value;
    [[nodiscard]] std::string path() const { return table.empty() ? key : table + "." + key; }
};

struct File {
    std::vector<std::string> lines;
    std::vector<Entry> entries;

    explicit File(const std::filesystem::path& path) {
        std::istringstream text(content_of(path));
        std::string table;
        for (std::string line; std::getline(text, line);) {
            if (line.starts_with('[')) table = line.substr(1, line.find(']') - 1);
            const auto equals = line.find(" = ");
            if (!line.starts_with('#') && equals != std::string::npos) {
                const auto end = line.find('#');
                entries.push_back(
                    {lines.size(), table, line.substr(0, equals), line.substr(equals + 3, end == std::string::npos ? end : end - equals - 3)});
            }
            lines.push_back(line);
        }
    }

    /// The file with one line replaced, or left out when `with` is empty.
    [[nodiscard]] std::string with(const std::size_t at, const std::string& with) const {
        std::string text;
        for (std::size_t i = 0; i < lines.size(); ++i) {
            if (i != at)
                text += lines[i] + '\n';
            else if (!with.empty())
                text += with + '\n';
        }
        return text;
    }
};

/// Whether the key ends in a unit that the settings reader can tell from another one.
bool has_unit(const std::string& key) {
    static const std::set<std::string> kUnits{"ms", "s", "mps", "mps2", "radps", "Pa", "mA", "m", "m2", "m3", "Hz", "Npm", "kgm2", "kgpm3"};
    const auto underscore = key.rfind('_');
    return underscore != std::string::npos && kUnits.contains(key.substr(underscore + 1));
}

/// The same quantity in another unit, or in a unit where it has none.
std::string in_another_unit(const std::string& key) {
    return has_unit(key) ? key.substr(0, key.rfind('_')) + "_ft" : key + "_percent";
}

struct Check {
    std::filesystem::path path;
    TemporaryDirectory directory;

    [[nodiscard]] settings::Error rejection(const std::string& text) const {
        const auto file = directory / "controller.toml";
        put(file, text);
        return rejection_of([&file] { return load_controller_config(file); });
    }
};

}  // namespace

TEST_CASE("each missing, misspelt, mis-united or mistyped key is refused at its line", "[CTL-090]") {
    const auto* const path = GENERATE("config/controller.toml", "config/controller_endurance.toml");
    const File file(path);
    REQUIRE(file.entries.size() > 75);
    const Check check{path, {}};
    const std::string name = (check.directory / "controller.toml").string();
    for (const Entry& entry : file.entries) {
        const std::string& line = file.lines[entry.line];
        const std::string rest = line.substr(entry.key.size());
        CAPTURE(entry.path(), line);

        const settings::Error missing = check.rejection(file.with(entry.line, ""));
        CHECK(missing.file() == name);
        CHECK(missing.key() == entry.path());

        const settings::Error misspelt = check.rejection(file.with(entry.line, "x" + line));
        CHECK(misspelt.file() == name);
        if (entry.key.size() > 3)
            CHECK(misspelt.line() == entry.line + 1);
        else
            CHECK(misspelt.key() == entry.path());  // too short to guess: it is missing
        CHECK_THAT(misspelt.what(), ContainsSubstring(entry.key));

        const settings::Error united = check.rejection(file.with(entry.line, in_another_unit(entry.key) + rest));
        CHECK(united.file() == name);
        CHECK_THAT(united.what(), ContainsSubstring(entry.key));
        if (has_unit(entry.key))
            CHECK(united.line() == entry.line + 1);
        else
            CHECK(united.key() == entry.path());  // "k_d_percent" is no unit of k_d, so k_d is missing

        for (const char* const wrong : {"\"1\"", "true", "nan", "inf", "-inf"}) {
            const settings::Error mistyped = check.rejection(file.with(entry.line, entry.key + " = " + wrong));
            CHECK(mistyped.file() == name);
            CHECK(mistyped.line() == entry.line + 1);
            CHECK(mistyped.key() == entry.path());
        }
    }
}

TEST_CASE("each value out of range is refused at its line, above and below", "[CTL-090]") {
    const File file("config/controller.toml");
    const Check check{"config/controller.toml", {}};
    const std::string name = (check.directory / "controller.toml").string();
    for (const Entry& entry : file.entries) {
        const bool array = entry.value.starts_with('[');
        for (const std::string far : {"1e30", "-1e30"}) {
            const bool integer = entry.key == "teeth";
            const std::string number = integer ? (far == "1e30" ? "1000000" : "-1000000") : far;
            const settings::Error error = check.rejection(file.with(entry.line, entry.key + " = " + (array ? "[0.0, " + number + "]" : number)));
            CAPTURE(entry.path(), number, error.what());
            CHECK(error.file() == name);
            CHECK(error.line() == entry.line + 1);
            CHECK(error.key().starts_with(entry.path()));
        }
    }
}

TEST_CASE("values that contradict each other are refused where they stand", "[CTL-090]") {
    const File file("config/controller.toml");
    const Check check{"config/controller.toml", {}};
    const auto rejected = [&](const std::string& path, const std::string& value) {
        for (const Entry& entry : file.entries) {
            if (entry.path() != path) continue;
            const settings::Error error = check.rejection(file.with(entry.line, entry.key + " = " + value));
            CAPTURE(path, value, error.what());
            CHECK(error.line() == entry.line + 1);
            CHECK(error.key().starts_with(path));
            return;
        }
        FAIL(path << " is not in the file");
    };
    rejected("period_ms", "0.9");
    rejected("period_ms", "5.1");
    rejected("slip.low_speed_floor_mps", "99.0");                                                 // not below low_speed_mps
    rejected("valve.pressure_Pa", "[0.0, 1.0e6]");                                                // not as many as currents
    rejected("valve.current_mA", "[3.0, 3.0]");                                                   // not increasing
    rejected("valve.pressure_Pa", "[2.0e6, 1.0e6]");                                              // falling
    rejected("valve.current_mA", "[3.0]");                                                        // one point is no map
    rejected("valve.current_mA", "[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17]");  // too many
    rejected("valve.safe_current_mA", "3.5");                                                     // would make pressure
    rejected("valve.full_pressure_Pa", "21.0e6");                                                 // more than the map gives
    rejected("valve.delay_ms", "16.5");                                                           // longer than the model's memory
    rejected("monitor.sensor_max_age_ms", "1.5");                                                 // younger than a sensor frame can be
}

TEST_CASE("low_speed_mps = 0 is allowed whatever the floor is", "[CTL-090]") {
    const File file("config/controller.toml");
    const TemporaryDirectory directory;
    for (const Entry& entry : file.entries)
        if (entry.key == "low_speed_mps") put(directory / "c.toml", file.with(entry.line, "low_speed_mps = 0.0"));
    CHECK(load_controller_config(directory / "c.toml").slip.low_speed_mps == 0.0F);
}

TEST_CASE("missing tables, unknown tables and missing files are refused by name", "[CTL-090]") {
    const File file("config/controller.toml");
    const Check check{"config/controller.toml", {}};
    std::set<std::string> tables;
    for (const Entry& entry : file.entries)
        if (!entry.table.empty()) tables.insert(entry.table);
    CHECK(tables.size() == 14);
    for (const std::string& table : tables) {
        for (std::size_t i = 0; i < file.lines.size(); ++i) {
            if (!file.lines[i].starts_with("[" + table + "]")) continue;
            CAPTURE(table);
            const settings::Error error = check.rejection(file.with(i, "[x" + table + "]"));
            CHECK_THAT(error.what(), ContainsSubstring(table));
        }
    }
    CHECK_THROWS_AS(load_controller_config("config/no_such_controller.toml"), settings::Error);
}

TEST_CASE("a pressure range that a full demand leaves is refused", "[CTL-090]") {
    const File file("config/controller.toml");
    const Check check{"config/controller.toml", {}};
    for (const Entry& entry : file.entries)
        if (entry.key == "pressure_range_Pa") {
            const settings::Error narrow = check.rejection(file.with(entry.line, "pressure_range_Pa = 20.6e6"));
            CHECK(narrow.key() == "monitor.pressure_range_Pa");
            CHECK(narrow.line() == entry.line + 1);
        }
}

TEST_CASE("a valve of 200 mA may be commanded 200 mA in the open loop", "[CTL-090]") {
    const TemporaryDirectory directory;
    const std::string shipped = content_of("config/controller.toml");
    const auto file = directory / "controller.toml";
    put(file, replaced(shipped, "30.0, 35.0, 40.0]", "30.0, 35.0, 200.0]"));
    CHECK(load_controller_config(file).monitor.max_current_mA == Approx(202.0F));
}

TEST_CASE("the shipped files load, in SI units", "[CTL-090]") {
    const auto c = load_controller_config("config/controller.toml");
    CHECK(c.period_s == 1e-3F);
    CHECK(c.wheel.lift_Ns2pm2 == Approx(0.5 * 1.225 * 5.9));
    CHECK(c.valve.natural_frequency_radps == Approx(2.0 * 3.14159265 * 20.0));
    CHECK(c.valve.delay_s == 6e-3F);
    CHECK(c.valve.points == 10);
    CHECK(c.valve.pressure_Pa[9] == c.valve.full_pressure_Pa);
    CHECK(c.monitor.heartbeat_max_age_s == 0.35F);
    // What is not in the file follows from what is.
    CHECK(c.supervisor.self_test_s == Approx(0.05F));
    CHECK(c.supervisor.demand_threshold_Pa == Approx(0.2e6F));
    CHECK(c.supervisor.unlock_share == Approx(0.7F));
    CHECK(c.supervisor.release_s == Approx(0.1F + 6e-3F + 3.0F / c.valve.natural_frequency_radps));
    CHECK(c.supervisor.drop_out_hysteresis_mps == Approx(1.0F));
    CHECK(c.monitor.implausible_s == Approx(5e-3F));
    CHECK(c.monitor.pressure_rate_Paps == Approx(2.0F * 125.66F * 20.7e6F).epsilon(1e-3));
    CHECK(c.monitor.pressure_moves_Pa == Approx(1e6F));
    CHECK(c.monitor.overspeed_share == Approx(0.15F));
    CHECK(c.monitor.free_slip == Approx(0.08F));
    CHECK(c.monitor.steady_mps2 == Approx(15.0F));
    CHECK(c.monitor.hardly_braked_Pa == Approx(0.5F * 1.3F * 50.0F / (0.322F * 1.04e-3F)));
    CHECK(c.monitor.off_command_s == Approx(0.1F));
    CHECK(c.monitor.plausible_above_mps == Approx(4.5F));
    CHECK(c.monitor.overruns == 50);
    CHECK(c.monitor.max_current_mA == Approx(1.01F * 40.0F));
    CHECK(c.wheel.hardest_brake == 2.0F);
    CHECK(c.wheel.encoder.reject_timeout_s == 0.01F);
    CHECK(c.flywheel.encoder.reject_timeout_s == 0.01F);
    const auto rig = load_controller_config("config/controller_endurance.toml");
    CHECK(rig.wheel.lift_Ns2pm2 == 0.0F);
    CHECK(rig.wheel.nominal_radius_m == 0.30F);
}

TEST_CASE("a configuration that nobody has filled in is zero: no gain, no limit that lets anything through") {
    namespace control = antiskid::control;
    // Zero before, so that what lies between the members is no trouble.
    alignas(control::Config) std::array<std::byte, sizeof(control::Config)> memory{};
    const auto* const config = new (memory.data()) control::Config;
    static_assert(std::is_trivially_destructible_v<control::Config>);
    CHECK(config->period_s == 0.0F);
    CHECK(std::ranges::all_of(memory, [](std::byte b) { return b == std::byte{}; }));
}
