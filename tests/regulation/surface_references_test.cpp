#include "rig_bridge/wear/surface_references.hpp"

#include <limits>

#include "tests/catch.hpp"

using wear::SurfaceReferences;
using wear::SurfaceTable;

namespace {

/// Surfaces whose stops are d = a + k (r - best)^2 long, the tyre's share the reference itself: Lagrange's answer is known.
struct Parabola {
    double best;
    double k;
};

SurfaceTable table_of(const std::vector<Parabola>& surfaces) {
    SurfaceTable table;
    for (int i = 1; i <= 500; ++i) table.reference.push_back(0.001 * i);
    for (const Parabola& p : surfaces) {
        SurfaceTable::Row& row = table.rows.emplace_back(SurfaceTable::Row{.surface = std::to_string(table.rows.size())});
        row.j_mu.assign(500, 0.95);
        row.tyre_share = table.reference;
        for (const double r : table.reference) row.distance_m.push_back(500.0 + p.k * (r - p.best) * (r - p.best));
    }
    return table;
}

double mean_of(const SurfaceReferences& references, double wanted) {
    double sum = 0.0;
    for (std::size_t s = 0; s < 3; ++s) sum += references.share(s, references.reference(s, wanted)) / 3.0;
    return sum;
}

}  // namespace

TEST_CASE("references of surfaces are Lagrange's, which is known for parabolas", "[STUDY-168]") {
    const std::vector<Parabola> surfaces{{0.15, 1000.0}, {0.25, 500.0}, {0.35, 4000.0}};
    const SurfaceReferences references(table_of(surfaces), 0.85, 0.24);
    for (const double wanted : {0.22, 0.25, 0.28, 0.31}) {
        // r_s = best_s + lambda / (2 k_s); the mean of r_s is what is wanted.
        double best = 0.0;
        double inverse = 0.0;
        for (const Parabola& p : surfaces) {
            best += p.best / 3.0;
            inverse += 1.0 / (2.0 * p.k) / 3.0;
        }
        const double lambda = (wanted - best) / inverse;
        CHECK(mean_of(references, wanted) == Approx(wanted).margin(1e-12));
        for (std::size_t s = 0; s < 3; ++s)
            CHECK(references.reference(s, wanted) == Approx(surfaces[s].best + lambda / (2.0 * surfaces[s].k)).margin(0.0011));
    }
}

TEST_CASE("no other references with the same mean share stop sooner", "[STUDY-168]") {
    // Measured curves are no parabolas: dents, and a bound by the floor.
    SurfaceTable table{.reference = {0.1, 0.2, 0.3, 0.4, 0.5}, .rows = {}};
    table.rows.push_back({"a", {0.9, 0.9, 0.9, 0.9, 0.7}, {0.10, 0.20, 0.30, 0.40, 0.50}, {520.0, 500.0, 506.0, 503.0, 540.0}});
    table.rows.push_back({"b", {0.7, 0.9, 0.9, 0.9, 0.9}, {0.08, 0.17, 0.26, 0.35, 0.44}, {900.0, 860.0, 855.0, 858.0, 870.0}});
    const SurfaceReferences references(table, 0.85, 0.25);
    const auto distance = [&](std::size_t s, double r) { return table.at(table.rows[s].distance_m, r); };
    const wear::Range shares = references.shares();
    CHECK(references.range(0).highest == Approx(0.425));
    CHECK(references.range(1).lowest == Approx(0.175));
    CHECK(references.default_share() == Approx(0.5 * (0.25 + 0.215)));
    for (int i = 0; i <= 20; ++i) {
        const double wanted = shares.lowest + i * (shares.highest - shares.lowest) / 20.0;
        const double a = references.reference(0, wanted), b = references.reference(1, wanted);
        CHECK(references.share(0, a) + references.share(1, b) == Approx(2.0 * wanted).margin(1e-9));
        // By search, with what a mixture of two references on a dent could save, 5 m at most here, left to it.
        double least = std::numeric_limits<double>::infinity();
        for (double r = references.range(0).lowest; r <= references.range(0).highest + 1e-9; r += 1e-4) {
            const double other = (2.0 * wanted - references.share(0, r)) / 0.9 + 0.1 - 0.08 / 0.9;
            if (other < references.range(1).lowest - 1e-9 || other > references.range(1).highest + 1e-9) continue;
            least = std::min(least, distance(0, r) + distance(1, other));
        }
        CAPTURE(wanted, a, b);
        CHECK(distance(0, a) + distance(1, b) < least + 5.0);
    }
    CHECK(references.reference(0, 0.0) == references.range(0).lowest);
    CHECK(references.reference(1, 1.0) == references.range(1).highest);
}

TEST_CASE("where landings are counts, and a shortfall of J_mu bounds that surface alone", "[STUDY-168]") {
    SurfaceReferences references(table_of({{0.15, 1000.0}, {0.25, 500.0}, {0.35, 4000.0}}), 0.85, 0.24);
    const double before = references.reference(1, 0.28);
    for (int i = 0; i < 2000; ++i) references.landed(1);
    CHECK(before != Approx(0.28).margin(0.01));
    CHECK(references.reference(1, 0.28) == Approx(0.28).margin(0.002));
    references.narrow(2, 0.40, 0.02);
    CHECK(references.range(2).highest == Approx(0.38));
    CHECK(references.range(1).highest == Approx(0.5));
    references.narrow(2, 0.25, 0.02);
    CHECK(references.range(2).highest == Approx(0.24));
    CHECK(references.reference(2, 1.0) == Approx(0.24));
}

TEST_CASE("a table whose shares fall is refused by surface", "[STUDY-168]") {
    SurfaceTable table = table_of({{0.15, 1000.0}});
    table.rows[0].tyre_share[10] = 0.5;
    CHECK_THROWS_WITH(SurfaceReferences(table, 0.85, 0.24), ContainsSubstring("on 0"));
}
