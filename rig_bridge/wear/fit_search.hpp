/// The best mixture of each order: EM from many starts; runs that fall behind are dropped early. Internal to fit.
#pragma once

#include <vector>

#include "rig_bridge/wear/em.hpp"
#include "rig_bridge/wear/fit.hpp"

namespace wear {

struct OrderSearch {
    struct Local {
        EmRun run;
        bool split_up = false;     ///< has given starts to the next greater order
        bool merged_down = false;  ///< has given starts to the next smaller order
    };
    std::vector<Local> best;  ///< distinct maxima, the largest first; at least one
    int runs = 0;             ///< starts
    int not_converged = 0;    ///< of the runs that were not dropped
};

/// For each M, ascending: random starts first; then, going up and down the orders, starts from the best for M - 1 with one component split, and the
/// best for M + 1 with two merged, which find maxima that random starts seldom reach for large M.
[[nodiscard]] std::vector<OrderSearch> search_orders(const StandardPoints& points, const FitSettings& settings, const FitControl& control);

}  // namespace wear
