// Checks as people and programs read them.
#include "firmware/controller/check.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/json.hpp"
#include "tests/controller/results.hpp"

using namespace controller_test;

namespace {

controller::Report sample() {
    controller::Report report{.program = "p", .interface = "can0", .config_hash = "abc", .checks = {}};
    report.checks.push_back(controller::judged("one", true, {.measured = "m1", .required = "r1", .remedy = "c1"}));
    report.checks.push_back(controller::judged("two", false, {.measured = "m2", .required = "r2", .remedy = "c2"}, controller::CheckResult::warn));
    report.checks.push_back(controller::skipped("three", "not asked for", "r3"));
    return report;
}

}  // namespace

TEST_CASE("a report passes with warnings and skipped checks, not with a failed one", "[RT-130]") {
    controller::Report report = sample();
    CHECK(controller::passed(report));
    CHECK(controller::deliver(report, "") == 0);
    report.checks.push_back(controller::judged("four", false, {.measured = "m4", .required = "r4", .remedy = "c4"}));
    CHECK_FALSE(controller::passed(report));
    CHECK(controller::deliver(report, "") == 1);
    CHECK_THAT(controller::table(report), ContainsSubstring("FAIL     four"));
    CHECK_THAT(controller::json(report), ContainsSubstring("\"fail\""));
}

TEST_CASE("the table has a line a check, and the remedy of those that did not pass", "[RT-130]") {
    const std::string text = controller::table(sample());
    CHECK_THAT(text, ContainsSubstring("pass     one") && ContainsSubstring("warn     two") && ContainsSubstring("skipped  three") &&
                         ContainsSubstring("-> c2"));
    CHECK_THAT(text, !ContainsSubstring("c1"));
    CHECK_THAT(text, ContainsSubstring("0 FAIL, 1 warn, 1 skipped, 1 pass"));
}

TEST_CASE("JSON has verdict, measured, required, remedy and figures, also of text that is not UTF-8", "[RT-130]") {
    controller::Report report = sample();
    report.checks[0].figures = {{"max_us", 12.5}};
    report.checks[1].measured = "can\xff";
    const auto read = settings::parse_json(controller::json(report));
    CHECK(read["passed"] == true);
    CHECK(read["config_hash"] == "abc");
    CHECK(read["checks"][0]["figures"]["max_us"] == 12.5);
    CHECK(read["checks"][1]["verdict"] == "warn");
    CHECK(read["checks"][1]["remedy"] == "c2");
    CHECK(read["checks"][2]["measured"] == "not asked for");
}

TEST_CASE("JSON goes to a file; a place that cannot be written is an error", "[RT-130]") {
    const auto file = std::filesystem::temp_directory_path() / ("check_" + std::to_string(getpid()) + ".json");
    CHECK(controller::deliver(sample(), file.string()) == 0);
    std::ifstream in(file);
    CHECK(settings::Json::parse(in)["program"] == "p");
    std::filesystem::remove(file);
    CHECK_THROWS_AS(controller::deliver(sample(), "/proc/none/check.json"), settings::Error);
}
