#include "rig_bridge/wear/surface_table.hpp"

#include <algorithm>
#include <cmath>

namespace wear {

double on_line(std::span<const double> x, std::span<const double> y, double x_there) {
    const auto above = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), x_there) - x.begin());
    if (above == 0) return y.front();
    if (above == x.size()) return y.back();
    return std::lerp(y[above - 1], y[above], (x_there - x[above - 1]) / (x[above] - x[above - 1]));
}

const SurfaceTable::Row* SurfaceTable::find(std::string_view surface) const {
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.surface == surface; });
    return row == rows.end() ? nullptr : &*row;
}

double SurfaceTable::at(const std::vector<double>& values, double slip_reference) const {
    return on_line(reference, values, slip_reference);
}

}  // namespace wear
