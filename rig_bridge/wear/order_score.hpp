/// Cross-validated score of mixtures of each order, besides BIC, which assumes independent maneuvers and therefore counts correlated scatter as
/// structure.
#pragma once

#include <vector>

#include "rig_bridge/wear/fit.hpp"

namespace wear {

/// Maneuvers per block: longer than the correlation of scatter. Every tenth block is left out at a time, so that gaps are short compared with a life.
inline constexpr std::size_t kScoreBlock = 10;
inline constexpr std::size_t kScoreFolds = 10;

/// For each of `orders` the mean of log p(mean mu_b | c_e), exact eq. (14), of maneuvers in blocks that were left out of the fit, which is EM from
/// the mixture of all. Greater is better. The same bytes on any number of threads. `campaign` is what the orders were fitted to, with at least
/// kScoreBlock kScoreFolds maneuvers, else nothing is scored and the answer empty.
[[nodiscard]] std::vector<double> blocked_scores(const Campaign& campaign, const std::vector<OrderFit>& orders, const EmSettings& settings,
                                                 unsigned threads = 1);

/// Index of the greatest score; throws std::invalid_argument where nothing was scored.
[[nodiscard]] std::size_t greatest_score(const std::vector<OrderFit>& orders);

}  // namespace wear
