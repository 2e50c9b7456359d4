/// The best mixture of each order: EM from many starts, of which those that fall behind are dropped on the way. Inside fit.
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
    std::vector<Local> best;  ///< different maxima, the greatest first; at least one
    int runs = 0;             ///< starts
    int not_converged = 0;    ///< of those that were carried to the end
};

/// For each M, ascending: random starts first. Then, up and down the orders, what is best for M - 1 with one component split, and what is best
/// for M + 1 with two of them merged: maxima that random starts seldom find when M is large.
[[nodiscard]] std::vector<OrderSearch> search_orders(const StandardPoints& points, const FitSettings& settings, const FitControl& control);

}  // namespace wear
