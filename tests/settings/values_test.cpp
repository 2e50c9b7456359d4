#include <array>
#include <cstdint>
#include <limits>

#include "tests/settings/refusal.hpp"

namespace {

std::string rejected_number(const std::string& value, const settings::Range& range = {}) {
    const auto doc = parsed("[wheel]\n\nmass_kg = " + value + "\n");
    const auto error = rejection_of([&] { return doc.root().table("wheel").number("mass_kg", range); });
    CHECK(error.file() == "plant.toml");
    CHECK(error.line() == 3);
    CHECK(error.key() == "wheel.mass_kg");
    return error.message();
}

double number(const std::string& value, const settings::Range& range = {}) {
    return parsed("x = " + value).root().number("x", range);
}

template <typename T>
T integer(const std::string& value, const settings::IntegerRange& range = {}) {
    return parsed("x = " + value).root().integer<T>("x", range);
}

template <typename T>
std::string rejected_integer(const std::string& value, const settings::IntegerRange& range = {}) {
    const auto doc = parsed("x = " + value);
    return rejection_of([&] { return doc.root().integer<T>("x", range); }).message();
}

enum class Law { slip, threshold };
constexpr std::array<settings::Choice<Law>, 2> kLaws{{{"wheel_slip", Law::slip}, {"threshold", Law::threshold}}};

}  // namespace

TEST_CASE("a number is read as it stands, also when it is written as an integer", "[CFG-001]") {
    CHECK(number("1.25") == 1.25);
    CHECK(number("3") == 3.0);
    CHECK(number("-2.5e-3") == -2.5e-3);
    CHECK(number("2_700_000") == 2.7e6);
    CHECK(number("0x10") == 16.0);
    CHECK(number("5e-324") == 5e-324);
    CHECK(number("9223372036854775807") == 9223372036854775808.0);
}

TEST_CASE("both ends of a range are allowed and nothing beyond them", "[CFG-001]") {
    const settings::Range range{.min = 0.01, .max = 100.0};
    CHECK(number("0.01", range) == 0.01);
    CHECK(number("100", range) == 100.0);
    CHECK(rejected_number("900", range) == "900 is out of range 0.01 to 100");
    CHECK(rejected_number("100.00000000000001", range) == "100.00000000000001 is out of range 0.01 to 100");
    CHECK(rejected_number("0.009999999999999998", range) == "0.009999999999999998 is out of range 0.01 to 100");
    CHECK(rejected_number("-1", {.min = 0.0}) == "-1 is below 0");
    CHECK(rejected_number("7", {.max = 5.5}) == "7 is above 5.5");
}

TEST_CASE("a number that is no finite number is refused", "[CFG-001]") {
    CHECK(rejected_number("nan") == "expected a finite number, got nan");
    CHECK(rejected_number("-nan", {.min = 0.0, .max = 1.0}).starts_with("expected a finite number, got "));
    CHECK(rejected_number("inf") == "expected a finite number, got inf");
    CHECK(rejected_number("-inf") == "expected a finite number, got -inf");
}

TEST_CASE("a value of another type is refused and shown", "[CFG-001]") {
    CHECK(rejected_number("true") == "expected a number, got the boolean true");
    CHECK(rejected_number("'12'") == "expected a number, got the string '12'");
    CHECK(rejected_number("[1.0]") == "expected a number, got an array");
    CHECK(rejected_number("{ value = 1.0 }") == "expected a number, got a table");
    CHECK(rejected_number("1979-05-27") == "expected a number, got a date or time");
    CHECK(rejected_number("07:32:00") == "expected a number, got a date or time");
    CHECK(rejected_number("'" + std::string(3000, 'x') + "'").size() < 120);

    const auto doc = parsed("a = 1\nb = 'true'\nc = false\nd = ''\n");
    const auto root = doc.root();
    CHECK(rejection_of([&] { return root.boolean("a"); }).message() == "expected true or false, got the integer 1");
    CHECK(rejection_of([&] { return root.boolean("b"); }).message() == "expected true or false, got the string 'true'");
    CHECK(rejection_of([&] { return root.text("c"); }).message() == "expected a string, got the boolean false");
    CHECK(rejection_of([&] { return root.text("d"); }).message() == "expected a string of at least one character");
    CHECK(rejection_of([&] { return root.table("a"); }).message() == "expected a table, got the integer 1");
    CHECK(rejection_of([&] { return root.numbers("a"); }).message() == "expected an array of numbers, got the integer 1");
    CHECK(rejection_of([&] { return root.tables("a"); }).message() == "expected tables, got the integer 1");
}

TEST_CASE("an integer fits its type and its range and is written as one", "[CFG-001]") {
    CHECK(integer<std::uint8_t>("255") == 255);
    CHECK(integer<std::int8_t>("-128") == -128);
    CHECK(integer<std::int64_t>("-9223372036854775808") == std::numeric_limits<std::int64_t>::min());
    CHECK(integer<std::uint64_t>("9223372036854775807") == 9223372036854775807U);
    CHECK(integer<std::uint32_t>("0xFFFFFFFF") == 0xFFFFFFFFU);

    CHECK(rejected_integer<std::uint8_t>("256") == "256 is out of range 0 to 255");
    CHECK(rejected_integer<std::uint16_t>("-1") == "-1 is out of range 0 to 65535");
    CHECK(rejected_integer<std::uint64_t>("-1") == "-1 is below 0");
    CHECK(rejected_integer<std::uint16_t>("0", {.min = 1, .max = 100000}) == "0 is out of range 1 to 65535");
    CHECK(rejected_integer<std::int32_t>("60.0") == "expected an integer, got the number 60");
    CHECK(rejected_integer<std::int32_t>("'60'") == "expected an integer, got the string '60'");
    CHECK(rejected_integer<std::int32_t>("nan") == "expected an integer, got the number nan");
    CHECK(rejection_of([] { return parsed("\nx = 9223372036854775808"); }).line() == 2);
    CHECK(rejection_of([] { return parsed("\nx = 1" + std::string(400, '0')); }).line() == 2);
}

TEST_CASE("a choice is one of its names, and a near miss is pointed at", "[CFG-001]") {
    const auto doc = parsed("a = 'threshold'\nb = 'treshold'\nc = 'pid'\nd = 1\n");
    const auto root = doc.root();
    CHECK(root.choice<Law>("a", kLaws) == Law::threshold);
    CHECK(root.find_choice<Law>("z", kLaws) == std::nullopt);
    CHECK(rejection_of([&] { return root.choice<Law>("b", kLaws); }).what() ==
          std::string("plant.toml:2: b: the string 'treshold' is not one of 'wheel_slip', 'threshold'; "
                      "did you mean 'threshold'?"));
    CHECK(rejection_of([&] { return root.choice<Law>("c", kLaws); }).message() == "the string 'pid' is not one of 'wheel_slip', 'threshold'");
    CHECK(rejection_of([&] { return root.choice<Law>("d", kLaws); }).message() == "expected one of 'wheel_slip', 'threshold', got the integer 1");
}

TEST_CASE("every element of an array of numbers is checked, with its own line", "[CFG-001]") {
    const auto numbers = [](const std::string& array, const settings::NumbersRule& rule = {}) {
        return parsed("[valve]\np_Pa = " + array).root().table("valve").numbers("p_Pa", rule);
    };
    CHECK(numbers("[0, 1.5, 2]") == std::vector<double>{0.0, 1.5, 2.0});
    CHECK(numbers("[]", {.count = {.min = 0}}).empty());

    const auto rejected = [&](const std::string& array, const settings::NumbersRule& rule = {}) {
        return std::string(rejection_of([&] { return numbers(array, rule); }).what());
    };
    CHECK(rejected("[\n 1,\n 2,\n true,\n]") == "plant.toml:5: valve.p_Pa[2]: expected a number, got the boolean true");
    CHECK(rejected("[1, nan]") == "plant.toml:2: valve.p_Pa[1]: expected a finite number, got nan");
    CHECK(rejected("[1, [2]]") == "plant.toml:2: valve.p_Pa[1]: expected a number, got an array");
    CHECK(rejected("[0, 5]", {.range = {.max = 4.0}}) == "plant.toml:2: valve.p_Pa[1]: 5 is above 4");
    CHECK(rejected("[]") == "plant.toml:2: valve.p_Pa: the number of numbers, 0 is below 1");
    CHECK(rejected("[1, 2, 3]", {.count = {.min = 4, .max = 9}}) == "plant.toml:2: valve.p_Pa: the number of numbers, 3 is out of range 4 to 9");
    CHECK(rejected("[1, 2, 2]", {.strictly_increasing = true}) == "plant.toml:2: valve.p_Pa[2]: 2 is not above 2, the number before it");
    CHECK(rejected("[1, 3, 2]", {.strictly_increasing = true}) == "plant.toml:2: valve.p_Pa[2]: 2 is not above 3, the number before it");
}

TEST_CASE("an optional value may be missing but not wrong", "[CFG-001]") {
    const auto doc = parsed("n = 'x'\ni = 1.5\nb = 0\nt = 1\na = 0\nc = 'y'\ns = 1\n");
    const auto root = doc.root();
    CHECK(root.find_number("no") == std::nullopt);
    CHECK(root.find_integer("no") == std::nullopt);
    CHECK(root.find_boolean("no") == std::nullopt);
    CHECK(root.find_text("no") == std::nullopt);
    CHECK(root.find_numbers("no") == std::nullopt);
    CHECK_FALSE(root.find_table("no").has_value());
    CHECK(root.tables("no", {.min = 0}).empty());
    CHECK(rejection_of([&] { return root.find_number("n"); }).line() == 1);
    CHECK(rejection_of([&] { return root.find_integer("i"); }).line() == 2);
    CHECK(rejection_of([&] { return root.find_boolean("b"); }).line() == 3);
    CHECK(rejection_of([&] { return root.find_text("t"); }).line() == 4);
    CHECK(rejection_of([&] { return root.find_numbers("a"); }).line() == 5);
    CHECK(rejection_of([&] { return root.find_choice<Law>("c", kLaws); }).line() == 6);
    CHECK(rejection_of([&] { return root.find_table("s"); }).line() == 7);
}
