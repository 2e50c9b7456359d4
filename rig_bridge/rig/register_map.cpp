#include "rig_bridge/rig/register_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/host/settings/settings.hpp"

namespace rig {
namespace {

using settings::Table;

/// "" for switches, states, counters and bits, which are plain u16.
constexpr std::array<std::string_view, kMeasuredCount> kMeasuredUnits{"", "", "", "", "", "", "m/s", "m", "", "N", "N", "N", "N m", "degC", "Pa"};
constexpr std::array<std::string_view, kCommandedCount> kCommandedUnits{"", "", "m/s", "", "", "N", "N s2/m2", "", ""};

constexpr std::array<settings::Choice<RegisterType>, 4> kTypes{
    {{"u16", RegisterType::u16}, {"i16", RegisterType::i16}, {"u32", RegisterType::u32}, {"float32", RegisterType::float32}}};
constexpr std::array<settings::Choice<WordOrder>, 2> kOrders{{{"big", WordOrder::big}, {"little", WordOrder::little}}};
constexpr std::array<settings::Choice<char>, 3> kParities{{{"none", 'N'}, {"even", 'E'}, {"odd", 'O'}}};
constexpr std::array kBauds{1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600};

/// Smallest and greatest raw value.
std::pair<double, double> raw_limits(RegisterType type) {
    switch (type) {
        case RegisterType::u16:
            return {0.0, 65535.0};
        case RegisterType::i16:
            return {-32768.0, 32767.0};
        case RegisterType::u32:
            return {0.0, 4294967295.0};
        case RegisterType::float32:
            break;
    }
    constexpr double kMax = std::numeric_limits<float>::max();
    return {-kMax, kMax};
}

std::string shown(double value) {
    std::string text = std::to_string(value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
}

void read_unit(const Table& table, std::string_view unit, Field& field) {
    const auto written = table.find_text("unit");
    if (unit.empty()) {
        if (written) table.fail("unit", "a pure number has none");
        return;
    }
    field.unit = unit;
    if (!written) table.fail("unit", "missing; this quantity is in '" + field.unit + "'");
    if (*written != unit) table.fail("unit", "expected '" + field.unit + "', got '" + *written + "'; scale converts");
}

void read_range(const Table& table, Field& field) {
    const auto range = table.numbers("range", {.count = {.min = 2, .max = 2}, .strictly_increasing = true});
    field.min = range[0];
    field.max = range[1];
    const auto [min, greatest] = raw_limits(field.type);
    const double a = (field.min - field.offset) / field.scale;
    const double b = (field.max - field.offset) / field.scale;
    if (std::round(std::min(a, b)) < min || std::round(std::max(a, b)) > greatest) {
        const double low = min * field.scale + field.offset;
        const double high = greatest * field.scale + field.offset;
        table.fail("range", "the registers hold " + shown(std::min(low, high)) + " to " + shown(std::max(low, high)) + " only");
    }
}

Field read_field(const Table& table, std::string_view unit) {
    Field field;
    field.name = table.name();
    field.address = table.integer<std::uint16_t>("address", {.min = 0, .max = 65535});
    field.type = table.choice<RegisterType>("type", kTypes);
    if (field.address + width(field.type) > 65536) table.fail("address", "two registers from 65535 on end above 65535");
    constexpr double kScale = 1e12;
    field.scale = table.find_number("scale", {.min = -kScale, .max = kScale}).value_or(1.0);
    field.offset = table.find_number("offset", {.min = -kScale, .max = kScale}).value_or(0.0);
    if (std::abs(field.scale) < 1.0 / kScale) table.fail("scale", "must not be 0, nor closer to it than 1e-12");
    if (unit.empty()) {
        if (field.type != RegisterType::u16) table.fail("type", "a switch, number or bit mask is u16");
        if (field.scale != 1.0) table.fail("scale", "a switch, number or bit mask has none");
        if (field.offset != 0.0) table.fail("offset", "a switch, number or bit mask has none");
    }
    read_unit(table, unit, field);
    read_range(table, field);
    static_cast<void>(table.text("comment"));
    return field;
}

/// Addresses in use in one register space.
class UsedAddresses {
  public:
    void add(const Table& table, const Field& field) {
        const int last = field.address + width(field.type) - 1;
        for (const auto& other : taken_) {
            if (field.address <= other.last && other.first <= last)
                table.fail("address", "overlaps " + other.name + " at " + std::to_string(other.first) +
                                          (other.last == other.first ? "" : " to " + std::to_string(other.last)));
        }
        taken_.push_back({field.address, last, table.path()});
    }

  private:
    struct Span {
        int first;
        int last;
        std::string name;
    };
    std::vector<Span> taken_;
};

/// A counter needs its full range, a switch 0 and 1, and every command must be able to start with 0.
void require_range(const Table& table, const Field& field, double max) {
    if (field.min > 0.0 || field.max < max) table.fail("range", max == 0.0 ? "must contain 0" : "must contain 0 to " + shown(max));
}

void read_inputs(const Table& inputs, RegisterMap& map) {
    UsedAddresses used;
    for (std::size_t i = 0; i < kMeasuredCount; ++i) {
        const auto q = static_cast<Measured>(i);
        const Table table = inputs.table(name(q));
        map.measured[i] = read_field(table, kMeasuredUnits[i]);
        used.add(table, map.measured[i]);
        if (q == Measured::plc_watchdog || q == Measured::applied_commit || q == Measured::rejected_commit)
            require_range(table, map.measured[i], 65535.0);
    }
    const Table version = inputs.table(name(Measured::map_version));
    if (map.version < map.field(Measured::map_version).min || map.version > map.field(Measured::map_version).max)
        version.fail("range", "map_version " + std::to_string(map.version) + " is outside");
}

void read_holdings(const Table& root, RegisterMap& map) {
    UsedAddresses used;
    const Table holdings = root.table("holding");
    for (std::size_t i = 0; i < kCommandedCount; ++i) {
        const auto q = static_cast<Commanded>(i);
        const Table table = holdings.table(name(q));
        map.commanded[i] = read_field(table, kCommandedUnits[i]);
        used.add(table, map.commanded[i]);
        const bool counter = q == Commanded::bridge_watchdog || q == Commanded::commit;
        const bool pure = kCommandedUnits[i].empty();
        require_range(table, map.commanded[i], counter ? 65535.0 : pure ? 1.0 : 0.0);
    }
    const Table faults = root.table("virtual");
    const Table open = faults.table("open_interlocks");
    map.open_interlocks = read_field(open, "");
    used.add(open, map.open_interlocks);
    const Table hang = faults.table("hang_s");
    map.hang_s = read_field(hang, "s");
    if (map.hang_s.min != 0.0) hang.fail("range", "must begin at 0");
    used.add(hang, map.hang_s);
    if (!faults.has("bridge_turn")) return;
    const Table turn = faults.table("bridge_turn");
    map.bridge_turn = read_field(turn, "");
    require_range(turn, *map.bridge_turn, 65535.0);
    used.add(turn, *map.bridge_turn);
}

void read_interlocks(const Table& table, RegisterMap& map) {
    for (std::size_t i = 0; i < kInterlockCount; ++i) {
        const auto key = name(static_cast<Interlock>(i));
        map.interlock_bit[i] = table.integer<std::uint8_t>(key, {.min = 0, .max = 15});
        for (std::size_t before = 0; before < i; ++before) {
            if (map.interlock_bit[before] == map.interlock_bit[i])
                table.fail(key,
                           "bit " + std::to_string(map.interlock_bit[i]) + " is " + std::string(name(static_cast<Interlock>(before))) + " already");
        }
    }
}

std::chrono::milliseconds read_ms(const Table& table, std::string_view key, std::int64_t min, std::int64_t max) {
    return std::chrono::milliseconds(table.integer<std::int64_t>(key, {.min = min, .max = max}));
}

void read_link(const Table& root, RegisterMap& map) {
    const Table watchdog = root.table("watchdog");
    map.bridge_timeout = read_ms(watchdog, "bridge_timeout_ms", 50, 60'000);
    map.plc_timeout = read_ms(watchdog, "plc_timeout_ms", 50, 60'000);
    const Table link = root.table("link");
    map.link.poll = read_ms(link, "poll_ms", 1, 10'000);
    map.link.connect_timeout = read_ms(link, "connect_timeout_ms", 1, 60'000);
    map.link.response_timeout = read_ms(link, "response_timeout_ms", 1, 60'000);
    map.link.backoff_min = read_ms(link, "backoff_min_ms", 1, 60'000);
    map.link.backoff_max = read_ms(link, "backoff_max_ms", 1, 600'000);
    if (map.link.backoff_max < map.link.backoff_min) link.fail("backoff_max_ms", "is below backoff_min_ms");
    map.link.user_timeout = read_ms(link, "user_timeout_ms", 1, 60'000);
    if (map.link.poll * 3 > map.bridge_timeout)
        link.fail("poll_ms", "above a third of watchdog.bridge_timeout_ms: the watchdog would hardly move in time");
    if (const auto late_ms = link.find_number("load_cells_late_ms", {.min = 0.0, .max = 50.0}))
        map.load_cells_late = std::chrono::microseconds(std::llround(1e3 * *late_ms));
    const Table serial = root.table("serial");
    map.serial.baud = serial.integer<int>("baud");
    if (std::find(kBauds.begin(), kBauds.end(), map.serial.baud) == kBauds.end())
        serial.fail("baud", "no standard rate: 1200 to 921600, e.g. 9600, 19200, 115200");
    map.serial.parity = serial.choice<char>("parity", kParities);
    map.serial.stop_bits = serial.integer<int>("stop_bits", {.min = 1, .max = 2});
}

}  // namespace

RegisterMap load_register_map(const std::filesystem::path& path) {
    const auto document = settings::Document::load(path);
    const Table root = document.root();
    RegisterMap map;
    map.version = root.integer<std::uint16_t>("map_version", {.min = 1, .max = 65535});
    map.word_order = root.choice<WordOrder>("word_order", kOrders);
    map.unit_id = root.integer<std::uint8_t>("unit_id", {.min = 1, .max = 247});
    read_link(root, map);
    read_interlocks(root.table("interlocks"), map);
    read_inputs(root.table("input"), map);
    read_holdings(root, map);
    document.finish();
    return map;
}

}  // namespace rig
