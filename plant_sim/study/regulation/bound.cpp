#include "plant_sim/study/regulation/bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace regulation {

namespace {

constexpr std::size_t kShares = 26;  // of the tyre, from 0 in steps of kShareStep
constexpr double kShareStep = 0.02;

/// In the innermost loop: std::lerp is slower, since it handles infinities and exact ends.
double between(const std::vector<double>& values, std::size_t i, double beyond) {
    return values[i] + beyond * (values[i + 1] - values[i]);
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

double Costs::at_limit(const Pair& left) const {
    const auto other = [&](double left_J, double per_J, double planned_J) {
        return std::min(left_J * per_J, visit * std::max(0.0, 1.0 - left_J / planned_J));
    };
    return visit + other(left.brake_J, brake_per_J, planned.brake_J) + other(left.tyre_J, tyre_per_J, planned.tyre_J);
}

Costs costs_of(const wear::Prices& prices, const wear::WearPlan& plan) {
    return {.brake_per_J = prices.brake / plan.brake_life_J,
            .tyre_per_J = prices.tyre / plan.tyre_life_J,
            .visit = prices.visit,
            .metre = prices.metre,
            .planned = {plan.brake_budget_J(), plan.tyre_budget_J()}};
}

Bound::Bound(BoundProblem problem) : problem_(std::move(problem)) {
    const wear::SurfaceTable& table = problem_.table;
    wear::Range common = problem_.allowed.front();
    for (const wear::Range& allowed : problem_.allowed) common = common.within(allowed);
    double max_share = 0.0;
    for (std::size_t s = 0; s < table.rows.size(); ++s) {
        std::vector<Action>& actions = actions_.emplace_back();
        for (const double r : wear::references_in(table, problem_.told ? problem_.allowed.at(s) : common)) {
            actions.push_back(action_of(s, r));
            max_share = std::max(max_share, table.at(table.rows[s].tyre_share, r));
        }
    }
    const double least_J = (1.0 - max_share) * *std::min_element(problem_.landing_J.begin(), problem_.landing_J.end());
    if (max_share > kShareStep * (kShares - 1) || problem_.brake_step_J > least_J)
        throw std::invalid_argument("bound: a landing must take at least half of its energy, and the grid's step, of the brake");
    Pair greatest;
    for (const Pair& begin : problem_.begins) greatest = {std::max(greatest.brake_J, begin.brake_J), std::max(greatest.tyre_J, begin.tyre_J)};
    brake_step_J_ = problem_.brake_step_J > 0.0 ? problem_.brake_step_J : least_J;
    const double tyre_step_J = problem_.tyre_step_J > 0.0 ? problem_.tyre_step_J : greatest.tyre_J / 400.0;
    // The fine grid starts with the cost per landing of the coarse one, which saves half of its iterations.
    constexpr double kCoarse = 8.0;
    for (const double step_J : {kCoarse * tyre_step_J, tyre_step_J}) settle(greatest, step_J);
}

void Bound::settle(const Pair& greatest, double tyre_step_J) {
    tyre_step_J_ = tyre_step_J;
    const auto nodes = [](double whole_J, double step_J) {
        return std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(whole_J / step_J - 1e-9)) + 1);
    };
    brake_nodes_ = nodes(greatest.brake_J, brake_step_J_);
    tyre_nodes_ = nodes(greatest.tyre_J, tyre_step_J_);
    nodes_.assign(brake_nodes_ * tyre_nodes_, {});
    // Each iteration uses the cost per landing of the best policy of the previous one; like Newton's method it converges in a few.
    constexpr int kTurns = 20;
    for (int turn = 0; turn < kTurns; ++turn) {
        sweep();
        double cost = 0.0;
        double landings = 0.0;
        for (const Pair& begin : problem_.begins) {
            const ToCome whole = to_come(begin);
            cost += whole.cost;
            landings += whole.landings;
        }
        per_landing_ += cost / landings;
        landings_ = landings / static_cast<double>(problem_.begins.size());
        if (std::abs(cost / landings) < 1e-9 * std::abs(per_landing_)) return;
    }
    throw std::runtime_error("bound: the cost a landing did not settle");
}

Bound::ToCome Bound::to_come(const Pair& at) const {
    const double x = at.brake_J / brake_step_J_, y = at.tyre_J / tyre_step_J_;
    const std::size_t i = std::min(static_cast<std::size_t>(x), brake_nodes_ - 2), j = std::min(static_cast<std::size_t>(y), tyre_nodes_ - 2);
    const double u = x - static_cast<double>(i), v = y - static_cast<double>(j);
    const ToCome* const low = &nodes_[i * tyre_nodes_ + j];
    const ToCome* const high = low + tyre_nodes_;
    const auto between_nodes = [&](double ToCome::*of) {
        return (1.0 - u) * ((1.0 - v) * low[0].*of + v * low[1].*of) + u * ((1.0 - v) * high[0].*of + v * high[1].*of);
    };
    return {between_nodes(&ToCome::cost), between_nodes(&ToCome::landings)};
}

void Bound::outlook(const Pair& left, Outlook& out) const {
    const Costs& costs = problem_.costs;
    const double each = 1.0 / static_cast<double>(problem_.landing_J.size());
    out.cost.assign(kShares, 0.0);
    out.part.assign(kShares, 0.0);
    out.landings.assign(kShares, 0.0);
    for (std::size_t k = 0; k < kShares; ++k) {
        const double share = kShareStep * static_cast<double>(k);
        for (const double landing_J : problem_.landing_J) {
            const double brake_J = (1.0 - share) * landing_J, tyre_J = share * landing_J;
            const bool whole = brake_J <= left.brake_J && tyre_J <= left.tyre_J;
            const double part = whole ? 1.0 : std::min({1.0, left.brake_J / brake_J, tyre_J > 0.0 ? left.tyre_J / tyre_J : 1.0});
            const Pair after{std::max(0.0, left.brake_J - part * brake_J), std::max(0.0, left.tyre_J - part * tyre_J)};
            const bool over = !whole || after.brake_J == 0.0 || after.tyre_J == 0.0;
            const ToCome then = over ? ToCome{.cost = costs.at_limit(after)} : to_come(after);
            out.cost[k] += each * (part * (costs.brake_per_J * brake_J + costs.tyre_per_J * tyre_J) + then.cost);
            out.part[k] += each * part;
            out.landings[k] += each * then.landings;
        }
    }
}

Bound::Action Bound::action_of(std::size_t surface, double reference) const {
    const wear::SurfaceTable& table = problem_.table;
    const wear::SurfaceTable::Row& row = table.rows.at(surface);
    const double x = table.at(row.tyre_share, reference) / kShareStep;
    const std::size_t step = std::min(static_cast<std::size_t>(x), kShares - 2);
    return {reference, table.at(row.distance_m, reference), step, x - static_cast<double>(step)};
}

double Bound::cost_of(const Outlook& o, const Action& a) const {
    return between(o.cost, a.step, a.beyond) + between(o.part, a.step, a.beyond) * (problem_.costs.metre * a.distance_m - per_landing_);
}

std::size_t Bound::best_of(const Outlook& o, std::size_t surface) const {
    std::size_t best = 0;
    double min = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < actions_[surface].size(); ++a) {
        double cost = 0.0;
        if (problem_.told)
            cost = cost_of(o, actions_[surface][a]);
        else
            for (const std::vector<Action>& there : actions_) cost += cost_of(o, there[a]);
        if (cost < min) {
            min = cost;
            best = a;
        }
    }
    return best;
}

void Bound::sweep() {
    for (std::size_t i = 0; i < brake_nodes_; ++i)
        nodes_[i * tyre_nodes_] = {.cost = problem_.costs.at_limit({static_cast<double>(i) * brake_step_J_, 0.0})};
    for (std::size_t j = 0; j < tyre_nodes_; ++j) nodes_[j] = {.cost = problem_.costs.at_limit({0.0, static_cast<double>(j) * tyre_step_J_})};
    const double each = 1.0 / static_cast<double>(actions_.size());
    Outlook o;
    for (std::size_t i = 1; i < brake_nodes_; ++i) {  // every landing leads to a lower row
        for (std::size_t j = 1; j < tyre_nodes_; ++j) {
            outlook({static_cast<double>(i) * brake_step_J_, static_cast<double>(j) * tyre_step_J_}, o);
            ToCome expected;
            std::size_t best = 0;
            for (std::size_t s = 0; s < actions_.size(); ++s) {
                if (problem_.told || s == 0) best = best_of(o, s);
                const Action& action = actions_[s][best];
                expected.cost += each * cost_of(o, action);
                expected.landings += each * (between(o.part, action.step, action.beyond) + between(o.landings, action.step, action.beyond));
            }
            nodes_[i * tyre_nodes_ + j] = expected;
        }
    }
}

double Bound::loss(const Pair& left, std::size_t surface, double reference) const {
    Outlook o;
    outlook(left, o);
    return cost_of(o, action_of(surface, reference)) - cost_of(o, actions_[surface][best_of(o, surface)]);
}

double Bound::best(const Pair& left, std::size_t surface) const {
    Outlook o;
    outlook(left, o);
    return actions_.at(surface)[best_of(o, surface)].reference;
}

double cost_unshared(const BoundProblem& problem) {
    const Costs& c = problem.costs;
    const double landing_J = mean(problem.landing_J);
    const double brake_per_J = c.brake_per_J + c.visit / c.planned.brake_J;
    const double tyre_per_J = c.tyre_per_J + c.visit / c.planned.tyre_J;
    double cost = 0.0;
    for (std::size_t s = 0; s < problem.table.rows.size(); ++s) {
        const wear::SurfaceTable::Row& row = problem.table.rows[s];
        double min = std::numeric_limits<double>::infinity();
        for (const double r : wear::references_in(problem.table, problem.allowed[s])) {
            const double share = problem.table.at(row.tyre_share, r);
            min = std::min(min, c.metre * problem.table.at(row.distance_m, r) + landing_J * ((1.0 - share) * brake_per_J + share * tyre_per_J));
        }
        cost += min / static_cast<double>(problem.table.rows.size());
    }
    return cost;
}

}  // namespace regulation
