/// When aircraft go to a workshop with a limited number of bays, each visit equally long. Times are days from now. Pure.
#pragma once

#include <span>
#include <vector>

namespace regulation {

struct Shop {
    int bays = 1;        ///< aircraft that it takes at the same time, above 0
    int visit_days = 1;  ///< from the morning in which a bay is taken to that in which it is free again, above 0

    /// Latest days at which visits can begin so that each begins by its day of `due`, which must ascend. A day before now: it is too late.
    [[nodiscard]] std::vector<double> latest_starts(std::span<const double> due) const;
    /// Days at which visits begin if none begins before its day of `due`, which must ascend. `busy`: days until which bays are taken, for those that
    /// are.
    [[nodiscard]] std::vector<double> first_come(std::span<const double> due, std::span<const double> busy) const;
};

}  // namespace regulation
