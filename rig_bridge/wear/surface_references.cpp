#include "rig_bridge/wear/surface_references.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>

namespace wear {

namespace {

/// Indices of the lower convex hull of the points (x, y), x rising.
std::vector<std::size_t> lower_hull(const std::vector<double>& x, const std::vector<double>& y) {
    std::vector<std::size_t> hull;
    const auto above_line = [&](std::size_t a, std::size_t middle, std::size_t b) {
        return (y[middle] - y[a]) * (x[b] - x[a]) >= (y[b] - y[a]) * (x[middle] - x[a]);
    };
    for (std::size_t i = 0; i < x.size(); ++i) {
        while (hull.size() >= 2 && above_line(hull[hull.size() - 2], hull.back(), i)) hull.pop_back();
        hull.push_back(i);
    }
    return hull;
}

}  // namespace

SurfaceReferences::SurfaceReferences(const SurfaceTable& table, double floor, double default_reference)
    : table_(table), default_reference_(default_reference) {
    for (const SurfaceTable::Row& row : table_.rows) {
        if (std::adjacent_find(row.tyre_share.begin(), row.tyre_share.end(), std::greater_equal<>()) != row.tyre_share.end())
            throw std::invalid_argument(fmt::format("on {} the tyre's share does not rise with the slip reference", row.surface));
        surfaces_.push_back({.range = allowed(table_, std::array{row.surface}, floor, default_reference),
                             .weight = kPriorLandings / static_cast<double>(table_.rows.size())});
    }
    find_edges();
}

void SurfaceReferences::find_edges() {
    edges_.clear();
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
        Surface& surface = surfaces_[s];
        surface.reference = references_in(table_, surface.range);
        surface.share.clear();
        std::vector<double> distance_m;
        for (const double r : surface.reference) {
            surface.share.push_back(table_.at(table_.rows[s].tyre_share, r));
            distance_m.push_back(table_.at(table_.rows[s].distance_m, r));
        }
        const std::vector<std::size_t> hull = lower_hull(surface.share, distance_m);
        for (std::size_t k = 1; k < hull.size(); ++k) {
            const double share0 = surface.share[hull[k - 1]], share1 = surface.share[hull[k]];
            const double rise_m = distance_m[hull[k]] - distance_m[hull[k - 1]];
            edges_.push_back({rise_m / (share1 - share0), s, share0, share1});
        }
    }
    std::stable_sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.slope_m < b.slope_m; });
}

double SurfaceReferences::all_weights() const {
    return std::accumulate(surfaces_.begin(), surfaces_.end(), 0.0, [](double sum, const Surface& s) { return sum + s.weight; });
}

Range SurfaceReferences::shares() const {
    Range range;
    for (const Surface& s : surfaces_) {
        range.lowest += s.weight * s.share.front() / all_weights();
        range.highest += s.weight * s.share.back() / all_weights();
    }
    return range;
}

double SurfaceReferences::default_share() const {
    double mean = 0.0;
    for (std::size_t s = 0; s < surfaces_.size(); ++s) mean += surfaces_[s].weight * share(s, default_reference_) / all_weights();
    return mean;
}

double SurfaceReferences::reference(std::size_t surface, double mean_share) const {
    double missing = (mean_share - shares().lowest) * all_weights();  // weighted share that edges still have to contribute
    const Surface& here = surfaces_.at(surface);
    double share = here.share.front();
    for (const Edge& edge : edges_) {
        if (missing <= 0.0) break;
        const double taken = std::min(missing / surfaces_[edge.surface].weight, edge.share1 - edge.share0);
        missing -= surfaces_[edge.surface].weight * taken;
        if (edge.surface == surface) share = edge.share0 + taken;
    }
    return std::clamp(on_line(here.share, here.reference, share), here.range.lowest, here.range.highest);
}

double SurfaceReferences::share(std::size_t surface, double reference) const {
    return table_.at(table_.rows.at(surface).tyre_share, reference);
}

void SurfaceReferences::landed(std::size_t surface) {
    surfaces_.at(surface).weight += 1.0;
}

void SurfaceReferences::narrow(std::size_t surface, double reference, double step) {
    Range& range = surfaces_.at(surface).range;
    if (reference > default_reference_)
        range.highest = std::max(default_reference_, std::min(range.highest, reference - step));
    else if (reference < default_reference_)
        range.lowest = std::min(default_reference_, std::max(range.lowest, reference + step));
    find_edges();
}

}  // namespace wear
