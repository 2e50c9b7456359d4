#include "rig_bridge/wear/order_score.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "rig_bridge/wear/on_threads.hpp"
#include "rig_bridge/wear/standard_scale.hpp"

namespace wear {

namespace {

struct Fold {
    std::vector<Point> fitted, left_out;
};

std::vector<Fold> folds_of(const std::vector<Point>& points) {
    std::vector<Fold> folds(kScoreFolds);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t k = 0; k < kScoreFolds; ++k) (i / kScoreBlock % kScoreFolds == k ? folds[k].left_out : folds[k].fitted).push_back(points[i]);
    return folds;
}

/// log p(mean mu_b | c_e) = log p(c_e, mean mu_b) - log p(c_e).
double conditional_log_density(const Mixture& mixture, const Point& x) {
    double density_of_energy = 0.0;
    for (const Component& c : mixture.components()) {
        const double off_J = x.c_e_J - c.mean_c_e_J;
        density_of_energy += c.weight * std::exp(-0.5 * off_J * off_J / c.variance_c_e_J2) / std::sqrt(2.0 * std::numbers::pi * c.variance_c_e_J2);
    }
    return mixture.log_density(x) - std::log(density_of_energy);
}

/// Sum over what was left out.
double score_of(const Fold& fold, const Mixture& start, const EmSettings& settings) {
    const StandardScale scale = scale_of(fold.fitted);
    const Mixture fitted = in_units(em(standardised(fold.fitted, scale), standardised(start, scale), settings).mixture, scale);
    double sum = 0.0;
    for (const Point& x : fold.left_out) sum += conditional_log_density(fitted, x);
    return sum;
}

}  // namespace

std::vector<double> blocked_scores(const Campaign& campaign, const std::vector<OrderFit>& orders, const EmSettings& settings, unsigned threads) {
    if (campaign.points.size() < kScoreBlock * kScoreFolds) return {};
    const std::vector<Fold> folds = folds_of(campaign.points);
    std::vector<double> sums(orders.size() * kScoreFolds);
    run_jobs(threads, sums.size(),
             [&](std::size_t job) { sums[job] = score_of(folds[job % kScoreFolds], orders[job / kScoreFolds].mixture, settings); });
    std::vector<double> scores(orders.size());
    for (std::size_t job = 0; job < sums.size(); ++job) scores[job / kScoreFolds] += sums[job] / static_cast<double>(campaign.points.size());
    return scores;
}

std::size_t greatest_score(const std::vector<OrderFit>& orders) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < orders.size(); ++i)
        if (orders[i].score && (!best || *orders[i].score > *orders[*best].score)) best = i;
    if (!best) throw std::invalid_argument(fmt::format("no order has a score: it takes {} maneuvers", kScoreBlock * kScoreFolds));
    return *best;
}

}  // namespace wear
