#include "rig_bridge/replay/import_map.hpp"

#include <algorithm>

#include "firmware/can/load_layout.hpp"
#include "firmware/host/settings/settings.hpp"

namespace rig::replay {

namespace {

using antiskid::can::Quantity;
using settings::Table;

struct Kind {
    std::string_view name;
    Quantity quantity;
    bool required;
};
constexpr std::array<Kind, kChannelCount> kKinds{{{"wheel_speed", Quantity::angular_speed, true},
                                                  {"flywheel_speed", Quantity::speed, true},
                                                  {"pressure", Quantity::pressure, true},
                                                  {"vertical_load", Quantity::force, false},
                                                  {"longitudinal_force", Quantity::force, false},
                                                  {"brake_torque", Quantity::torque, false},
                                                  {"valve_current", Quantity::current, false},
                                                  {"brake_temperature", Quantity::temperature, false}}};

/// `also`: another quantity that is accepted.
ImportColumn column(const Table& t, Quantity quantity, Quantity also) {
    ImportColumn c{.column = t.text("column"), .unit_name = t.text("unit"), .unit = {}};
    const auto unit = antiskid::can::find_unit(c.unit_name);
    if (!unit || (unit->quantity != quantity && unit->quantity != also)) {
        std::string known = antiskid::can::units_of(quantity);
        if (also != quantity) known += ", " + antiskid::can::units_of(also);
        t.fail("unit", "'" + c.unit_name + "' is none of " + known);
    }
    c.unit = *unit;
    return c;
}

char one_character(const Table& t, const char* key, const std::string& text) {
    if (text == "tab") return '\t';
    if (text.size() != 1) t.fail(key, "'" + text + "': expected one character, or tab");
    return text[0];
}

/// Reads the layout and determines its channels. Paths are relative to the map's folder.
void read_layout(const Table& t, const std::filesystem::path& beside, ImportMap& map) {
    map.layout_files = {beside / t.text("dbc"), beside / t.text("binding")};
    map.layout = antiskid::can::load_layout(map.layout_files[0], map.layout_files[1]);
    map.interface = t.find_text("interface");
    const antiskid::can::Layout& l = *map.layout;
    const std::array<bool, kChannelCount> there{true,
                                                true,
                                                true,
                                                l.load_cells.vertical_N.bound(),
                                                l.load_cells.longitudinal_N.bound(),
                                                l.load_cells.brake_torque_Nm.bound(),
                                                l.valve_current_mA.bound(),
                                                l.maneuver_state.brake_temperature_C.bound()};
    constexpr std::array<std::string_view, kChannelCount> kUnits{"rad/s", "rad/s", "Pa", "N", "N", "Nm", "mA", "degC"};
    const auto si = [](std::string_view column, std::string_view unit) {
        return ImportColumn{.column = std::string(column), .unit_name = std::string(unit), .unit = *antiskid::can::find_unit(unit)};
    };
    map.time = si("time", "s");
    for (std::size_t i = 0; i < kChannelCount; ++i)
        if (there[i]) map.channels[i] = si(kKinds[i].name, kUnits[i]);
}

void read_columns(const Table& root, ImportMap& map) {
    map.time = column(root.table("time"), Quantity::time, Quantity::time);
    const Table signals = root.table("signals");
    for (std::size_t i = 0; i < kKinds.size(); ++i) {
        const std::string key(kKinds[i].name);
        if (!kKinds[i].required && !signals.has(key)) continue;
        const bool rim = static_cast<Channel>(i) == Channel::flywheel_speed;
        map.channels[i] = column(signals.table(key), kKinds[i].quantity, rim ? Quantity::angular_speed : kKinds[i].quantity);
    }
}

enum class Format : std::uint8_t { csv, mat, bus };

void read_file(const Table& root, const std::filesystem::path& beside, ImportMap& map) {
    constexpr std::array<settings::Choice<Format>, 3> kFormats{{{"csv", Format::csv}, {"mat", Format::mat}, {"bus", Format::bus}}};
    const Table t = root.table("file");
    const Format format = t.choice<Format>("format", kFormats);
    map.mat = format == Format::mat;
    if (format == Format::bus) {
        read_layout(t, beside, map);
        return;
    }
    read_columns(root, map);
    if (map.mat) return;
    constexpr std::array<settings::Choice<char>, 2> kDecimals{{{".", '.'}, {",", ','}}};
    constexpr settings::IntegerRange kRow{.min = 1, .max = 1'000'000};
    if (const auto separator = t.find_text("separator")) map.separator = one_character(t, "separator", *separator);
    map.decimal = t.find_choice<char>("decimal", kDecimals).value_or('.');
    if (map.decimal == map.separator) t.fail("separator", "is the decimal sign, too");
    map.header_row = t.integer<std::uint64_t>("header_row", kRow);
    map.unit_row = t.find_integer<std::uint64_t>("unit_row", kRow).value_or(0);
    map.first_data_row = t.integer<std::uint64_t>("first_data_row", kRow);
    if (map.first_data_row <= std::max(map.header_row, map.unit_row)) t.fail("first_data_row", "must come after header_row and unit_row");
}

void read_maneuvers(const Table& t, ImportMap& map) {
    constexpr settings::Range kPressure_Pa{.min = 1.0, .max = 1e8};
    constexpr settings::Range kSpeed_mps{.min = 0.01, .max = 200.0};
    map.brake_on_Pa = t.number("brake_on_Pa", kPressure_Pa);
    map.released_Pa = t.number("released_Pa", kPressure_Pa);
    map.min_speed_mps = t.number("min_speed_mps", kSpeed_mps);
    map.standstill_mps = t.number("standstill_mps", kSpeed_mps);
    map.before_s = t.number("before_s", {.min = 0.1, .max = 60.0});
    map.after_s = t.number("after_s", {.min = 0.0, .max = 60.0});
    map.longest_gap_s = t.number("longest_gap_s", {.min = 1e-3, .max = 10.0});
    if (map.released_Pa >= map.brake_on_Pa) t.fail("released_Pa", "must be below brake_on_Pa");
    if (map.standstill_mps >= map.min_speed_mps) t.fail("standstill_mps", "must be below min_speed_mps");
}

}  // namespace

std::string_view name(Channel channel) {
    return kKinds[static_cast<std::size_t>(channel)].name;
}

ImportMap load_import_map(const std::filesystem::path& file) {
    const auto document = settings::Document::load(file);
    const Table root = document.root();
    ImportMap map;
    map.scenario = root.text("scenario");
    read_file(root, file.parent_path(), map);
    read_maneuvers(root.table("maneuvers"), map);
    document.finish();
    return map;
}

}  // namespace rig::replay
