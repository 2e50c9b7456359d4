/// Which slip references keep J_mu above a floor: a table J_mu(reference, surface) from a characterisation run, and the range that it allows.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace wear {

struct Range {
    double lowest = 0.0;
    double highest = 0.0;
    [[nodiscard]] bool contains(double reference) const { return reference >= lowest && reference <= highest; }
    bool operator==(const Range&) const = default;
};

/// J_mu of eq. (16) over the slip reference, the worst maneuver of each surface; linear between the references.
struct FloorTable {
    struct Row {
        std::string surface;
        std::vector<double> j_mu;  ///< at each of `reference`
    };
    std::vector<double> reference;  ///< rising, at least two
    std::vector<Row> rows;

    [[nodiscard]] const Row* find(std::string_view surface) const;
};

/// The widest range around `reference` in which J_mu stays at or above `floor` on every one of `surfaces`, within the table's references.
/// Throws std::invalid_argument, naming the surface, for one that the table does not have, or on which `reference` itself is below the floor
/// or outside of the table.
[[nodiscard]] Range allowed(const FloorTable& table, std::span<const std::string> surfaces, double floor, double reference);

}  // namespace wear
