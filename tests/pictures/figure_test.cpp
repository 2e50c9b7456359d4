#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "firmware/host/settings/json.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

namespace {

using can_test::TempDir;
using pictures::Series;

std::string bytes(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// What draw() leaves for a page.
settings::Json drawn(const TempDir& dir, pictures::Chart chart) {
    pictures::draw({.title = "it's a_title", .charts = {std::move(chart)}}, dir.path() / "f.png");
    return settings::parse_json(bytes(dir.path() / "f.charts.json"));
}

}  // namespace

TEST_CASE("a figure is a PNG, an SVG and the data of its charts", "[STUDY-185]") {
    const TempDir dir;
    Series dots{.name = "dots", .style = pictures::Style::points, .colour = pictures::vermillion, .notes = {"late", "early"}};
    dots.add(3.0, 30.0);
    dots.add(1.0, std::numeric_limits<double>::quiet_NaN());
    Series band{.name = "a \"band\""};
    band.add(1.0, 20.0, 10.0, 30.0);
    band.add(3.0, 21.0, 11.0, 31.0);
    const auto json = drawn(dir, {.y_label = "y (m)",
                                  .x_label = "x (s)",
                                  .series = {dots, band, pictures::level("limit", 1.0, 3.0, 25.0, pictures::grey)},
                                  .y_range = pictures::Range{0.0, 40.0},
                                  .marks = {2.0}});
    CHECK(bytes(dir.path() / "f.png").starts_with("\x89PNG"));
    CHECK_THAT(bytes(dir.path() / "f.svg"), ContainsSubstring("<svg") && ContainsSubstring("s a_title") && ContainsSubstring("late"));
    CHECK(std::distance(std::filesystem::directory_iterator(dir.path()), {}) == 3);
    CHECK(json["title"] == "it's a_title");
    const auto& chart = json["charts"][0];
    CHECK(chart["x_range"].is_null());
    CHECK(chart["y_range"] == std::vector{0.0, 40.0});
    CHECK(chart["marks"] == std::vector{2.0});
    const auto& series = chart["series"];
    CHECK(series[0]["x"] == std::vector{1.0, 3.0});  // in order
    CHECK(series[0]["y"][0].is_null());
    CHECK(series[0]["notes"] == std::vector<std::string>{"early", "late"});
    CHECK(series[0]["color"] == pictures::gnuplot_colour(pictures::vermillion));
    CHECK(series[1]["name"] == "a \"band\"");
    CHECK(series[1]["x"] == 0);  // that of the first
    CHECK(series[1]["low"] == std::vector{10.0, 11.0});
    CHECK(series[2]["style"] == "dashes");
}

TEST_CASE("of a long series no peak and no gap is lost, and series over the same x keep the same places", "[STUDY-185]") {
    const TempDir dir;
    constexpr int kRows = 100000;
    Series a{.name = "a"}, b{.name = "b"};
    for (int i = 0; i < kRows; ++i) {
        const double x = i * 1e-3;
        a.add(x, std::sin(x) + (i == 54321 ? 9.0 : 0.0));
        b.add(x, i == 12345 ? -7.0 : i == 77777 ? std::numeric_limits<double>::quiet_NaN() : std::cos(x));
    }
    const auto json = drawn(dir, {.series = {a, b}});
    const auto& series = json["charts"][0]["series"];
    const auto x = series[0]["x"].get<std::vector<double>>();
    CHECK(x.size() < 3000);
    CHECK(x.front() == 0.0);
    CHECK(x.back() == Approx(99.999));
    CHECK(std::is_sorted(x.begin(), x.end()));
    CHECK(series[1]["x"] == 0);
    const auto spike = std::find(x.begin(), x.end(), 54.321);
    REQUIRE(spike != x.end());
    CHECK(series[0]["y"][static_cast<std::size_t>(spike - x.begin())] == Approx(std::sin(54.321) + 9.0).epsilon(1e-5));
    CHECK(std::count(series[1]["y"].begin(), series[1]["y"].end(), -7.0) == 1);
    CHECK(std::count(series[1]["y"].begin(), series[1]["y"].end(), settings::Json()) == 1);
}

TEST_CASE("what gnuplot says reaches whoever asked for a picture, and nothing is left", "[STUDY-185]") {
    const TempDir dir;
    CHECK_THROWS_WITH(pictures::run_gnuplot(dir.path() / "f.png", 100, 100, "plot nonsense"), ContainsSubstring("nonsense"));
    CHECK(std::filesystem::is_empty(dir.path()));
    // More than a pipe holds, into a folder that is not there yet.
    const std::string much = "$d << EOD\n" + std::string(200'000, ' ') + "\n1\nEOD\nplot $d\n";
    pictures::run_gnuplot(dir.path() / "made" / "f.png", 100, 100, much);
    CHECK(std::filesystem::exists(dir.path() / "made" / "f.svg"));
    pictures::run_gnuplot(dir.path() / "asked" / "v1.2.svg", 100, 100, much);
    CHECK_THAT(bytes(dir.path() / "asked" / "v1.2.svg"), ContainsSubstring("<svg"));
    CHECK(bytes(dir.path() / "asked" / "v1.2.png").starts_with("\x89PNG"));
    const std::string path = std::getenv("PATH");
    ::setenv("PATH", dir.path().c_str(), 1);
    CHECK_THROWS_WITH(pictures::run_gnuplot(dir.path() / "g.png", 100, 100, much), ContainsSubstring("is gnuplot-nox installed?"));
    ::setenv("PATH", path.c_str(), 1);
    CHECK_FALSE(std::filesystem::exists(dir.path() / "g.png.gnuplot"));
}

TEST_CASE("a logarithmic axis is one in the picture and in the data", "[STUDY-185]") {
    const TempDir dir;
    Series decades{.name = "decades", .x = {1.0, 2.0, 3.0, 4.0, 5.0}, .y = {1.0, 10.0, 100.0, 1000.0, 10000.0}};
    CHECK(drawn(dir, {.series = {decades}})["charts"][0]["log_y"] == false);
    CHECK_THAT(bytes(dir.path() / "f.svg"), !ContainsSubstring("> 100<"));
    const auto json = drawn(dir, {.series = {decades}, .logarithmic_y = true});
    CHECK(json["charts"][0]["log_y"] == true);
    CHECK(json["charts"][0]["log_x"] == false);
    CHECK_THAT(bytes(dir.path() / "f.svg"), ContainsSubstring("> 100<"));
}
