// Every character of a log line replaced, taken out and doubled, against a regular expression that says what a line is.
#include "firmware/can/candump.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <initializer_list>
#include <optional>
#include <regex>
#include <string>

#include "tests/catch.hpp"

using namespace antiskid::can;

namespace {

/// What a line says, by the expression; nothing if it is none.
std::optional<CandumpLine> expected(const std::string& text, std::smatch& match) {
    static const std::regex form(
        R"(\((\d{1,18})\.(\d{1,9})\) +([^ ]+) +([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})#(R([0-8]?)|(([0-9A-Fa-f]{2}){0,8}))( [RT])?[\r\n]*)");
    if (!std::regex_match(text, match, form)) return {};
    const std::int64_t seconds = std::stoll(match[1]);
    if (seconds > 9'000'000'000) return {};
    const std::string fraction = match[2].str() + std::string(9 - match[2].str().size(), '0');
    const auto id = static_cast<std::uint32_t>(std::stoul(match[4], nullptr, 16));
    const bool is_long = match[4].length() == 8;
    if (id > (is_long ? 0x3FFF'FFFFU : 0x7FFU)) return {};
    CandumpLine line;
    line.time = Time{seconds * 1'000'000'000 + std::stoll(fraction)};
    line.error = is_long && id >= 0x2000'0000U;
    line.extended = is_long && !line.error;
    line.frame.id = id % 0x2000'0000U;
    line.frame.received = line.time;
    line.remote = match[5].str().starts_with('R');
    if (line.remote) {
        line.frame.length = static_cast<std::uint8_t>(std::atoi(match[6].str().c_str()));
    } else {
        const std::string bytes = match[7];
        line.frame.length = static_cast<std::uint8_t>(bytes.size() / 2);
        for (std::size_t i = 0; i < line.frame.length; ++i)
            line.frame.data[i] = static_cast<std::uint8_t>(std::stoul(bytes.substr(2 * i, 2), nullptr, 16));
    }
    return line;
}

bool same(const CandumpLine& a, const CandumpLine& b) {
    return a.time == b.time && a.frame.id == b.frame.id && a.frame.length == b.frame.length && a.frame.data == b.frame.data &&
           a.frame.received == b.frame.received && a.extended == b.extended && a.remote == b.remote && a.error == b.error;
}

/// Empty if the parser agrees with the expression.
std::string disagreement(const std::string& text) {
    std::smatch match;
    const std::optional<CandumpLine> wanted = expected(text, match);
    const auto result = parse_candump(text);
    const auto* const line = std::get_if<CandumpLine>(&result);
    if (wanted.has_value() != (line != nullptr)) return (line != nullptr ? "read: " : "refused: ") + text;
    if (line == nullptr) return {};
    if (!same(*wanted, *line) || line->interface != match[3].str()) return "read wrongly: " + text;
    return {};
}

}  // namespace

TEST_CASE("a line is read if it is one, and refused if it is none, whichever character is wrong", "[CAN-050]") {
    const std::string line = GENERATE(as<std::string>{}, "(1436509053.650713) vcan0 1A0#0011AAff9F", "(0000000000.000001) c 7FF#",
                                      "(9000000000.000000) can10 000#0011223344556677\n", "(12.5)  vcan0  1ABCDEF0#R8",
                                      "(1436509053.650713987) vcan0 20000004#00 T\r\n", "(1436509053.650713) vcan0 3FFFFFFF#");
    REQUIRE(disagreement(line).empty());
    const std::string spoilers = " !()*#$./:0189@AFGR`afg\r\n\x7f\xb0T";
    for (std::size_t at = 0; at < line.size(); ++at) {
        std::string shorter = line;
        shorter.erase(at, 1);
        CHECK(disagreement(shorter).empty());
        CHECK(disagreement(line.substr(0, at)).empty());
        for (const char c : spoilers) {
            std::string changed = line;
            changed[at] = c;
            const std::string wrong = disagreement(changed);
            if (!wrong.empty()) FAIL_CHECK(wrong);
            std::string longer = line;
            longer.insert(at, 1, c);
            const std::string wrong_too = disagreement(longer);
            if (!wrong_too.empty()) FAIL_CHECK(wrong_too);
        }
    }
}

TEST_CASE("what lies behind the end of a line is not of it", "[CAN-050]") {
    const std::string text = "(1.5) vcan0 12345678#R8 (1436509053.650713) vcan0 1A0#00118";
    for (const std::size_t from : {std::size_t{0}, text.rfind('(')}) {
        for (std::size_t size = 1; size <= text.size() - from; ++size) {
            INFO(size << " characters from " << from);
            const auto part = parse_candump(std::string_view(text).substr(from, size));
            std::smatch match;
            const std::string alone = text.substr(from, size);
            CHECK(std::holds_alternative<CandumpLine>(part) == expected(alone, match).has_value());
        }
    }
    const auto part = parse_candump(std::string_view(text).substr(0, text.find('8', 15) + 3));
    REQUIRE(std::holds_alternative<CandumpLine>(part));
    CHECK(std::get<CandumpLine>(part).frame.length == 0);
}

TEST_CASE("numbers of a line at their limits", "[CAN-050]") {
    for (const char* const text :
         {"(9000000001.000000) vcan0 123#", "(9000000000.999999) vcan0 123#", "(8999999999.999999) vcan0 123#", "(1.0) vcan0 7FF#",
          "(1436509053.650713) vcan0 800#", "(1.0) vcan0 800#", "(1.0) vcan0 40000000#", "(1.0) vcan0 3FFFFFFF#", "(1.0) vcan0 20000000#",
          "(1.0) vcan0 1FFFFFFF#", "(1.0) vcan0 123#R9", "(1436509053.650713) vcan0 123#001122334455667788", "(1436509053.650713) vcan0 123#001",
          "(1.0) vcan0 123#R0", "(1.0) vcan0 123#R1", "(99999999990.0) vcan0 123#", "(1436509053.650713)  1A0#0011", "(1436509053.650713) a#12345 "})
        CHECK(disagreement(text).empty());
    // As a signed character 0xD0 lies as far below zero as a digit above.
    std::string high_bytes = "(1436509053.650713) vcan0 123#";
    for (char& c : high_bytes)
        if (c >= '0' && c <= '9' && &c < high_bytes.data() + 18) c = static_cast<char>(c - 2 * '0');
    CHECK(disagreement(high_bytes).empty());
    const auto fd = parse_candump("(1.0) vcan0 123##1");
    REQUIRE(std::holds_alternative<CandumpFailure>(fd));
    CHECK(std::get<CandumpFailure>(fd).fd);
    CHECK_FALSE(std::get<CandumpFailure>(parse_candump("(1.0) vcan0 123")).fd);
}

TEST_CASE("each character of a line's time is judged", "[CAN-050]") {
    const std::string line = "(1436509053.650713) vcan0 1A0#0011";
    REQUIRE(std::holds_alternative<CandumpLine>(parse_candump(line)));
    for (std::size_t at = 0; at < 20; ++at) {
        for (const char wrong : {'/', ':', '?', ',', 'p', '\x10', '\xB5'}) {
            std::string text = line;
            text[at] = wrong;
            INFO(text);
            CHECK(std::holds_alternative<CandumpFailure>(parse_candump(text)));
        }
    }
}

TEST_CASE("a line that just fits is written, one that does not leaves its neighbours alone", "[CAN-050]") {
    const Frame frame{.id = 0x1A0, .length = 2, .data = {0, 0x11}, .received = {}};
    const std::string wanted = "(0000000001.000002) vcan0 1A0#0011";
    for (const std::size_t room : {wanted.size() + 1, wanted.size(), wanted.size() - 1}) {
        std::array<char, kCandumpLineMax> out{};
        out.fill('~');
        const std::size_t size = format_candump(Time{1'000'002'000}, "vcan0", frame, {out.data(), room});
        CHECK(size == (room < wanted.size() ? 0 : wanted.size()));
        CHECK(std::string(out.data(), std::min(room, wanted.size())) == wanted.substr(0, room));
        CHECK(out[room] == '~');
    }
    CandumpLine remote;
    remote.interface = "c";
    remote.remote = true;
    remote.frame.length = 1;
    std::array<char, kCandumpLineMax> out{};
    CHECK(std::string(out.data(), format_candump(remote, out)) == "(0000000000.000000) c 000#R1");
}

TEST_CASE("a time that no line can have is not written", "[CAN-050]") {
    const Frame frame{.id = 0x1A0, .length = 2, .data = {0, 0x11}, .received = {}};
    std::array<char, kCandumpLineMax> out{};
    const auto size_at = [&](Time time) { return format_candump(time, "vcan0", frame, out); };
    for (const Time time : {Time{-1}, Time{-1'000'000}, Time{-30'000'000'000}, Time::min(), Time{9'000'000'001'000'000'000}, Time::max()})
        CHECK(size_at(time) == 0);
    for (const Time time : {Time{0}, Time{9'000'000'000'999'999'999}}) {
        const std::size_t size = size_at(time);
        REQUIRE(size > 0);
        const auto read = parse_candump({out.data(), size});
        REQUIRE(std::holds_alternative<CandumpLine>(read));
        CHECK(std::get<CandumpLine>(read).time == Time{time.count() / 1000 * 1000});
    }
}
