#include "rig_bridge/wear/floor.hpp"

#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/catch.hpp"

using wear::allowed;
using wear::Range;
using wear::SurfaceTable;

namespace {

double line(const SurfaceTable& table, std::size_t row, double x) {
    std::size_t i = 0;
    while (i + 2 < table.reference.size() && table.reference[i + 1] < x) ++i;
    const double t = (x - table.reference[i]) / (table.reference[i + 1] - table.reference[i]);
    return (1.0 - t) * table.rows[row].j_mu[i] + t * table.rows[row].j_mu[i + 1];
}

/// Walks away from the reference in small steps until some surface falls below the floor.
double walked(const SurfaceTable& table, double floor, double from, double step) {
    double x = from;
    for (; x >= table.reference.front() && x <= table.reference.back(); x += step) {
        for (std::size_t row = 0; row < table.rows.size(); ++row)
            if (line(table, row, x) < floor) return x - step;
    }
    return x - step;
}

}  // namespace

TEST_CASE("the allowed range is where a walk from the default first meets the floor", "[STUDY-167]") {
    std::mt19937 generator(11);
    std::uniform_real_distribution<double> j(0.7, 1.0);
    int bounded = 0;
    for (int repeat = 0; repeat < 200; ++repeat) {
        SurfaceTable table{.reference = {0.06, 0.1, 0.15, 0.22, 0.26, 0.3, 0.4, 0.5}, .rows = {}};
        for (const char* name : {"a", "b", "c"}) {
            SurfaceTable::Row row{name, {}};
            for (const double x : table.reference) row.j_mu.push_back(x > 0.2 && x < 0.28 ? 0.95 : j(generator));
            table.rows.push_back(row);
        }
        const std::vector<std::string> all{"a", "b", "c"};
        const Range range = allowed(table, all, 0.85, 0.24);
        CHECK(range.lowest == Approx(walked(table, 0.85, 0.24, -1e-4)).margin(2e-4));
        CHECK(range.highest == Approx(walked(table, 0.85, 0.24, 1e-4)).margin(2e-4));
        const std::vector<std::string> one{"b"};
        CHECK(allowed(table, one, 0.85, 0.24).lowest <= range.lowest);
        if (range.lowest > 0.061 && range.highest < 0.499) ++bounded;
    }
    CHECK(bounded > 100);
}

TEST_CASE("a surface that is unknown, or on which the default is below the floor, is refused by name", "[STUDY-167]") {
    const SurfaceTable table{.reference = {0.1, 0.3}, .rows = {{"ice", {0.99, 0.99}}, {"cobble", {0.5, 0.9}}}};
    const std::vector<std::string> cobble{"ice", "cobble"};
    const std::vector<std::string> grass{"grass"};
    const std::vector<std::string> ice{"ice"};
    CHECK_THROWS_WITH(allowed(table, cobble, 0.85, 0.24), ContainsSubstring("cobble") && ContainsSubstring("0.780"));
    CHECK_THROWS_WITH(allowed(table, grass, 0.85, 0.24), ContainsSubstring("grass") && ContainsSubstring("ice, cobble"));
    CHECK_THROWS_AS(allowed(table, ice, 0.85, 0.4), std::invalid_argument);
    CHECK(allowed(table, ice, 0.85, 0.24) == Range{0.1, 0.3});
    CHECK(allowed(table, cobble, 0.7, 0.24).lowest == Approx(0.2));
    CHECK(allowed(table, ice, 0.85, 0.3) == Range{0.1, 0.3});
    CHECK(allowed(table, ice, 0.85, 0.1) == Range{0.1, 0.3});
}
