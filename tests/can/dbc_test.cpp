#include "firmware/can/dbc.hpp"

#include <algorithm>
#include <random>

#include "firmware/can/value_names.hpp"
#include "firmware/host/settings/error.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using namespace antiskid::can;

namespace {

/// Parses or refuses; anything else (a crash, another exception) fails the test.
bool survives(std::string_view text) {
    try {
        static_cast<void>(parse_dbc(text, "x.dbc"));
    } catch (const settings::Error& error) {
        return error.line() >= 1;
    }
    return true;
}

constexpr std::string_view kRealWorld =
    "\xEF\xBB\xBFVERSION \"HIPBNYYYYYYYYYYYYYYYYYYYYYYYYYYYYYYYYYYYYYYY/4/%%%/4/'%**4YYY///\"\r\n"
    "\r\nNS_ : "
    "\r\n\tNS_DESC_\r\n\tCM_\r\n\tBA_DEF_\r\n\tBA_\r\n\tVAL_\r\n\tSIG_VALTYPE_\r\n\tBO_TX_BU_\r\n\r\nBS_:"
    "\r\n\r\n"
    "BU_: GTW ECU_A\r\nVAL_TABLE_ States 1 \"on\" 0 \"off\" ;\r\n\r\n"
    "BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX\r\n SG_ Unused : 0|8@1+ (1,0) [0|0] \"\" "
    "Vector__XXX\r\n\r\n"
    "BO_ 2566834709 Extended_Frame: 8 ECU_A\r\n"
    " SG_ Mux M : 0|4@1+ (1,0) [0|15] \"\"  GTW\r\n"
    " SG_ Part m0 : 8|16@1- (0.01,-40) [-40|6.1356E+2] \"\xB0"
    "C\"  GTW,ECU_A\r\n"
    " SG_ Nested m1M : 24|8@0+ (1,0) [0|255] \"\" GTW\r\n\r\n"
    "BO_ 100 Floats : 64 GTW\r\n SG_ F:7|32@0- (+1,0) [0|0] \"m/s\" ECU_A\r\n\r\n"
    "EV_ Env: 0 [0|1] \"\" 0 1 DUMMY_NODE_VECTOR0 Vector__XXX;\r\n"
    "BO_TX_BU_ 100 : GTW,ECU_A;\r\n"
    "CM_ \"file\r\ncomment; with a semicolon\";\r\nCM_ BU_ GTW \"gateway\";\r\n"
    "CM_ BO_ 100 \"line one\r\nline two with \\\"quotes\\\"\";\r\nCM_ SG_ 100 F \"a float\";\r\nCM_ EV_ Env "
    "\"x\";\r\n"
    "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\r\nBA_DEF_DEF_ \"GenMsgCycleTime\" 0;\r\n"
    "BA_ \"GenMsgCycleTime\" BO_ 100 20;\r\nBA_ \"GenMsgCycleTime\" BO_ 4711 20;\r\nBA_ \"Baudrate\" "
    "500000;\r\n"
    "BA_ \"NodeLayerModules\" BU_ GTW \"x;y\";\r\n"
    "VAL_ Env 0 \"no\" 1 \"yes\" ;\r\nVAL_ 100 F -1 \"bad\" 2 \"good; really\" ;\r\nVAL_ 99 Nobody 0 \"x\" "
    ";\r\n"
    "SIG_VALTYPE_ 100 F : 1;\r\nSIG_GROUP_ 100 G 1 : F;\r\nBA_REL_ \"x\" BU_BO_REL_ GTW 100 1;\r\n";

}  // namespace

TEST_CASE("a DBC as tools write them is read: line ends, marks, blanks, unknown sections", "[CAN-030]") {
    const Dbc dbc = parse_dbc(kRealWorld, "x.dbc");
    REQUIRE(dbc.messages.size() == 3);
    const DbcMessage& extended = dbc.messages[1];
    CHECK(extended.extended);
    CHECK(extended.id == 2566834709U - 0x80000000U);
    REQUIRE(extended.signals.size() == 3);
    CHECK(extended.signals[0].multiplexing == "M");
    CHECK(extended.signals[1].multiplexing == "m0");
    CHECK(extended.signals[1].offset == -40.0);
    CHECK(extended.signals[1].max == 613.56);
    CHECK(extended.signals[1].is_signed);
    CHECK(extended.signals[1].unit ==
          "\xB0"
          "C");
    CHECK(extended.signals[2].multiplexing == "m1M");
    CHECK(extended.signals[2].big_endian);
    const DbcMessage& floats = dbc.messages[2];
    CHECK(floats.length == 64);
    CHECK(floats.sender == "GTW");
    CHECK(floats.cycle_time_ms == 20.0);
    CHECK(floats.comment == "line one\r\nline two with \"quotes\"");
    REQUIRE(floats.signals.size() == 1);
    CHECK(floats.signals[0].floating);
    CHECK(floats.signals[0].comment == "a float");
    CHECK(floats.signals[0].values == std::map<std::int64_t, std::string>{{-1, "bad"}, {2, "good; really"}});
}

TEST_CASE("what means nothing is left out: cycle times of 0, codes beyond every field", "[CAN-030][CAN-201]") {
    const Dbc dbc = parse_dbc(
        "BO_ 1 M: 8 N\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\nBO_ 2 W: 8\nBA_ \"GenMsgCycleTime\" BO_ 1 0;\n"
        "BA_ \"GenMsgCycleTime\" BU_ N 5;\nVAL_ 1 S 9.1e15 \"much\" -9.1e15 \"little\" 9e15 \"most\" -9e15 "
        "\"least\" ;\n",
        "x.dbc");
    REQUIRE(dbc.messages.size() == 2);
    CHECK_FALSE(dbc.messages[0].cycle_time_ms.has_value());
    CHECK(dbc.messages[1].sender.empty());
    CHECK(dbc.messages[0].signals[0].values ==
          std::map<std::int64_t, std::string>{{9'000'000'000'000'000, "most"}, {-9'000'000'000'000'000, "least"}});
}

TEST_CASE("a statement goes to the first message of its identifier, and to the first signal of its name there", "[CAN-030]") {
    const Dbc dbc = parse_dbc(
        "BO_ 1 A: 8 N\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n SG_ S : 8|8@1+ (1,0) [0|0] \"\" N\n"
        "BO_ 2147483649 B: 8 N\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n"
        "BO_ 1 C: 8 N\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n SG_ T : 0|8@1+ (1,0) [0|0] \"\" N\n"
        "CM_ BO_ 1 \"one\";\nCM_ BO_ 2147483649 \"two\";\nCM_ BO_ 2 \"none\";\n"
        "CM_ SG_ 1 S \"first\";\nCM_ SG_ 2147483649 S \"second\";\nCM_ SG_ 1 T \"none\";\n"
        "CM_ SG_ 2 S \"none\";\n",
        "x.dbc");
    REQUIRE(dbc.messages.size() == 3);
    CHECK(dbc.messages[0].comment == "one");
    CHECK(dbc.messages[1].comment == "two");
    CHECK(dbc.messages[2].comment.empty());
    REQUIRE(dbc.messages[0].signals.size() == 2);
    CHECK(dbc.messages[0].signals[0].comment == "first");
    CHECK(dbc.messages[0].signals[1].comment.empty());
    CHECK(dbc.messages[1].signals[0].comment == "second");
    CHECK(dbc.messages[2].signals[0].comment.empty());
    CHECK(dbc.messages[2].signals[1].comment.empty());
}

TEST_CASE("each statement of a large DBC finds its message", "[CAN-030]") {
    constexpr std::uint32_t kMany = 20'000;
    std::string text;
    std::string times;
    for (std::uint32_t i = 1; i <= kMany; ++i) {
        const std::string id = std::to_string(i);
        text.append("BO_ ").append(id).append(" M: 8 N\n");
        times.append("BA_ \"GenMsgCycleTime\" BO_ ").append(id).append(" ").append(id).append(";\n");
    }
    const Dbc dbc = parse_dbc(text + times, "x.dbc");
    REQUIRE(dbc.messages.size() == kMany);
    CHECK(std::all_of(dbc.messages.begin(), dbc.messages.end(), [](const DbcMessage& message) { return message.cycle_time_ms == message.id; }));
}

TEST_CASE("a malformed statement is refused with file, line and what was expected", "[CAN-030]") {
    const auto rejected = [](const std::string& statement, const std::string& expected) {
        INFO(statement);
        const std::string text = "VERSION \"\"\n\nBO_ 1 M: 8 N\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n" + statement;
        CHECK_THROWS_WITH(parse_dbc(text, "dir/x.dbc"), ContainsSubstring("dir/x.dbc:5: ") && ContainsSubstring(expected));
    };
    rejected("BO_ x M2: 8 N\n", "expected the message's identifier");
    rejected("BO_ 4294967296 M2: 8 N\n", "from 0 to 4294967295");
    rejected("BO_ -1 M2: 8 N\n", "expected the message's identifier");
    rejected("BO_ 2 : 8 N\n", "expected the message's name");
    rejected("BO_ 2 M2 8 N\n", "expected ':' after the message's name, got '8'");
    rejected("BO_ 2 M2: N\n", "length in bytes");
    rejected("BO_ 2 M2:\n", "got the end of the line");
    rejected(" SG_ T 0|8@1+ (1,0) [0|0] \"\" N\n", "expected ':'");
    rejected(" SG_ T\n", "expected ':' after the signal's name, got the end of the line");
    rejected(" SG_ T : x|8@1+ (1,0) [0|0] \"\" N\n", "expected the start bit");
    rejected(" SG_ T : 0|0@1+ (1,0) [0|0] \"\" N\n", "has no bits");
    rejected(" SG_ T : 0|8@2+ (1,0) [0|0] \"\" N\n", "1 Intel, 0 Motorola");
    rejected(" SG_ T : 0|8@1 (1,0) [0|0] \"\" N\n", "expected the sign");
    rejected(" SG_ T : 0|8@1+ (1;0) [0|0] \"\" N\n", "expected ',' after the factor");
    rejected(" SG_ T : 0|8@1+ (nan,0) [0|0] \"\" N\n", "expected the factor, a number");
    rejected(" SG_ T : 0|8@1+ (1e999,0) [0|0] \"\" N\n", "expected the factor, a number");
    rejected(" SG_ T : 0|8@1+ (1,0) [0 0] \"\" N\n", "expected '|' after the minimum");
    rejected(" SG_ T : 0|8@1+ (1,0) [0|0] m N\n", "expected the unit in double quotes");
    rejected(" SG_ T : 0|8@1+ (1,0) [0|0] \"m\n", "never closed");
    rejected("CM_ \"never ends\n\n", "never closed");
    rejected("CM_ \"never ends \\\"", "never closed");
    rejected("BO_ 2 M2: 65536 N\n", "length in bytes, a whole number from 0 to 65535, got '65536'");
    rejected(" SG_ T : 65536|8@1+ (1,0) [0|0] \"\" N\n", "the start bit, a whole number from 0 to 65535");
    rejected(" SG_ T : 0|65536@1+ (1,0) [0|0] \"\" N\n", "number of bits, a whole number from 0 to 65535");
    rejected(" SG_ T : 0|0@1+ (1,0) [0|0] \"\" N\n", "signal 'T' has no bits");
    rejected(" SG_ T : 0|8@1\r\n", "- (signed), got the end of the line");
    rejected("BO_ 2 M2:", "length in bytes, a whole number from 0 to 65535, got the end of the file");
    rejected("SIG_VALTYPE_ 1 S : 4;\n", "2 double, a whole number from 0 to 3, got '4;'");
    rejected("VAL_ 1 S 0 x ;\n", "expected the value's text in double quotes");
    rejected("VAL_ 1 S 0 \"x\"", "expected a value or ';'");
    rejected("BA_ \"GenMsgCycleTime\" BO_ 1 fast;\n", "expected the cycle time in ms");
    CHECK_THROWS_WITH(parse_dbc(" SG_ T : 0|8@1+ (1,0) [0|0] \"\" N\n", "x.dbc"), ContainsSubstring("before the first BO_"));
    CHECK_THROWS_WITH(load_dbc("config/none.dbc"), ContainsSubstring("config/none.dbc"));
    CHECK_THROWS_WITH(load_dbc("config"), ContainsSubstring("config"));
}

TEST_CASE("a refusal quotes what it found: to a blank, the end, or twenty characters", "[CAN-030]") {
    const auto quoted = [](const std::string& rest) {
        try {
            static_cast<void>(parse_dbc("BO_ 2 M2: " + rest, "x.dbc"));
        } catch (const settings::Error& error) {
            const std::string what = error.what();
            return what.substr(what.find(", got ") + 6);
        }
        return std::string("accepted");
    };
    CHECK(quoted("eight bytes\n") == "'eight'");
    CHECK(quoted("eight\tbytes\n") == "'eight'");
    CHECK(quoted("eight\n BO_") == "'eight'");
    CHECK(quoted("eight") == "'eight'");
    CHECK(quoted("x") == "'x'");
    CHECK(quoted("abcdefghijklmnopqrst") == "'abcdefghijklmnopqrst'");
    CHECK(quoted("abcdefghijklmnopqrstu") == "'abcdefghijklmnopqrst'");
}

TEST_CASE("lines are counted, files named, and a mark or a string in several lines hides nothing", "[CAN-030]") {
    const Dbc dbc = parse_dbc(
        "\xEF\xBB\xBF"
        "BO_ 0 Zero: 8 N\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n\nBO_ 9 Nine: 8 N\n"
        " SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\nBU_SG_REL_ \"one\nBO_ x\"\nVAL_ 0 S 1 \"zero\" ;\n"
        "VAL_ 9 S 2 \"nine\" ;\nVAL_ :odd 0 \"x\" ;\nBA_ \"GenMsgDelayTime\" BO_ 9 7;\n"
        "SIG_VALTYPE_ 9 S : 3;\n",
        "dir/x.dbc");
    CHECK(dbc.file == "dir/x.dbc");
    REQUIRE(dbc.messages.size() == 2);
    CHECK(dbc.messages[0].line == 1);
    CHECK(dbc.messages[1].line == 4);
    CHECK(dbc.messages[1].signals[0].line == 5);
    CHECK(dbc.messages[0].signals[0].values == std::map<std::int64_t, std::string>{{1, "zero"}});
    CHECK(dbc.messages[1].signals[0].values == std::map<std::int64_t, std::string>{{2, "nine"}});
    CHECK_FALSE(dbc.messages[1].cycle_time_ms.has_value());
    CHECK(dbc.messages[1].signals[0].floating);
}

TEST_CASE("no garbage crashes the reader", "[CAN-030]") {
    const std::vector<std::string> files{can_test::contents("config/antiskid.dbc"), can_test::contents("config/foreign.dbc"),
                                         std::string(kRealWorld)};
    for (const std::string& text : files) {
        std::size_t failed = 0;
        for (std::size_t length = 0; length <= text.size(); ++length) {
            failed += survives(std::string_view(text).substr(0, length)) ? 0 : 1;
        }
        CHECK(failed == 0);
    }
    std::mt19937 random(30);
    std::size_t failed = 0;
    for (int i = 0; i < 3000; ++i) {
        std::string text = files[static_cast<std::size_t>(i) % files.size()];
        for (int edits = 0; edits < 5; ++edits) {
            const std::size_t at = std::uniform_int_distribution<std::size_t>(0, text.size() - 1)(random);
            switch (std::uniform_int_distribution<int>(0, 2)(random)) {
                case 0:
                    text[at] = static_cast<char>(std::uniform_int_distribution<int>(0, 255)(random));
                    break;
                case 1:
                    text.erase(at, 1 + at % 40);
                    break;
                default:
                    text.insert(at, text.substr(text.size() - at - 1, 1 + at % 60));
            }
        }
        failed += survives(text) ? 0 : 1;
    }
    for (int i = 0; i < 500; ++i) {
        std::string text(static_cast<std::size_t>(i), '\0');
        for (char& c : text) c = static_cast<char>(std::uniform_int_distribution<int>(0, 255)(random));
        failed += survives(text) ? 0 : 1;
        failed += survives("BO_ 1 M: 8 N\n SG_ " + text) ? 0 : 1;
    }
    CHECK(failed == 0);
}

TEST_CASE("our DBC explains itself: every message and signal has a comment, every code its names", "[CAN-030]") {
    const Dbc dbc = load_dbc("config/antiskid.dbc");
    CHECK(dbc.messages.size() == kRoleCount);
    for (const DbcMessage& message : dbc.messages) {
        INFO(message.name);
        CHECK_FALSE(message.comment.empty());
        CHECK(message.id <= 0x7FF);
        for (const DbcSignal& signal : message.signals) {
            INFO(signal.name);
            CHECK_FALSE(signal.comment.empty());
            CHECK_FALSE(signal.big_endian);
            CHECK(signal.min < signal.max);
            if (signal.bits == 1) CHECK(signal.values.size() == 2);
        }
    }
    const auto values_of = [&dbc](const std::string& message_name, const std::string& signal_name) {
        const auto message = std::ranges::find(dbc.messages, message_name, &DbcMessage::name);
        return std::ranges::find(message->signals, signal_name, &DbcSignal::name)->values;
    };
    const auto laws = values_of("ManeuverCommand", "Law");
    REQUIRE(laws.size() == kLawNames.size());
    for (const auto& [code, text] : laws) CHECK(text == kLawNames[static_cast<std::size_t>(code)]);
    const auto states = values_of("ControllerStatus", "State");
    REQUIRE(states.size() == kStateNames.size());
    for (const auto& [code, text] : states) CHECK(text == kStateNames[static_cast<std::size_t>(code)]);
}
