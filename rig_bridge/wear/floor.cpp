#include "rig_bridge/wear/floor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <stdexcept>

namespace wear {

namespace {

/// x at which the line from (x0, y0), not below the floor, to (x1, y1), below it, reaches the floor.
double crossing(double x0, double y0, double x1, double y1, double floor) {
    return x0 + (x1 - x0) * (y0 - floor) / (y0 - y1);
}

Range on_surface(const std::vector<double>& x, const SurfaceTable::Row& row, double floor, double reference) {
    const std::vector<double>& y = row.j_mu;
    const auto above = static_cast<std::size_t>(std::distance(x.begin(), std::upper_bound(x.begin(), x.end() - 1, reference)));
    const double here = on_line(x, y, reference);
    if (!(here >= floor))
        throw std::invalid_argument(
            fmt::format("on {} J_mu at the default reference {} is {:.3f}, below the floor {}: "
                        "expected a lower floor or another default",
                        row.surface, reference, here, floor));
    Range range{reference, reference};
    double last_x = reference;
    double last_y = here;
    for (std::size_t k = above; k < x.size(); ++k) {
        if (y[k] < floor) {
            range.highest = crossing(last_x, last_y, x[k], y[k], floor);
            break;
        }
        range.highest = last_x = x[k];
        last_y = y[k];
    }
    last_x = reference;
    last_y = here;
    for (std::size_t k = above; k-- > 0;) {
        if (y[k] < floor) {
            range.lowest = crossing(last_x, last_y, x[k], y[k], floor);
            break;
        }
        range.lowest = last_x = x[k];
        last_y = y[k];
    }
    return range;
}

}  // namespace

Range allowed(const SurfaceTable& table, std::span<const std::string> surfaces, double floor, double reference) {
    const std::vector<double>& x = table.reference;
    if (x.size() < 2 || !(reference >= x.front() && reference <= x.back()))
        throw std::invalid_argument(fmt::format("the default reference {} lies outside of the table of J_mu", reference));
    Range range{x.front(), x.back()};
    for (const std::string& surface : surfaces) {
        const SurfaceTable::Row* const row = table.find(surface);
        if (row == nullptr || row->j_mu.size() != x.size()) {
            std::string known;
            for (const SurfaceTable::Row& r : table.rows) known += (known.empty() ? "" : ", ") + r.surface;
            throw std::invalid_argument(fmt::format("the table of J_mu has no surface '{}'; it has {}", surface, known));
        }
        range = range.within(on_surface(x, *row, floor, reference));
    }
    return range;
}

std::vector<double> references_in(const SurfaceTable& table, const Range& range) {
    std::vector<double> all{range.lowest};
    std::copy_if(table.reference.begin(), table.reference.end(), std::back_inserter(all),
                 [&](double r) { return r > range.lowest && r < range.highest; });
    if (range.highest > range.lowest) all.push_back(range.highest);
    return all;
}

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
