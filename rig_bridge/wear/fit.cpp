#include "rig_bridge/wear/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "rig_bridge/wear/draw.hpp"
#include "rig_bridge/wear/em.hpp"
#include "rig_bridge/wear/fit_starts.hpp"
#include "rig_bridge/wear/on_threads.hpp"
#include "rig_bridge/wear/standard_scale.hpp"

namespace wear {

namespace {

/// The best mixture of one order.
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

// Chosen on the arena's laws with lives of 1,000 landings (seeds 1 and 700000), a known mixture and draws from the shipped model (seed 1).
constexpr int kShort = 12;               // EM steps after which the less likely runs of an order are dropped
constexpr std::size_t kAfterShort = 20;  // number of runs that continue
constexpr int kLong = 60;
constexpr std::size_t kToTheEnd = 6;  // number of runs continued to convergence, and of maxima kept
constexpr std::size_t kMerges = 10;   // number of pairs, those whose merger loses least
constexpr int kSweeps = 4;            // down and up again

using Runs = std::vector<EmRun>;  // of one order

void keep_best(Runs& runs, std::size_t count) {
    std::stable_sort(runs.begin(), runs.end(), [](const EmRun& a, const EmRun& b) { return a.log_likelihood > b.log_likelihood; });
    if (runs.size() > count) runs.resize(count);
}

void take(OrderSearch& order, const EmRun& run) {
    constexpr double kSame = 1e-3;  // maxima closer than this count as one
    const auto same = [&](const OrderSearch::Local& l) { return std::abs(l.run.log_likelihood - run.log_likelihood) < kSame; };
    if (const auto known = std::find_if(order.best.begin(), order.best.end(), same); known != order.best.end()) {
        if (run.log_likelihood > known->run.log_likelihood) known->run = run;
    } else {
        order.best.push_back({run});
    }
    std::stable_sort(order.best.begin(), order.best.end(), [](const auto& a, const auto& b) { return a.run.log_likelihood > b.run.log_likelihood; });
    if (order.best.size() > kToTheEnd) order.best.resize(kToTheEnd);
}

/// EM from many starts for each order; runs that fall behind are dropped early. Random starts come first; then, going up and down the orders, starts
/// from the best of the order below with one component split, and of the order above with two merged, which find maxima that random starts seldom
/// reach for high orders.
class Search {
  public:
    Search(const StandardPoints& points, const FitSettings& settings, const FitControl& control)
        : points_(points),
          settings_(settings),
          control_(control),
          starts_(static_cast<std::size_t>(settings.starts)),
          // One order more than requested, if there are enough data.
          orders_(std::min(settings.max_components + 1, std::max(settings.max_components, points.size() / 6)) - settings.min_components + 1),
          steps_(orders_.size() * starts_ + (1 + 2 * kSweeps) * (orders_.size() - 1)) {}

    /// Orders ascending.
    std::vector<OrderSearch> run() {
        from_random();
        up();
        for (int sweep = 0; sweep < kSweeps; ++sweep) {
            down();
            up();
        }
        orders_.resize(settings_.max_components - settings_.min_components + 1);
        return std::move(orders_);
    }

  private:
    void each(std::size_t count, const std::function<void(std::size_t)>& job) const {
        run_jobs(control_.threads, count, [&](std::size_t i) {
            if (control_.stop.stop_requested()) throw Cancelled();
            job(i);
        });
    }

    void step_done() {
        const std::scoped_lock lock(mutex_);
        ++done_;
        if (control_.progress) control_.progress(done_, steps_);
    }

    [[nodiscard]] EmRun run_from(const StandardMixture& start, int steps) const {
        EmSettings s = settings_.em;
        s.max_iterations = std::min(steps, s.max_iterations);
        return em(points_, start, s);
    }

    void carry_on(std::vector<Runs>& of_orders, int steps) const {
        std::vector<EmRun*> all;
        for (Runs& runs : of_orders)
            for (EmRun& run : runs)
                if (!run.converged) all.push_back(&run);
        each(all.size(), [&](std::size_t i) { *all[i] = run_from(all[i]->mixture, steps); });
    }

    /// `of_orders`: short runs of the orders from number `first` on.
    void settle(std::vector<Runs>& of_orders, std::size_t first) {
        for (std::size_t i = 0; i < of_orders.size(); ++i) {
            orders_[first + i].runs += static_cast<int>(of_orders[i].size());
            keep_best(of_orders[i], kAfterShort);
        }
        carry_on(of_orders, kLong);
        for (Runs& runs : of_orders) keep_best(runs, kToTheEnd);
        carry_on(of_orders, settings_.em.max_iterations);
        for (std::size_t i = 0; i < of_orders.size(); ++i) {
            for (const EmRun& run : of_orders[i]) {
                if (!run.converged) ++orders_[first + i].not_converged;
                take(orders_[first + i], run);
            }
        }
    }

    void settle(const std::vector<StandardMixture>& starts, std::size_t order) {
        std::vector<Runs> one(1, Runs(starts.size()));
        each(starts.size(), [&](std::size_t i) { one[0][i] = run_from(starts[i], kShort); });
        settle(one, order);
        step_done();
    }

    void from_random() {
        std::vector<Runs> runs(orders_.size(), Runs(starts_));
        each(orders_.size() * starts_, [&](std::size_t job) {
            const std::size_t order = orders_.size() - 1 - job / starts_;  // high orders first, so that threads end at the same time
            const std::size_t start = job % starts_;
            const std::size_t m = settings_.min_components + order;
            constexpr int kLloyd = 10;
            Generator generator = generator_of(settings_.seed, m * 1'000'000'000U + start);
            runs[order][start] = run_from(random_start(points_, m, start % 2 == 0 ? kLloyd : 0, settings_.em.covariance_floor, generator), kShort);
            step_done();
        });
        settle(runs, 0);
    }

    void up() {
        for (std::size_t order = 1; order < orders_.size(); ++order) {
            std::vector<StandardMixture> starts;
            for (OrderSearch::Local& smaller : orders_[order - 1].best) {
                if (std::exchange(smaller.split_up, true)) continue;
                for (std::size_t i = 0; i < 2 * smaller.run.mixture.components; ++i) starts.push_back(split(smaller.run.mixture, i / 2, i % 2 == 0));
            }
            settle(starts, order);
        }
    }

    void down() {
        for (std::size_t order = orders_.size() - 1; order-- > 0;) {
            std::vector<StandardMixture> starts;
            for (OrderSearch::Local& greater : orders_[order + 1].best) {
                if (std::exchange(greater.merged_down, true)) continue;
                for (const EmRun& pair : merges_of(greater.run.mixture)) starts.push_back(pair.mixture);
            }
            settle(starts, order);
        }
    }

    [[nodiscard]] Runs merges_of(const StandardMixture& mixture) const {
        Runs pairs;
        for (std::size_t a = 0; a < mixture.components; ++a) {
            for (std::size_t b = a + 1; b < mixture.components; ++b) {
                pairs.emplace_back();
                pairs.back().mixture = merged(mixture, a, b);
            }
        }
        each(pairs.size(), [&](std::size_t i) { pairs[i].log_likelihood = log_likelihood(points_, pairs[i].mixture); });
        keep_best(pairs, kMerges);
        return pairs;
    }

    const StandardPoints& points_;
    const FitSettings& settings_;
    const FitControl& control_;
    std::size_t starts_;
    std::vector<OrderSearch> orders_;
    std::size_t steps_;
    std::size_t done_ = 0;
    std::mutex mutex_;
};

void check(const Campaign& campaign, const FitSettings& settings, const FitControl& control) {
    if (settings.min_components < 1 || settings.max_components > kMaxComponents || settings.min_components > settings.max_components)
        throw std::invalid_argument(
            fmt::format("components: {} to {} is no part of 1 to {}", settings.min_components, settings.max_components, kMaxComponents));
    if (settings.starts < 1) throw std::invalid_argument("starts: at least 1");
    if (!(settings.em.tolerance > 0.0) || !(settings.em.covariance_floor > 0.0) || settings.em.max_iterations < 1)
        throw std::invalid_argument("tolerance, covariance floor and iterations must be positive");
    if (control.threads < 1) throw std::invalid_argument("threads: at least 1");
    wear::check(campaign);
    const std::size_t points = campaign.points.size();
    if (points < 6 * settings.max_components)
        throw settings::Error(campaign.source, 0, "",
                              fmt::format("{} maneuvers are too few for {} components, which have {} "
                                          "parameters; at most {} can be learnt",
                                          points, settings.max_components, parameters_of(settings.max_components), points / 6));
}

}  // namespace

Fit fit(const Campaign& campaign, const FitSettings& settings, const FitControl& control) {
    check(campaign, settings, control);
    const StandardScale scale = scale_of(campaign.points);
    const StandardPoints points = standardised(campaign.points, scale);
    const std::vector<OrderSearch> found = Search(points, settings, control).run();

    Fit out;
    out.orders.reserve(found.size());
    const double per_point = std::log(scale.c_deviation_J * scale.mu_deviation);
    const auto n = campaign.points.size();
    for (std::size_t i = 0; i < found.size(); ++i) {
        const OrderSearch& s = found[i];
        const EmRun& best = s.best.front().run;
        const std::size_t m = best.mixture.components;
        const double log_likelihood = best.log_likelihood - static_cast<double>(n) * per_point;
        out.orders.push_back({m, log_likelihood, bic(log_likelihood, m, n), s.runs, s.not_converged, in_units(best.mixture, scale), {}});
        if (out.orders.back().bic < out.orders[out.chosen].bic) out.chosen = i;
    }
    return out;
}

}  // namespace wear
