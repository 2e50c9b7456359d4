#include <array>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/can/observer.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/can/roles.hpp"
#include "firmware/can/units.hpp"
#include "firmware/host/settings/error.hpp"
#include "tests/can/bindings.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using namespace antiskid;
using namespace antiskid::can;
using bindings::kForeign;
using bindings::kForeignDbc;
using bindings::kOurDbc;
using bindings::kOurs;
using bindings::rejection;
using can_test::replaced;

namespace {

struct Key {
    std::size_t begin;  ///< of its line
    std::size_t end;    ///< past its line end
    std::string table;
    std::string name;
};

std::vector<Key> keys(const std::string& toml) {
    std::vector<Key> found;
    std::string table;
    for (std::size_t begin = 0; begin < toml.size();) {
        const std::size_t end = toml.find('\n', begin) + 1;
        const std::string line = toml.substr(begin, end - begin);
        if (line[0] == '[') table = line.substr(1, line.find(']') - 1);
        if (line[0] >= 'a' && line[0] <= 'z') found.push_back({begin, end, table, line.substr(0, line.find(' '))});
        begin = end;
    }
    return found;
}

/// Appending, since gcc 12 warns falsely (-Wrestrict, bug 105329) of "[" + role.
std::string header(std::string_view table) {
    return std::string("[").append(table).append("]");
}

/// A valve message that a microcontroller could have compiled in.
constexpr Layout compiled_in() {
    Layout layout;
    Message& valve = layout[Role::valve];
    valve = {.id = 0x100, .length = 4, .bound = true, .period = control::Time{1'000'000}, .protection = {}};
    layout.valve_current_mA = {.shift = 16,
                               .bits = 16,
                               .big_endian = false,
                               .is_signed = false,
                               .raw_min = 0,
                               .raw_max = 65535,
                               .scale = 0.001,
                               .per_scale = 1000.0,
                               .offset = 0.0};
    return layout;
}
constexpr Layout kCompiledIn = compiled_in();
static_assert(kCompiledIn.valve_current_mA.raw(12.345) == 12345);
static_assert(std::is_trivially_copyable_v<Layout>);

}  // namespace

TEST_CASE("both layouts are accepted and hold what the files say", "[CAN-045]") {
    const Layout& ours = can_test::ours();
    CHECK(ours[Role::valve].id == 0x100);
    CHECK(ours[Role::wheel].period == std::chrono::milliseconds(1));
    CHECK(ours[Role::maneuver].protection.data_id == 0x120);
    CHECK(ours[Role::emergency_stop].period.count() == 0);
    CHECK(ours.wheel.source == control::SpeedSource::edges);
    CHECK(ids(ours, kToController).span().size() == 7);
    const Layout& foreign = can_test::foreign();
    CHECK(foreign[Role::pressure].period == std::chrono::milliseconds(5));
    CHECK_FALSE(foreign[Role::load_cells].bound);
    CHECK(foreign.wheel.source == control::SpeedSource::speed);
    CHECK(ids(foreign, kToRig).span().size() == 4);
}

TEST_CASE("load cells that do not tell the age of a reading have 0, and their frames are as before", "[CAN-040]") {
    const can_test::TempDir dir;
    const std::string without = replaced(kOurs, "age = { signal = \"Age\", unit = \"ms\" }\n", "");
    const Layout layout = load_layout(dir.write("a.dbc", kOurDbc), dir.write("a.toml", without));
    CHECK_FALSE(layout.load_cells.age_ns.bound());
    const LoadCellSample sample{.vertical_N = 23'532.0F, .longitudinal_N = 2100.0F, .brake_torque_Nm = 600.0F, .age = std::chrono::milliseconds(20)};
    const Frame frame = RigPort(layout, control::Time{1'000'000}).load_cells(sample);
    LoadCellSample fresh = sample;
    fresh.age = {};
    CHECK(frame.data == RigPort(can_test::ours(), control::Time{1'000'000}).load_cells(fresh).data);
    CHECK(frame.data != RigPort(can_test::ours(), control::Time{1'000'000}).load_cells(sample).data);
    Observer observer(layout);
    CHECK(observer.accept(frame) == Role::load_cells);
    CHECK(observer.view().load_cells.age == control::Time{});
}

TEST_CASE("without any one key the binding is refused, and the key named", "[CAN-040]") {
    for (const auto& [dbc, toml] : {std::pair(kOurDbc, kOurs), std::pair(kForeignDbc, kForeign)}) {
        for (const Key& key : keys(toml)) {
            if (key.table == "sync" && key.name == "number") continue;     // SYNC may carry nothing
            if (key.table == "load_cells" && key.name == "age") continue;  // a rig may not tell it
            const std::string what = rejection(dbc, std::string(toml).erase(key.begin, key.end - key.begin));
            INFO(key.table << "." << key.name << " gone: " << what);
            CHECK_THAT(what, ContainsSubstring("a.toml") && ContainsSubstring(key.table));
            const bool named = what.find(key.name) != std::string::npos;
            CHECK(named);
        }
    }
}

TEST_CASE("a misspelt key is refused, with its line", "[CAN-040]") {
    for (const auto& [dbc, toml] : {std::pair(kOurDbc, kOurs), std::pair(kForeignDbc, kForeign)}) {
        for (const Key& key : keys(toml)) {
            const std::string what = rejection(dbc, std::string(toml).insert(key.begin + 1, 1, 'q'));
            INFO(key.table << "." << key.name << " misspelt: " << what);
            CHECK_THAT(what, ContainsSubstring("a.toml:") && ContainsSubstring(key.name.substr(1)));
        }
    }
}

TEST_CASE("a missing, misspelt or additional table is refused", "[CAN-040]") {
    for (std::size_t i = 0; i < kRoleCount; ++i) {
        const std::string role(name(static_cast<Role>(i)));
        const std::string what = rejection(kOurDbc, replaced(kOurs, header(role), header(std::string("x").append(role))));
        INFO(role << ": " << what);
        CHECK_THAT(what, ContainsSubstring("a.toml") && ContainsSubstring(role));
    }
    CHECK_THAT(rejection(kOurDbc, kOurs + "[brake_temperature]\nmessage = \"X\"\n"), ContainsSubstring("brake_temperature"));
}

TEST_CASE("overlaps are found in either byte order, and between them", "[CAN-040]") {
    // Crc in byte 0, Counter in the low half of byte 1. Motorola fields start at their most significant bit and go on in the next byte.
    struct Row {
        const char *count, *time, *rejection;
    };
    const Row row = GENERATE(values<Row>({
        {"23|16@0+", "39|32@0+", ""},
        {"16|16@1+", "39|32@0+", ""},
        {"23|16@0+", "32|32@1+", ""},
        {"15|8@0+", "39|32@0+", "wheel.counter"},
        {"11|8@0+", "39|32@0+", "wheel.counter"},
        {"7|8@0+", "39|32@0+", "wheel.crc"},
        {"23|17@0+", "39|32@0+", "overlaps that of wheel.edge_count"},
        {"23|16@0+", "31|32@0+", "overlaps that of wheel.edge_count"},
        {"16|16@1+", "31|32@0+", "overlaps that of wheel.edge_count"},
        {"23|16@0+", "24|32@1+", "overlaps that of wheel.edge_count"},
        {"23|16@0+", "38|32@0+", "sticks out of the 8 bytes"},
        {"23|16@0+", "63|32@0+", "sticks out of the 8 bytes"},
        {"23|16@0+", "64|32@0+", "sticks out of the 8 bytes"},
        {"23|16@0+", "71|32@0+", "sticks out of the 8 bytes"},
        {"63|8@0+", "32|32@1+", "overlaps that of wheel.edge_count"},
    }));
    const std::string before = "SG_ EdgeCount : 16|16@1+ (1,0) [0|65535] \"\" Controller,Bridge\n SG_ EdgeTime : 32|32@1+";
    const std::string after = std::string("SG_ EdgeCount : ") + row.count + " (1,0) [0|0] \"\" Controller,Bridge\n SG_ EdgeTime : " + row.time;
    const std::string what = rejection(replaced(kOurDbc, before, after), kOurs);
    INFO(row.count << ", " << row.time);
    if (row.rejection[0] == '\0') {
        CHECK(what.empty());
    } else {
        CHECK_THAT(what, ContainsSubstring(row.rejection));
    }
}

TEST_CASE("what contradicts is refused, saying what would be right", "[CAN-040]") {
    struct Case {
        std::string from, to, expected;
        bool in_dbc = false;
    };
    const std::string encoder =
        "BO_ 272 WheelEncoder: 8 Rig\n SG_ Crc : 0|8@1+ (1,0) [0|255] \"\" Controller,Bridge\n"
        " SG_ Counter : 8|4@1+ (1,0) [0|14] \"\" Controller,Bridge\n"
        " SG_ EdgeCount : 16|16@1+ (1,0) [0|65535] \"\" Controller,Bridge\n"
        " SG_ EdgeTime : 32|32@1+ (0.1,0) [0|429496729.5] \"us\" Controller,Bridge\n";
    const auto wheel = [&encoder](const std::string& from, const std::string& to, const std::string& expected) {
        return Case{encoder, replaced(encoder, from, to), expected, true};
    };
    const std::vector<Case> cases{
        {"\"WheelEncoder\"", "\"WheelEncodr\"", "a.toml:5: wheel.message: no message 'WheelEncodr'"},
        {"\"WheelEncoder\"", "\"WheelEncodr\"", "did you mean 'WheelEncoder'"},
        {"\"WheelEncoder\"", "\"Qx\"", "no message 'Qx' in "},
        {"\"EdgeCount\"", "\"EdgeCuont\"", "wheel.edge_count: no signal 'EdgeCuont' in message 'WheelEncoder'"},
        {"\"EdgeTime\", unit = \"us\"", "\"EdgeTime\", unit = \"ms\"", "wheel.edge_time.unit: signal 'EdgeTime'"},
        {"\"EdgeTime\", unit = \"us\"", "\"EdgeTime\", unit = \"furlong\"", "unknown unit 'furlong'"},
        {"\"Pressure\", unit = \"Pa\"", "\"Pressure\", unit = \"bar\"", "is in 'Pa' there, 'bar' here"},
        {"edge_count = \"EdgeCount\"", "edge_count = \"EdgeTime\"", "wheel.edge_count"},
        {"edge_count = \"EdgeCount\"\n", "", "wheel.edge_count"},
        {"edge_count = \"EdgeCount\"\n", "edge_count = \"EdgeCount\"\nspeed = { signal = \"x\", unit = \"rpm\" }\n",
         "wheel.speed: give either edge_count and edge_time, or speed"},
        {"edge_count = \"EdgeCount\"\nedge_time = { signal = \"EdgeTime\", unit = \"us\" }\n", "",
         "wheel.message: give either edge_count and edge_time, or speed"},
        {"period_ms = 1\n", "period_ms = 2\n", "wheel.period_ms: contradicts GenMsgCycleTime of 'WheelEncoder'"},
        {"period_ms = 1\n", "period_ms = 0\n", "out of range 0.1 to 1000"},
        {"period_ms = 1\n", "period_ms = 1.0000000015\n", "contradicts GenMsgCycleTime of 'WheelEncoder'"},
        {"period_ms = 1\n", "period_ms = \"1\"\n", "wheel.period_ms"},
        {"counter = \"Counter\"", "counter = \"Crc\"", "wheel.crc: signal 'Crc'"},
        {"crc = \"Crc\"", "crc = \"Counter\"", "overlaps that of wheel.counter"},
        {"crc = \"Crc\"", "crc = \"EdgeTime\"", "has 32 bits; expected 8 bits"},
        {"max_delta = 4", "max_delta = 8", "wheel.max_delta: 8 is out of range 1 to 7"},
        {"max_delta = 4", "max_delta = 0", "wheel.max_delta: 0 is out of range"},
        {"data_id = 0x111", "data_id = 0x110", "flywheel.data_id: is that of [wheel]"},
        {"data_id = 0x110", "data_id = 65536", "wheel.data_id: 65536 is out of range 0 to 65535"},
        {"protection = \"counter_crc\"", "protection = \"crc\"", "wheel.protection"},
        {"\"FlywheelEncoder\"", "\"WheelEncoder\"", "flywheel.message: has the identifier that [wheel] uses"},
        {"law = \"Law\"", "law = \"Demand\"", "has 16 bits; expected 2 to 8 bits"},
        {"arm = \"Arm\"", "arm = \"Law\"", "maneuver.arm: signal 'Law'"},
        {"slip_reference = { signal = \"SlipReference\", unit = \"1\" }", "slip_reference = { signal = \"DecelerationReference\", unit = \"m/s2\" }",
         "expected one of 1, %"},
        {"wheel_lost = \"WheelLost\"", "wheel_lost = \"WheelCorrupt\"", "faults.bits.wheel_corrupt"},
        {"number = \"SyncNumber\"", "number = \"SyncNumber\"\nperiod_ms = 1", "sync.period_ms"},
        wheel("16|16@1+", "20|16@1+", "overlaps that of wheel.edge_count"),
        wheel("16|16@1+", "16|16@1-", "is signed"),
        wheel("EdgeCount : 16|16@1+ (1,0)", "EdgeCount : 16|16@1+ (2,0)", "factor 1 and offset 0"),
        wheel("EdgeCount : 16|16", "EdgeCount : 16|7", "has 7 bits; expected 8 to 32 bits"),
        wheel("32|32@1+", "40|32@1+", "sticks out of the 8 bytes"),
        wheel("32|32@1+ (0.1,0)", "32|16@1+ (1,0)", "rolls over within 200 ms"),
        wheel("32|32@1+ (0.1,0)", "32|32@1+ (0.1,5)", "no offset"),
        wheel("32|32@1+ (0.1,0)", "32|32@1+ (0,0)", "factor 0"),
        wheel("8|4@1+", "8|3@1+", "has 3 bits; expected 4 to 8 bits"),
        wheel("Crc : 0|8@1+ (1,0) [0|255] \"\" Controller,Bridge\n SG_ Counter : 8|4",
              "Crc : 4|8@1+ (1,0) [0|255] \"\" Controller,Bridge\n SG_ Counter : 0|4", "must fill one byte"),
        wheel("SG_ EdgeCount", "SG_ EdgeCount m0", "is multiplexed (m0)"),
        wheel("SG_ EdgeCount", "SG_ EdgeCount M", "is multiplexed (M)"),
        wheel("WheelEncoder: 8", "WheelEncoder: 7", "sticks out of the 7 bytes"),
        wheel("WheelEncoder: 8", "WheelEncoder: 12", "a classic CAN frame has at most 8"),
        wheel("BO_ 272", "BO_ 2147483920", "29-bit identifier"),
        wheel("BO_ 272", "BO_ 2048", "29-bit identifier"),
        wheel("8|4@1+", "8|1@1+", "has 1 bit; expected 4 to 8 bits"),
        {"Sync: 2 Rig\n SG_ SyncNumber : 0|16", "Sync: 8 Rig\n SG_ SyncNumber : 0|33", "sync.number: signal 'SyncNumber'", true},
        {"Sync: 2 Rig\n SG_ SyncNumber : 0|16", "Sync: 8 Rig\n SG_ SyncNumber : 0|33", "has 33 bits; expected 1 to 32 bits", true},
        {"Phase : 12|4", "Phase : 12|3", "has 3 bits; expected 4 to 8 bits", true},
        {"ManeuverNumber : 16|16", "ManeuverNumber : 16|15", "has 15 bits; expected 16 to 32 bits", true},
        {"State : 12|4", "State : 12|2", "has 2 bits; expected 3 to 8 bits", true},
        wheel("WheelEncoder: 8", "WheelEncoder: 9", "has 9 bytes"),
        wheel("32|32@1+ (0.1,0)", "32|16@1+ (3.05,0)", "rolls over within 200 ms"),
        wheel("32|32@1+ (0.1,0)", "32|1@1+ (199999,0)", "rolls over within 200 ms"),
        wheel("8|4@1+ (1,0)", "8|4@1+ (1,1)", "factor 1 and offset 0"),
        wheel("32|32@1+ (0.1,0)", "32|32@1- (0.1,0)", "must be unsigned"),
        wheel("32|32@1+ (0.1,0)", "32|32@1+ (-0.1,0)", "positive factor"),
        wheel("SG_ Counter", "SG_ EdgeCount : 60|4@1+ (1,0) [0|0] \"\" Rig\n SG_ Counter", "is defined twice in 'WheelEncoder'"),
        wheel("WheelEncoder: 8", "WheelEncoder: 0", "sticks out of the 0 bytes"),
        wheel("16|16@1+", "16|49@1+", "has 49 bits; at most 48 bits can be used"),
        {"BrakePressure: 4 Rig\n SG_ Crc : 0|8@1+ (1,0) [0|255] \"\" Controller,Bridge\n SG_ Counter : "
         "8|4@1+ (1,0) [0|14] \"\" Controller,Bridge\n SG_ Pressure : 16|16",
         "BrakePressure: 8 Rig\n SG_ Crc : 0|8@1+ (1,0) [0|255] \"\" Controller,Bridge\n SG_ Counter : "
         "8|4@1+ (1,0) [0|14] \"\" Controller,Bridge\n SG_ Pressure : 16|33",
         "has 33 bits; at most 32 bits can be used", true},
        {"BO_ 272 1;", "BO_ 272 1.5;", "which is 1.5 ms", true},
        {"BO_ 272 1;", "BO_ 272 2;", "which is 2 ms", true},
        {"[0|32767500] \"Pa\" Controller,Bridge\n\nBO_ 288", "[5e9|6e9] \"Pa\" Controller,Bridge\n\nBO_ 288", "cannot hold any value", true},
        {"[0|32767500] \"Pa\" Controller,Bridge\n\nBO_ 288", "[100|400] \"Pa\" Controller,Bridge\n\nBO_ 288", "cannot hold any value", true},
        wheel("BO_ 272", "BO_ 273", "has the identifier that [wheel] uses"),
        {"BO_ 272 W", "BO_ 99 WheelEncoder: 8 Rig\n\nBO_ 272 W", "is defined twice in", true},
        {"VAL_ 288 Law 0 \"wheel_slip\"", "VAL_ 288 Law 0 \"threshold\"", "has 'threshold' as value 0; it is 3 here", true},
        {"BA_DEF_ BO_ \"GenMsg", "SIG_VALTYPE_ 274 Pressure : 1;\nBA_DEF_ BO_ \"GenMsg", "floating-point", true},
        {"[0|32767500] \"Pa\" Controller,Bridge\n\nBO_ 288", "[-5|-1] \"Pa\" Controller,Bridge\n\nBO_ 288", "cannot hold any value", true},
    };
    for (const Case& c : cases) {
        INFO(c.from << " -> " << c.to);
        const std::string what = c.in_dbc ? rejection(replaced(kOurDbc, c.from, c.to), kOurs) : rejection(kOurDbc, replaced(kOurs, c.from, c.to));
        CHECK_THAT(what, ContainsSubstring("a.toml:") && ContainsSubstring(c.expected));
    }
    CHECK_THAT(rejection(replaced(kOurDbc, "[0|429496729.5] \"us\"", "[0|429496729.5] \"mA\""),
                         replaced(kOurs, "\"EdgeTime\", unit = \"us\"", "\"EdgeTime\", unit = \"mA\"")),
               ContainsSubstring("wheel.edge_time.unit: expected one of ns, us, ms, s"));
    CHECK_THAT(rejection(kOurDbc, "[wheel\n"), ContainsSubstring("a.toml:1"));
    CHECK_THAT(rejection("BO_ x", kOurs), ContainsSubstring("a.dbc:1"));
}

TEST_CASE("what moves the valve is refused without counter and CRC", "[CAN-010]") {
    for (const std::string& role : {std::string("valve"), std::string("maneuver")}) {
        for (const std::string& weaker : {std::string("none"), std::string("counter")}) {
            const std::size_t table = kOurs.find(header(role));
            std::string toml = kOurs;
            toml.replace(toml.find("counter_crc", table), 11, weaker);
            CHECK_THAT(rejection(kOurDbc, toml), ContainsSubstring(role + ".protection") && ContainsSubstring("this message can move the valve"));
        }
    }
}

TEST_CASE("a range wider than the field is the field's; names that are not ours say nothing", "[CAN-040][CAN-201]") {
    const auto loaded = [](const std::string& from, const std::string& to) {
        const can_test::TempDir dir;
        return load_layout(dir.write("a.dbc", replaced(kOurDbc, from, to)), dir.write("a.toml", kOurs));
    };
    const std::string pressure = "[0|32767500] \"Pa\" Controller,Bridge\n\nBO_ 288";
    const Layout wide = loaded(pressure, "[-1e9|1e9] \"Pa\" Controller,Bridge\n\nBO_ 288");
    CHECK(wide.pressure_Pa.raw_min == 0);
    CHECK(wide.pressure_Pa.raw_max == 65535);
    const Layout narrow = loaded(pressure, "[250|1000200] \"Pa\" Controller,Bridge\n\nBO_ 288");
    CHECK(narrow.pressure_Pa.raw_min == 1);
    CHECK(narrow.pressure_Pa.raw_max == 2000);
    const Layout named = loaded("VAL_ 288 Law 0 \"wheel_slip\"", "VAL_ 288 Law 0 \"Schlupf\"");
    CHECK(named.maneuver.law.bits == 3);
}

TEST_CASE("two units are the same when quantity and size are", "[CAN-020][CAN-201]") {
    CHECK(find_unit("us") == find_unit("\xC2\xB5s"));
    CHECK_FALSE(find_unit("mA") == find_unit("A"));
    CHECK_FALSE(find_unit("m/s") == find_unit("rad/s"));
    CHECK_FALSE(find_unit("furlong").has_value());
}

TEST_CASE("a list of identifiers leaves out what is not bound", "[CAN-045][CAN-201]") {
    constexpr std::array kRequested{Role::valve, Role::wheel};
    REQUIRE(ids(kCompiledIn, kRequested).span().size() == 1);
    CHECK(ids(kCompiledIn, kRequested).span()[0] == 0x100);
}

TEST_CASE("units of the bus become the controller's", "[CAN-020]") {
    const Layout& foreign = can_test::foreign();
    RigPort rig(foreign, control::Time{1'000'000});
    ControllerPort port(foreign, control::Time{1'000'000});
    // 600 rpm at 0.0625 rpm: 9600 = 0x2580, Motorola.
    port.accept({.id = 0x210, .length = 2, .data = {0x25, 0x80}, .received = {}});
    CHECK(port.sensors().wheel.speed_radps == static_cast<float>(20.0 * std::numbers::pi));
    // 206.84 bar from -10 bar at 0.01 bar: 21684 = 0x54B4, counter 0.
    port.accept({.id = 0x220, .length = 4, .data = {0x00, 0x00, 0x54, 0xB4}, .received = {}});
    CHECK(port.sensors().pressure.pressure_Pa == Approx(206.84e5));
    // 36 km/h are 10 m/s: 360 = 0x168; slip -1.0 %: -10 = 0xFF6; slip reference 24 %: 240 = 0x0F0; phase 4.
    rig.accept({.id = 0x310, .length = 8, .data = {0x4F, 0xF6, 0x0F, 0x01, 0x68, 0, 0, 0}, .received = {}});
    CHECK(rig.controller().state == control::State::braking);
    CHECK(rig.controller().slip == -0.01F);
    CHECK(rig.controller().slip_reference == 0.24F);
    CHECK(rig.controller().speed_mps == Approx(10.0));

    const auto with_unit = [](const std::string& unit, const std::string& more) {
        const can_test::TempDir dir;
        return load_layout(dir.write("a.dbc", replaced(kForeignDbc, "(0.0625,0) [0|4095.9375] \"rpm\"", "(0.5,0) [0|0] \"" + unit + "\"")),
                           dir.write("a.toml", replaced(kForeign, "unit = \"rpm\"", "unit = \"" + unit + "\"" + more)));
    };
    CHECK(with_unit("rad/s", "").wheel.speed_radps.scale == 0.5);
    CHECK(with_unit("deg/s", "").wheel.speed_radps.scale == Approx(0.5 * std::numbers::pi / 180.0));
    CHECK(with_unit("km/h", ", radius_m = 0.25").wheel.speed_radps.scale == Approx(0.5 / 3.6 / 0.25));
    CHECK_THROWS_WITH(with_unit("m/s", ""), ContainsSubstring("radius_m"));
    CHECK_THROWS_WITH(with_unit("rpm", ", radius_m = 0.25"), ContainsSubstring("radius_m"));
    CHECK_THROWS_WITH(with_unit("bar", ""), ContainsSubstring("expected one of rad/s, deg/s, rpm, or of m/s, km/h, kn"));
}
