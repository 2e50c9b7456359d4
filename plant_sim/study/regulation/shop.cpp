#include "plant_sim/study/regulation/shop.hpp"

#include <algorithm>
#include <cstddef>

namespace regulation {

std::vector<double> Shop::latest_starts(std::span<const double> due) const {
    std::vector<double> start(due.begin(), due.end());
    const auto together = static_cast<std::size_t>(bays);
    // With visits of equal length, the bay of visit i is the one that visit i + bays takes next.
    for (std::size_t i = start.size(); i-- > 0;)
        if (i + together < start.size()) start[i] = std::min(start[i], start[i + together] - visit_days);
    return start;
}

std::vector<double> Shop::first_come(std::span<const double> due, std::span<const double> busy) const {
    std::vector<double> free(static_cast<std::size_t>(bays), 0.0);
    std::copy(busy.begin(), busy.end(), free.begin());
    std::vector<double> start(due.begin(), due.end());
    for (double& day : start) {
        double& bay = *std::min_element(free.begin(), free.end());
        day = std::max(day, bay);
        bay = day + visit_days;
    }
    return start;
}

}  // namespace regulation
