// What a binding may just hold, and what is said of one that holds more.
#include <algorithm>
#include <string>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/can/roles.hpp"
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

/// A wheel message without protection, so that a clock of 48 bits has room.
constexpr const char* kProtectedWheel = "protection = \"counter_crc\"\ncounter = \"Counter\"\ncrc = \"Crc\"\ndata_id = 0x110\nmax_delta = 4\n";

Layout changed(const std::string& from, const std::string& to, const std::string& toml = kOurs) {
    const can_test::TempDir dir;
    return load_layout(dir.write("a.dbc", replaced(kOurDbc, from, to)), dir.write("a.toml", toml));
}

Layout pressure_like(const std::string& scale_and_range) {
    return changed("(500,0) [0|32767500] \"Pa\" Controller,Bridge\n\nBO_ 288", scale_and_range + " \"Pa\" Controller,Bridge\n\nBO_ 288");
}

}  // namespace

TEST_CASE("a refusal says in full what is wrong with a message, and where", "[CAN-040]") {
    const auto rejected = [](const std::string& from, const std::string& to, const std::string& words) {
        const can_test::TempDir dir;
        const auto dbc = dir.write("a.dbc", replaced(kOurDbc, from, to));
        const auto toml = dir.write("a.toml", kOurs);
        std::string what = "accepted";
        try {
            static_cast<void>(load_layout(dbc, toml));
        } catch (const settings::Error& error) {
            what = error.what();
        }
        CHECK(what == toml.string() + ":5: wheel.message: " + replaced(words, "a.dbc", dbc.string()));
    };
    const std::string before = kOurDbc.substr(0, kOurDbc.find("BO_ 272 "));
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const std::string at = "a.dbc:" + std::to_string(line) + ": ";
    rejected("BO_ 272 W", "BO_ 2048 W", at + "'WheelEncoder' has a 29-bit identifier; only 11-bit ones (0 to 2047) are used");
    rejected("WheelEncoder: 8", "WheelEncoder: 9", at + "'WheelEncoder' has 9 bytes; a classic CAN frame has at most 8");
    rejected("BO_ 272 W", "BO_ 99 WheelEncoder: 8 Rig\n\nBO_ 272 W",
             "'WheelEncoder' is defined twice in a.dbc, lines " + std::to_string(line) + " and " + std::to_string(line + 2));
}

TEST_CASE("what just fits is accepted: identifier, widths, clocks, data IDs, ranges", "[CAN-045]") {
    CHECK(can_test::ours().sync_counter.bits == 16);
    CHECK(changed("BO_ 272 W", "BO_ 2047 W")[Role::wheel].id == 2047);
    CHECK(changed("SyncNumber : 0|16", "SyncNumber : 0|1").sync_counter.bits == 1);
    // One bit of 200 ms, and 16 bits of a little more.
    CHECK(changed("EdgeTime : 32|32@1+ (0.1,0)", "EdgeTime : 32|1@1+ (200000,0)").wheel.edge_time.bits == 1);
    CHECK(changed("EdgeTime : 32|32@1+ (0.1,0)", "EdgeTime : 32|16@1+ (3.1,0)").wheel.edge_time.bits == 16);
    CHECK(can_test::ours().wheel.edge_time.scale == Approx(100.0));
    CHECK(can_test::ours().wheel.edge_time.per_scale == Approx(0.01));
    CHECK(changed("EdgeCount : 16|16@1+ (1,0) [0|65535] \"\" Controller,Bridge\n SG_ EdgeTime : 32|32",
                  "EdgeCount : 0|16@1+ (1,0) [0|65535] \"\" Controller,Bridge\n SG_ EdgeTime : 16|48",
                  replaced(kOurs, kProtectedWheel, "protection = \"none\"\n"))
              .wheel.edge_time.bits == 48);
    // A data ID of 0 is one, and no message without a CRC has it.
    for (const std::string id : {"0", "65535"})
        CHECK(changed("VERSION", "VERSION", replaced(kOurs, "data_id = 0x110", "data_id = " + id))[Role::wheel].protection.data_id == std::stoi(id));
    CHECK(changed("VERSION", "VERSION", replaced(kOurs, "period_ms = 1\n", "period_ms = 1.0000000005\n"))[Role::wheel].bound);
}

TEST_CASE("the CRC is found in whichever byte it fills, in either order", "[CAN-040]") {
    struct Row {
        std::string crc, counter, count;
        std::uint8_t byte;
    };
    for (const Row& row : {Row{"0|8@1+", "8|4@1+", "16|16@1+", 0}, Row{"8|8@1+", "0|4@1+", "16|16@1+", 1}, Row{"24|8@1+", "0|4@1+", "8|16@1+", 3},
                           Row{"7|8@0+", "8|4@1+", "16|16@1+", 0}, Row{"15|8@0+", "0|4@1+", "16|16@1+", 1}, Row{"31|8@0+", "0|4@1+", "8|16@1+", 3}}) {
        const std::string crc_before =
            "WheelEncoder: 8 Rig\n SG_ Crc : 0|8@1+ (1,0) [0|255] \"\" Controller,Bridge\n"
            " SG_ Counter : 8|4@1+ (1,0) [0|14] \"\" Controller,Bridge\n SG_ EdgeCount : 16|16@1+";
        const std::string after = "WheelEncoder: 8 Rig\n SG_ Crc : " + row.crc +
                                  " (1,0) [0|255] \"\" Controller,Bridge\n SG_ Counter : " + row.counter +
                                  " (1,0) [0|14] \"\" Controller,Bridge\n SG_ EdgeCount : " + row.count;
        INFO(row.crc);
        CHECK(changed(crc_before, after)[Role::wheel].protection.crc_byte == row.byte);
    }
}

TEST_CASE("a range is kept in raw numbers: offset, sign, a hair of tolerance, single values", "[CAN-040]") {
    const auto ends = [](const std::string& scale_and_range) {
        const Signal pressure = pressure_like(scale_and_range).pressure_Pa;
        return std::pair(pressure.raw_min, pressure.raw_max);
    };
    using Ends = std::pair<std::int64_t, std::int64_t>;
    CHECK(ends("(500,-10000) [0|1000000]") == Ends{20, 2020});
    CHECK(ends("(500,0) [500.00025|999999.99975]") == Ends{1, 2000});
    CHECK(ends("(500,0) [500.00075|999999.99925]") == Ends{2, 1999});
    CHECK(ends("(500,0) [32767500|1e9]") == Ends{65535, 65535});
    CHECK(ends("(500,0) [-1000|0]") == Ends{0, 0});
    CHECK(ends("(500,0) [500|500.1]") == Ends{1, 1});
    CHECK(ends("(500,0) [0|0]") == Ends{0, 65535});
    const Signal slip = changed("(0.0001,0) [-3.2768|3.2767]", "(0.0001,0) [0|0]").status.slip;
    CHECK(slip.raw_min == -32768);
    CHECK(slip.raw_max == 32767);
}

TEST_CASE("a counter without a CRC has 2 to 8 bits; a rim 0.01 to 10 m", "[CAN-040]") {
    const auto foreign_rejection = [](const std::string& dbc_from, const std::string& dbc_to, const std::string& toml) {
        return rejection(replaced(kForeignDbc, dbc_from, dbc_to), toml);
    };
    CHECK_THAT(foreign_rejection("MsgCnt : 11|4@0+ (1,0) [0|15] \"\" ABCU\n SG_ BrakePress",
                                 "MsgCnt : 11|1@0+ (1,0) [0|1] \"\" ABCU\n SG_ BrakePress", kForeign),
               ContainsSubstring("pressure.counter") && ContainsSubstring("has 1 bit; expected 2 to 8 bits"));
    for (const std::string radius : {"0.009", "10.1"})
        CHECK_THAT(foreign_rejection("(0.0625,0) [0|4095.9375] \"rpm\"", "(0.0625,0) [0|4095.9375] \"km/h\"",
                                     replaced(kForeign, "unit = \"rpm\"", "unit = \"km/h\", radius_m = " + radius)),
                   ContainsSubstring("radius_m: " + radius + " is out of range 0.01 to 10"));
}
