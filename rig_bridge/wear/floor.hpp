/// Table of J_mu, tyre share and stopping distance per slip reference and surface, measured by `rig-lab regulate --characterise`, and the range of
/// references that keep J_mu above a floor by it.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace wear {

/// Linear between the references.
struct SurfaceTable {
    /// Each vector has one value per `reference`.
    struct Row {
        std::string surface;
        std::vector<double> j_mu{};        ///< of eq. (16), the smallest of all maneuvers with a new and a worn brake
        std::vector<double> tyre_share{};  ///< of brake plus tyre energy, over all these maneuvers; increases with the reference
        std::vector<double> distance_m{};  ///< from brake-on to standstill, mean of these maneuvers
    };
    std::vector<double> reference;  ///< rising, at least two
    std::vector<Row> rows;

    [[nodiscard]] const Row* find(std::string_view surface) const;
    /// A row's `values` interpolated at `slip_reference`; constant beyond the table.
    [[nodiscard]] double at(const std::vector<double>& values, double slip_reference) const;
};

/// `y` at `x_there`, interpolated linearly in the points (x, y), x ascending; constant beyond them.
[[nodiscard]] double on_line(std::span<const double> x, std::span<const double> y, double x_there);

struct Range {
    double lowest = 0.0;
    double highest = 0.0;
    [[nodiscard]] bool contains(double reference) const { return reference >= lowest && reference <= highest; }
    /// The intersection of both.
    [[nodiscard]] Range within(const Range& other) const { return {std::max(lowest, other.lowest), std::min(highest, other.highest)}; }
    bool operator==(const Range&) const = default;
};

/// The widest range around `reference` in which J_mu stays at or above `floor` on every one of `surfaces`, within the table's references.
/// Throws std::invalid_argument, naming the surface, for one that is not in the table, or on which `reference` itself is below the floor or outside
/// the table.
[[nodiscard]] Range allowed(const SurfaceTable& table, std::span<const std::string> surfaces, double floor, double reference);

/// The table's references within `range`, and the ends of `range`.
[[nodiscard]] std::vector<double> references_in(const SurfaceTable& table, const Range& range);

}  // namespace wear
