/// Range of slip references that keep J_mu above a floor, by the table of surfaces.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "rig_bridge/wear/surface_table.hpp"

namespace wear {

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
