#include "plant_sim/study/regulation/mean_share.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

namespace regulation {

namespace {

Choice tabulated(const wear::SurfaceTable& table, const std::function<double(std::size_t surface)>& reference) {
    Choice choice;
    const auto count = static_cast<double>(table.rows.size());
    choice.tyre_share.reserve(table.rows.size());
    choice.distance_m.reserve(table.rows.size());
    for (std::size_t s = 0; s < table.rows.size(); ++s) {
        const wear::SurfaceTable::Row& row = table.rows[s];
        choice.tyre_share.push_back(table.at(row.tyre_share, reference(s)));
        choice.distance_m.push_back(table.at(row.distance_m, reference(s)));
        choice.mean_share += choice.tyre_share.back() / count;
    }
    return choice;
}

}  // namespace

Choice choice_of(const wear::SurfaceTable& table, double reference) {
    Choice choice = tabulated(table, [&](std::size_t) { return reference; });
    choice.reference = reference;
    return choice;
}

Choices::Choices(const wear::SurfaceTable& table, double floor, double default_reference) {
    const wear::SurfaceReferences references(table, floor, default_reference);
    const wear::Range shares = references.shares();
    const auto steps = static_cast<std::size_t>((shares.highest - shares.lowest) / kStep);
    choices_.reserve(steps + 1);
    for (std::size_t k = 0; k <= steps; ++k) {
        const double share = shares.lowest + kStep * static_cast<double>(k);
        choices_.push_back(tabulated(table, [&](std::size_t surface) { return references.reference(surface, share); }));
    }
}

const Choice& Choices::at(double mean_share) const {
    const double step = std::round((mean_share - choices_.front().mean_share) / kStep);
    return choices_[static_cast<std::size_t>(std::clamp(step, 0.0, static_cast<double>(choices_.size() - 1)))];
}

}  // namespace regulation
