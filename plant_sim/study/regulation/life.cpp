#include "plant_sim/study/regulation/life.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "rig_bridge/wear/draw.hpp"

namespace regulation {

namespace {

std::size_t below(wear::Generator& generator, std::size_t n) {
    return std::min(n - 1, static_cast<std::size_t>(wear::uniform(generator) * static_cast<double>(n)));
}

/// Landing at which a cumulative quantity reaches `limit`, linear within it; infinity: never.
double reached(const std::vector<LifeRow>& rows, double LifeRow::*used, double limit) {
    double before = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const double now = rows[i].*used;
        if (now >= limit) return static_cast<double>(i) + (limit - before) / (now - before);
        before = now;
    }
    return std::numeric_limits<double>::infinity();
}

double used_at(const std::vector<LifeRow>& rows, double LifeRow::*used, double landing) {
    const double whole = std::floor(landing);
    const auto i = static_cast<std::size_t>(whole);
    const double before = i == 0 ? 0.0 : rows[std::min(i, rows.size()) - 1].*used;
    if (i >= rows.size()) return before;
    return before + (landing - whole) * (rows[i].*used - before);
}

/// Sums up to the first limit, with the part of its landing before that.
void count(const Costs& costs, Life& life) {
    const std::vector<LifeRow>& rows = life.rows;
    for (std::size_t i = 0; i < rows.size() && static_cast<double>(i) < life.first_landing; ++i) {
        life.cost += std::min(1.0, life.first_landing - static_cast<double>(i)) * costs.metre * rows[i].distance_m;
        life.loss += rows[i].loss;
    }
    const double brake_J = used_at(rows, &LifeRow::brake_J, life.first_landing), tyre_J = used_at(rows, &LifeRow::tyre_J, life.first_landing);
    life.cost += costs.brake_per_J * brake_J + costs.tyre_per_J * tyre_J +
                 costs.at_limit({std::max(0.0, life.brake_budget_J - brake_J), std::max(0.0, life.tyre_budget_J - tyre_J)});
}

void judge(const wear::WearPlan& plan, const wear::Range& range, Life& life) {
    const std::vector<LifeRow>& rows = life.rows;
    const auto planned = static_cast<double>(plan.landings);
    const double brake_J = used_at(rows, &LifeRow::brake_J, planned);
    const double tyre_J = used_at(rows, &LifeRow::tyre_J, planned);
    const double budget_J = life.brake_budget_J + life.tyre_budget_J;
    life.brake_at_plan = brake_J / life.brake_budget_J;
    life.tyre_at_plan = tyre_J / life.tyre_budget_J;
    life.brought = (brake_J + tyre_J) / budget_J;
    const double brake_landing = reached(rows, &LifeRow::brake_J, life.brake_budget_J);
    const double tyre_landing = reached(rows, &LifeRow::tyre_J, life.tyre_budget_J);
    life.first = brake_landing <= tyre_landing ? First::brake : First::tyre;
    life.first_landing = std::min({brake_landing, tyre_landing, static_cast<double>(rows.size())});
    life.other_left = life.first == First::brake ? 1.0 - used_at(rows, &LifeRow::tyre_J, life.first_landing) / life.tyre_budget_J
                                                 : 1.0 - used_at(rows, &LifeRow::brake_J, life.first_landing) / life.brake_budget_J;
    // Tyre share over reference in this life, to estimate the result of the range's ends.
    double slip = 0.0;
    double share = 0.0;
    for (const LifeRow& row : rows) {
        slip += row.reference;
        share += row.share;
    }
    const double share_per_slip = share / slip;
    const double wanted = life.tyre_budget_J / budget_J;
    life.feasible =
        std::abs(life.brought - 1.0) <= plan.tolerance && wanted >= share_per_slip * range.lowest && wanted <= share_per_slip * range.highest;
    life.met = std::abs(life.brake_at_plan - 1.0) <= plan.tolerance && std::abs(life.tyre_at_plan - 1.0) <= plan.tolerance;
    life.floor_held = std::all_of(rows.begin(), rows.end(), [](const LifeRow& row) {
        return row.new_surface || row.worst_distance_m <= 0.0 || row.distance_m <= row.worst_distance_m * (1.0 + kDistanceNoise);
    });
}

/// For a policy that knows the surface the regulator sets mean shares instead of references.
wear::Regulator regulator_of(const wear::WearPlan& plan, wear::Rules rules, const wear::Range& range, const LifeOptions& options) {
    if (options.policy.every > 1) rules.step = 0.5;  // when set by hand, steps are not small
    if (!options.policy.told) return {plan, rules, range};
    rules.default_reference = options.references->default_share();
    return {plan, rules, options.references->shares()};
}

}  // namespace

std::vector<Draw> draw_life(std::uint64_t seed, std::uint64_t life, std::size_t count, std::size_t planned, std::size_t scenarios, Mix mix,
                            double missing) {
    wear::Generator generator = wear::generator_of(seed, life);
    std::vector<Draw> draws(count);
    std::vector<std::size_t> deck;
    for (Draw& draw : draws) {
        if (mix == Mix::random) {
            draw.scenario = below(generator, scenarios);
        } else {
            if (deck.empty()) {
                deck.reserve(planned);
                for (std::size_t i = 0; i < planned; ++i) deck.push_back(i % scenarios);
                for (std::size_t i = deck.size(); i > 1; --i) std::swap(deck[i - 1], deck[below(generator, i)]);
            }
            draw.scenario = deck.back();
            deck.pop_back();
        }
        draw.sensor_seed = generator() >> 1U;
        draw.measured = wear::uniform(generator) >= missing;
    }
    return draws;
}

UnfinishedLife::UnfinishedLife(const wear::WearPlan& plan, const wear::Rules& rules, const wear::Range& range, std::vector<Draw> draws,
                               const LifeOptions& options)
    : range_(range),
      draws_(std::move(draws)),
      options_(options),
      regulator_(regulator_of(plan, rules, range, options)),
      brake_readings_(plan.brake_life_J, options.inspection.brake_spread, options.inspection.error),
      tyre_readings_(plan.tyre_life_J, options.inspection.tyre_spread, options.inspection.error),
      held_(regulator_.reference()),
      brake_(options.brake, options.rule, {.seed = options.brake_seed, .maneuvers = 0, .c_e_J = plan.brake_taken_J}) {
    life_.brake_budget_J = options.brake.life_J - plan.brake_taken_J;
    life_.tyre_budget_J = options.tyre_life_J - plan.tyre_taken_J;
    life_.rows.reserve(draws_.size());
    if (inspected()) inspect();
}

bool UnfinishedLife::over() const {
    const std::size_t landings = life_.rows.size();
    if (landings == draws_.size()) return true;
    const bool used_up = brake_J_ >= life_.brake_budget_J || tyre_J_ >= life_.tyre_budget_J;
    return used_up && landings >= static_cast<std::size_t>(regulator_.plan().landings);
}

Pair UnfinishedLife::left() const {
    return {life_.brake_budget_J - brake_J_, life_.tyre_budget_J - tyre_J_};
}

double UnfinishedLife::next_reference() const {
    const Policy& policy = options_.policy;
    if (policy.fixed) return *policy.fixed;
    if (!policy.told && !policy.bound) return std::clamp(held_, range_.lowest, range_.highest);
    const std::size_t surface = options_.surface_of[draws_[life_.rows.size()].scenario];
    return policy.bound ? options_.bound->best(left(), surface) : options_.references->reference(surface, held_);
}

std::vector<LandingRequest> UnfinishedLife::requests() const {
    const double friction = brake_.next_friction();
    const Draw& draw = draws_[life_.rows.size()];
    std::vector<LandingRequest> requests{
        {.draw = draw, .reference = next_reference(), .mean_friction = friction, .metered = regulated() && draw.measured}};
    if (options_.worst_stops) {
        const wear::Range& range = regulator_.range();
        for (const double end : {range.lowest, range.highest})
            requests.push_back({.draw = draw, .reference = end, .mean_friction = friction, .metered = false});
    }
    return requests;
}

void UnfinishedLife::landed(std::span<const Stop> stops) {
    const Draw& draw = draws_[life_.rows.size()];
    const Stop& stop = stops.front();
    LifeRow row;
    row.reference = next_reference();
    if (regulated()) {
        row.required_share = regulator_.required_share();
        row.brake_life_J = regulator_.plan().brake_life_J;
    }
    if (const Pair before = left(); options_.bound != nullptr && before.brake_J > 0.0 && before.tyre_J > 0.0)
        row.loss = options_.bound->loss(before, options_.surface_of[draw.scenario], row.reference);
    for (const Stop& worst : stops.subspan(1)) row.worst_distance_m = std::max(row.worst_distance_m, worst.distance_m);
    // Up to the planned landing the brake stays as it is at its limit: beyond it a lining's law soon leaves nothing.
    brake_.take(std::clamp(options_.brake.life_J - brake_.state().c_e_J, 0.0, stop.brake_J));
    brake_J_ += stop.brake_J;
    tyre_J_ += stop.tyre_J;
    if (regulated()) {
        regulate(draw, stop, row.reference);
        row.reading = regulator_.last_reading();
    }
    if (!options_.allowed_on.empty()) {
        const wear::Range& here = options_.allowed_on[draw.scenario];
        row.new_surface = range_.lowest < here.lowest || range_.highest > here.highest;
        range_ = range_.within(here);
        if (!options_.policy.told) regulator_.narrow(here);
    }
    row.share = stop.tyre_J / (stop.tyre_J + stop.brake_J);
    row.brake_J = brake_J_;
    row.tyre_J = tyre_J_;
    row.distance_m = stop.distance_m;
    row.j_mu = stop.j_mu;
    life_.rows.push_back(row);
    if (life_.rows.size() % static_cast<std::size_t>(options_.policy.every) == 0) held_ = regulator_.reference();
}

/// Reads the wear of both parts, each with its error.
void UnfinishedLife::inspect() {
    constexpr std::uint64_t kStream = 1U << 21U;
    wear::Generator generator = wear::generator_of(options_.brake_seed, kStream + life_.rows.size());
    const auto seen = [&](double taken_J, double life_J) { return taken_J / life_J + options_.inspection.error * wear::normal(generator); };
    const wear::WearPlan& plan = regulator_.plan();
    brake_readings_.read(regulator_.brake_used_J(), seen(plan.brake_taken_J + brake_J_, options_.brake.life_J));
    tyre_readings_.read(regulator_.tyre_used_J(), seen(plan.tyre_taken_J + tyre_J_, options_.tyre_life_J));
    regulator_.revise_brake_life(brake_readings_.life_J());
    regulator_.revise_tyre_life(tyre_readings_.life_J());
}

/// Passes the measured values of a landing to the regulator.
void UnfinishedLife::regulate(const Draw& draw, const Stop& stop, double reference) {
    const Policy& policy = options_.policy;
    wear::Landing measured;
    if (draw.measured) {
        measured = stop.measured;
        measured.reference = policy.told ? held_ : reference;
        if (policy.told) {
            const std::size_t surface = options_.surface_of[draw.scenario];
            measured.expected_share = options_.references->share(surface, reference);
            measured.j_mu = wear::kUnknown;  // a shortfall limits this surface's references, not the mean share
            if (stop.measured.j_mu < regulator_.rules().j_mu_floor) options_.references->narrow(surface, reference, regulator_.rules().step);
            options_.references->landed(surface);
        }
    }
    regulator_.after(measured);
    if (policy.forecast && draw.measured) {
        options_.life_forecast->learn(regulator_.brake_used_J(), stop.measured_friction);
        constexpr int kEvery = 8;  // landings: a forecast costs as much as a short stop
        if (regulator_.landings() % kEvery == 0) {
            if (const auto life_J = options_.life_forecast->life_J()) regulator_.revise_brake_life(*life_J);
        }
    }
    if (inspected() && regulator_.landings() % options_.inspection.landings == 0) inspect();
}

Life UnfinishedLife::life() const {
    Life life = life_;
    judge(regulator_.plan(), range_, life);
    count(options_.costs, life);
    return life;
}

}  // namespace regulation
