#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "rig_bridge/pictures/gnuplot.hpp"
#include "rig_bridge/pictures/map.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

namespace {

using can_test::TempDir;
using pictures::Map;

/// The SVG of it, with the PNG beside it and nothing else.
std::string svg_of(const Map& map) {
    const TempDir dir;
    pictures::draw(map, 500, dir.path() / "m.png");
    CHECK(std::filesystem::exists(dir.path() / "m.png"));
    CHECK(std::distance(std::filesystem::directory_iterator(dir.path()), {}) == 2);
    std::ifstream in(dir.path() / "m.svg", std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
    return found;
}

}  // namespace

TEST_CASE("a map of classes names them, its columns and its rows, and leaves out what is not there", "[STUDY-185]") {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    Map map{.title = "it's a_map",
            .columns = 3,
            .values = {0.0, 1.0, kNone, 1.0, 0.0, 0.0},
            .x = {0.0, 2.0},
            .y = {0.0, 1.0},
            .classes = {"well", "ill"},
            .column_names = {.names = {{"first", 0.0}, {"others", 1.5}}, .lines = {0.5}},
            .row_names = {.names = {{"upper_row", 0.0}, {"lower_row", 1.0}}}};
    const std::string svg = svg_of(map);
    for (const char* said : {"s a_map", "first", "others", "upper_row", "lower_row", "well", "ill"}) CHECK_THAT(svg, ContainsSubstring(said));
    CHECK(svg.find("upper_row") < svg.find("lower_row"));
    CHECK_THAT(svg, !ContainsSubstring("third"));
    map.values[2] = 1.0;
    CHECK(svg_of(map) != svg);
    map.classes = {"well", "middling", "ill"};
    CHECK_THAT(svg_of(map), ContainsSubstring("middling"));
}

TEST_CASE("a map of a quantity has its lines, its colours' label and its points", "[STUDY-185]") {
    constexpr std::size_t kSide = 21;
    Map map{.x_label = "x (m)",
            .y_label = "y (s)",
            .columns = kSide,
            .x = {-1.0, 1.0},
            .y = {-1.0, 1.0},
            .value_label = "height (m)",
            .value_range = {0.0, 2.0},
            .contour_step = 1.5};
    for (std::size_t row = 0; row < kSide; ++row) {
        for (std::size_t column = 0; column < kSide; ++column) {
            const double x = static_cast<double>(column) / 10.0 - 1.0, y = static_cast<double>(row) / 10.0 - 1.0;
            map.values.push_back(x * x + y * y);
        }
    }
    const std::string line = "stroke='rgb( 68,  68,  68)'";  // of contours
    const std::string few = svg_of(map);
    CHECK_THAT(few, ContainsSubstring("x (m)") && ContainsSubstring("y (s)") && ContainsSubstring("height (m)"));
    CHECK(count(few, line) > 0);
    map.contour_step = 0.25;
    CHECK(count(svg_of(map), " L") > count(few, " L"));  // pieces of lines
    map.value_range = {5.0, 6.0};
    CHECK(count(svg_of(map), line) == 0);
    CHECK_THAT(few, !ContainsSubstring("dots"));
    map.value_range = {0.0, 2.0};
    pictures::Series dots{.name = "dots", .style = pictures::Style::points, .colour = pictures::vermillion};
    dots.add(0.0, 0.0);
    map.points.push_back(dots);
    CHECK_THAT(svg_of(map), ContainsSubstring("dots"));
}
