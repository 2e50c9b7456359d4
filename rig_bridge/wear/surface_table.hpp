/// J_mu, tyre share and stopping distance per slip reference and surface. Measured by `rig-lab regulate --characterise`.
#pragma once

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

}  // namespace wear
