#include "plant_sim/study/regulation/life.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
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
    // The share that a reference gave in this very life, for what its ends could have done.
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

LivingPair::LivingPair(const wear::WearPlan& plan, const wear::Rules& rules, const wear::Range& range, std::vector<Draw> draws,
                       const LifeOptions& options)
    : range_(range),
      draws_(std::move(draws)),
      options_(options),
      regulator_(plan, rules, range),
      life_forecast_(options.life_forecast),
      brake_(options.brake, options.rule, {.seed = options.brake_seed, .maneuvers = 0, .c_e_J = plan.brake_taken_J}) {
    life_.brake_budget_J = options.brake.life_J - plan.brake_taken_J;
    life_.tyre_budget_J = plan.tyre_budget_J();
    life_.rows.reserve(draws_.size());
}

bool LivingPair::over() const {
    const std::size_t landings = life_.rows.size();
    if (landings == draws_.size()) return true;
    const bool used_up = brake_J_ >= life_.brake_budget_J || tyre_J_ >= life_.tyre_budget_J;
    return used_up && landings >= static_cast<std::size_t>(regulator_.plan().landings);
}

std::vector<LandingRequest> LivingPair::requests() const {
    const double friction = brake_.next_friction();
    const Draw& draw = draws_[life_.rows.size()];
    std::vector<LandingRequest> requests{{.draw = draw,
                                          .reference = options_.fixed.value_or(regulator_.reference()),
                                          .mean_friction = friction,
                                          .metered = !options_.fixed && draw.measured}};
    if (options_.worst_stops) {
        const wear::Range& range = regulator_.range();
        for (const double end : {range.lowest, range.highest})
            requests.push_back({.draw = draw, .reference = end, .mean_friction = friction, .metered = false});
    }
    return requests;
}

void LivingPair::landed(std::span<const Stop> stops) {
    const Draw& draw = draws_[life_.rows.size()];
    const Stop& stop = stops.front();
    LifeRow row;
    row.reference = options_.fixed.value_or(regulator_.reference());
    if (!options_.fixed) {
        row.required_share = regulator_.required_share();
        row.brake_life_J = regulator_.plan().brake_life_J;
    }
    for (const Stop& worst : stops.subspan(1)) row.worst_distance_m = std::max(row.worst_distance_m, worst.distance_m);
    brake_.take(stop.brake_J);
    brake_J_ += stop.brake_J;
    tyre_J_ += stop.tyre_J;
    if (!options_.fixed) {
        regulate(draw, stop);
        row.reading = regulator_.last_reading();
    }
    if (!options_.allowed_on.empty()) {
        const wear::Range& here = options_.allowed_on[draw.scenario];
        row.new_surface = range_.lowest < here.lowest || range_.highest > here.highest;
        range_ = {std::max(range_.lowest, here.lowest), std::min(range_.highest, here.highest)};
        regulator_.narrow(here);
    }
    row.share = stop.tyre_J / (stop.tyre_J + stop.brake_J);
    row.brake_J = brake_J_;
    row.tyre_J = tyre_J_;
    row.distance_m = stop.distance_m;
    row.j_mu = stop.j_mu;
    life_.rows.push_back(row);
}

/// What is known of a landing goes to the regulator.
void LivingPair::regulate(const Draw& draw, const Stop& stop) {
    wear::Landing measured;
    if (draw.measured) {
        measured = stop.measured;
        measured.reference = regulator_.reference();
    }
    const bool inspected = options_.inspection > 0 && (regulator_.landings() + 1) % options_.inspection == 0;
    if (inspected) measured.brake_wear_J = brake_.state().c_e_J;
    regulator_.after(measured);
    if (life_forecast_ && draw.measured && options_.inspection == 0) {
        life_forecast_->learn(regulator_.brake_used_J(), stop.measured_friction);
        constexpr int kEvery = 8;  // landings: a forecast costs as much as a short stop
        if (regulator_.landings() % kEvery == 0) {
            if (const auto life_J = life_forecast_->life_J()) regulator_.revise_brake_life(*life_J);
        }
    }
    if (inspected) regulator_.revise_brake_life(options_.brake.life_J);
}

Life LivingPair::life() const {
    Life life = life_;
    judge(regulator_.plan(), range_, life);
    return life;
}

}  // namespace regulation
