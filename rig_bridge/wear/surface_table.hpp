/// What a slip reference gives on each surface: J_mu, the tyre's share, the stop's length. Measured by `rig-lab regulate --characterise`.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace wear {

/// Linear between the references.
struct SurfaceTable {
    /// Each has a value for each of `reference`.
    struct Row {
        std::string surface;
        std::vector<double> j_mu{};        ///< of eq. (16), the least of all maneuvers with a new brake and a worn one
        std::vector<double> tyre_share{};  ///< of brake and tyre energy, of all of these together; rises with the reference
        std::vector<double> distance_m{};  ///< from brake-on to the stop, their mean
    };
    std::vector<double> reference;  ///< rising, at least two
    std::vector<Row> rows;

    [[nodiscard]] const Row* find(std::string_view surface) const;
    /// A row's `values` at `reference`; beyond the table those of its end.
    [[nodiscard]] double at(const std::vector<double>& values, double slip_reference) const;
};

/// `y` at `x_there` on the line through the points (x, y), x rising; beyond them the end's.
[[nodiscard]] double on_line(std::span<const double> x, std::span<const double> y, double x_there);

}  // namespace wear
