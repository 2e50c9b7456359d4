// Loading config/registers.toml, and refusing everything that is not a register map.
#include "rig_bridge/rig/register_map.hpp"

#include <sstream>

#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"

using rig::Commanded;
using rig::load_register_map;
using rig::Measured;
using rig::RegisterType;

namespace {

std::string shipped() {
    return content_of("config/registers.toml");
}

/// The text with the first `from` after `[table]` replaced.
std::string edited(const std::string& table, const std::string& from, const std::string& to) {
    std::string text = shipped();
    const auto start = text.find("[" + table + "]");
    REQUIRE(start != std::string::npos);
    const auto place = text.find(from, start);
    REQUIRE(place != std::string::npos);
    return text.replace(place, from.size(), to);
}

/// 1 for the first line; of the first `needle` after `[table]`.
std::uint32_t line_of(const std::string& text, const std::string& table, const std::string& needle) {
    const auto place = text.find(needle, text.find("[" + table + "]"));
    REQUIRE(place != std::string::npos);
    return 1 + static_cast<std::uint32_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
}

settings::Error rejection_of_map(const std::string& text) {
    const TemporaryDirectory directory;
    put(directory / "registers.toml", text);
    return rejection_of([&] { return load_register_map(directory / "registers.toml"); });
}

/// The map with `from` replaced in `table` is refused at the line of `to`, for `key`, and says `message`.
void check_rejected(const std::string& table, const std::string& from, const std::string& to, const std::string& key, const std::string& message) {
    CAPTURE(table, from, to);
    const std::string text = edited(table, from, to);
    const auto error = rejection_of_map(text);
    CHECK_THAT(error.what(), ContainsSubstring("registers.toml:"));
    CHECK(error.key() == key);
    CHECK(error.line() == line_of(text, table, to));
    CHECK_THAT(error.message(), ContainsSubstring(message));
}

std::vector<std::string> tables(const std::string& prefix) {
    std::vector<std::string> names;
    std::istringstream lines(shipped());
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind("[" + prefix, 0) == 0) names.push_back(line.substr(1, line.find(']') - 1));
    }
    return names;
}

}  // namespace

TEST_CASE("The shipped map gives every quantity its place", "[BRG-001]") {
    const auto map = load_register_map("config/registers.toml");
    CHECK(map.version == 1);
    CHECK(map.unit_id == 1);
    CHECK(map.word_order == rig::WordOrder::big);
    CHECK(map.bridge_timeout == std::chrono::milliseconds(500));
    CHECK(map.plc_timeout == std::chrono::milliseconds(300));
    CHECK(map.serial.parity == 'N');
    CHECK(map.load_cells_late == std::chrono::microseconds(5500));
    const TemporaryDirectory directory;
    put(directory / "registers.toml", edited("link", "load_cells_late_ms = 5.5\n", ""));
    CHECK(load_register_map(directory / "registers.toml").load_cells_late.count() == 0);
    for (std::size_t i = 0; i < rig::kMeasuredCount; ++i) CHECK(map.measured[i].name == rig::name(static_cast<Measured>(i)));
    for (std::size_t i = 0; i < rig::kCommandedCount; ++i) CHECK(map.commanded[i].name == rig::name(static_cast<Commanded>(i)));
    CHECK(map.field(Measured::brake_torque_Nm).address == 18);
    CHECK(map.field(Measured::brake_torque_Nm).type == RegisterType::float32);
    CHECK(map.field(Measured::brake_temperature_C).scale == 0.1);
    CHECK(map.field(Measured::hydraulic_pressure_Pa).unit == "Pa");
    CHECK(map.field(Commanded::commit).address == 11);
    CHECK(map.hang_s.address == 101);
    CHECK(map.interlock_bit == std::array<std::uint8_t, 4>{0, 1, 2, 3});
}

TEST_CASE("A quantity that is missing, or that nobody knows, is refused by name", "[BRG-001]") {
    const auto inputs = tables("input.");
    const auto holdings = tables("holding.");
    CHECK(inputs.size() == rig::kMeasuredCount);
    CHECK(holdings.size() == rig::kCommandedCount);
    auto all = inputs;
    all.insert(all.end(), holdings.begin(), holdings.end());
    for (const auto& virtuals : tables("virtual.")) all.push_back(virtuals);
    for (const auto& table : all) {
        CAPTURE(table);
        const auto error = rejection_of_map(edited(table, table, table + "x"));
        CHECK(error.key().rfind(table, 0) == 0);
        CHECK(error.line() > 0);
    }
    const auto unknown = rejection_of_map(shipped() + "\n[input.oil_level]\naddress = 50\n");
    CHECK(unknown.key() == "input.oil_level");
}

TEST_CASE("Every key that is missing, misspelt or of another type is refused with its line", "[BRG-001]") {
    for (const std::string key : {"address", "type", "range", "comment"}) {
        CAPTURE(key);
        const auto text = edited("input.vertical_load", key + " ", key + "y ");
        const auto error = rejection_of_map(text);
        CHECK(error.line() == line_of(text, "input.vertical_load", key + "y "));
    }
    check_rejected("input.vertical_load", "address = 14", "address = \"14\"", "input.vertical_load.address", "integer");
    check_rejected("input.vertical_load", "\"float32\"", "\"float\"", "input.vertical_load.type", "float32");
    check_rejected("input.vertical_load", "[-5.0e3, 65.5e3]", "[-5.0e3]", "input.vertical_load.range", "2");
    check_rejected("input.vertical_load", "[-5.0e3, 65.5e3]", "[1.0, -1.0]", "input.vertical_load.range[1]", "not above");
    check_rejected("watchdog", "plc_timeout_ms = 300", "plc_timeout_ms = 0", "watchdog.plc_timeout_ms", "out of range");
    check_rejected("watchdog", "plc_timeout_ms = 300", "plc_timeout_s = 0.3", "watchdog.plc_timeout_s", "plc_timeout_ms");
    check_rejected("link", "backoff_max_ms = 2000", "backoff_max_ms = 50", "link.backoff_max_ms", "backoff_min_ms");
    check_rejected("link", "poll_ms = 20", "poll_ms = 400", "link.poll_ms", "third");
    check_rejected("link", "load_cells_late_ms = 5.5", "load_cells_late_ms = 50.1", "link.load_cells_late_ms", "0 to 50");
    check_rejected("link", "load_cells_late_ms = 5.5", "load_cells_late_ms = -1", "link.load_cells_late_ms", "0 to 50");
    check_rejected("serial", "baud = 115200", "baud = 100000", "serial.baud", "standard");
    check_rejected("serial", "\"none\"", "\"mark\"", "serial.parity", "even");
    check_rejected("serial", "stop_bits = 1", "stop_bits = 3", "serial.stop_bits", "1 to 2");
}

TEST_CASE("The header is checked", "[BRG-001]") {
    const auto rejected = [](const std::string& from, const std::string& to) {
        std::string text = shipped();
        text.replace(text.find(from), from.size(), to);
        return rejection_of_map(text);
    };
    CHECK(rejected("map_version = 1", "map_version = 0").key() == "map_version");
    CHECK(rejected("word_order = \"big\"", "word_order = \"ABCD\"").key() == "word_order");
    CHECK(rejected("unit_id = 1", "unit_id = 248").key() == "unit_id");
    CHECK(rejected("map_version = 1", "").key() == "map_version");
}

TEST_CASE("Addresses beyond the space, and overlaps, are refused", "[BRG-001]") {
    check_rejected("input.brake_torque", "address = 18", "address = 65536", "input.brake_torque.address", "65535");
    check_rejected("input.brake_torque", "address = 18", "address = -1", "input.brake_torque.address", "0 to 65535");
    check_rejected("input.brake_torque", "address = 18", "address = 65535", "input.brake_torque.address", "65535");
    check_rejected("input.brake_torque", "address = 18", "address = 17", "input.brake_torque.address",
                   "overlaps input.longitudinal_force at 16 to 17");
    check_rejected("input.brake_torque", "address = 18", "address = 6", "input.brake_torque.address", "overlaps input.wheel_on_rim at 6");
    check_rejected("holding.commit", "address = 11", "address = 10", "holding.commit.address", "holding.load_lift");
    check_rejected("virtual.hang_s", "address = 101", "address = 11", "virtual.hang_s.address", "holding.commit");

    // The same address in both spaces is no overlap, nor are the last registers of the space one too far.
    const TemporaryDirectory directory;
    put(directory / "registers.toml", edited("input.brake_torque", "address = 18", "address = 65534"));
    CHECK(load_register_map(directory / "registers.toml").field(Measured::brake_torque_Nm).address == 65534);
}

TEST_CASE("The turn of a bridge in lockstep is a virtual PLC's alone: a map may leave it out", "[BRG-465]") {
    const TemporaryDirectory directory;
    const std::string whole = shipped();
    put(directory / "registers.toml", whole.substr(0, whole.find("[virtual.bridge_turn]")));
    CHECK_FALSE(load_register_map(directory / "registers.toml").bridge_turn);
    CHECK(load_register_map("config/registers.toml").bridge_turn.value().address == 102);
    check_rejected("virtual.bridge_turn", "address = 102", "address = 11", "virtual.bridge_turn.address", "holding.commit");
    check_rejected("virtual.bridge_turn", "65535]", "32767]", "virtual.bridge_turn.range", "65535");
}

TEST_CASE("Ranges that the type cannot hold are refused", "[BRG-001]") {
    const std::string range = "input.hydraulic_pressure.range";
    // 65535 * 1e4 Pa
    check_rejected("input.hydraulic_pressure", "35.0e6]", "655.36e6]", range, "0 to 655350000");
    check_rejected("input.hydraulic_pressure", "[0.0,", "[-1.0e4,", range, "0 to 655350000");
    check_rejected("input.brake_temperature", "1500.0]", "3276.8]", "input.brake_temperature.range", "3276.7");
    check_rejected("input.brake_temperature", "[-40.0", "[-3276.9", "input.brake_temperature.range", "-3276.8");
    check_rejected("input.sledge_position", "1.0]", "3.3]", "input.sledge_position.range", "3.2767");
    check_rejected("input.vertical_load", "65.5e3]", "1.0e39]", "input.vertical_load.range", "hold");
    check_rejected("holding.load_base", "[0.0,", "[1.0,", "holding.load_base.range", "0");
    check_rejected("holding.commit", "65535]", "32767]", "holding.commit.range", "65535");
    check_rejected("holding.drive_enable", "[0, 1]", "[-1, 1]", "holding.drive_enable.range", "0 to 65535");
    check_rejected("input.map_version", "[1, 65535]", "[2, 65535]", "input.map_version.range", "map_version 1");
    check_rejected("virtual.hang_s", "[0.0,", "[0.5,", "virtual.hang_s.range", "begin at 0");
}

TEST_CASE("Scale and unit must make sense", "[BRG-001]") {
    check_rejected("input.hydraulic_pressure", "scale = 1.0e4", "scale = 0.0", "input.hydraulic_pressure.scale", "0");
    check_rejected("input.hydraulic_pressure", "\"Pa\"", "\"bar\"", "input.hydraulic_pressure.unit", "'Pa'");
    check_rejected("input.plc_state", "\"u16\"", "\"float32\"", "input.plc_state.type", "u16");
    check_rejected("input.plc_watchdog", "type", "scale = 2.0\ntype", "input.plc_watchdog.scale", "none");
    check_rejected("input.plc_watchdog", "type", "offset = 2.0\ntype", "input.plc_watchdog.offset", "none");
    check_rejected("input.plc_watchdog", "type", "unit = \"s\"\ntype", "input.plc_watchdog.unit", "none");
    const auto text = edited("input.vertical_load", "unit = \"N\"\n", "");
    CHECK_THAT(rejection_of_map(text).what(), ContainsSubstring("'N'"));
}

TEST_CASE("Two interlocks cannot share a bit", "[BRG-001]") {
    check_rejected("interlocks", "drive_healthy = 3", "drive_healthy = 1", "interlocks.drive_healthy", "guard_closed");
    check_rejected("interlocks", "drive_healthy = 3", "drive_healthy = 16", "interlocks.drive_healthy", "0 to 15");
}
