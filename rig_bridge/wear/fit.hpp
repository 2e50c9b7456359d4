/// Fits the mixture of eq. (10) to a campaign: for each number of components M, EM from many starts, keeping the best; then chooses the M with the
/// lowest BIC.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <vector>

#include "rig_bridge/wear/em.hpp"
#include "rig_bridge/wear/mixture.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace wear {

struct FitSettings {
    std::size_t min_components = 1;
    std::size_t max_components = 15;  ///< at most kMaxComponents
    int starts = 100;                 ///< random ones for each M
    std::uint64_t seed = 1;
    EmSettings em;
};

/// Result of the search for one M.
struct OrderFit {
    std::size_t components = 0;
    double log_likelihood = 0.0;  ///< eq. (13) of the points in SI units, the best of all runs
    double bic = 0.0;
    int runs = 0;           ///< random starts, and those from the best of M - 1 and M + 1
    int not_converged = 0;  ///< of these, not dropped but stopped by EmSettings::max_iterations
    Mixture mixture;
    std::optional<double> score{};  ///< order_score.hpp; none: not scored
};

struct Fit {
    std::vector<OrderFit> orders;  ///< M ascending
    std::size_t chosen = 0;        ///< index of the least BIC
    [[nodiscard]] const OrderFit& best() const { return orders[chosen]; }
};

class Cancelled : public std::runtime_error {
  public:
    Cancelled() : std::runtime_error("cancelled") {}
};

struct FitControl {
    unsigned threads = 1;  ///< at least 1; the result does not depend on it
    std::stop_token stop;  ///< checked before each run; fit() then throws Cancelled
    /// Called with the steps done and in total, from any thread, never concurrently.
    std::function<void(std::size_t done, std::size_t all)> progress;
};

/// Data are standardised (each coordinate to mean 0, standard deviation 1) before EM. Throws settings::Error as check(), and if there are fewer than
/// 6 points per component (a component has 6 parameters); std::invalid_argument for settings out of range.
[[nodiscard]] Fit fit(const Campaign& campaign, const FitSettings& settings, const FitControl& control = {});

}  // namespace wear
