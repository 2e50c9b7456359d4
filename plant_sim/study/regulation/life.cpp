#include "plant_sim/study/regulation/life.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "plant_sim/wear/draw.hpp"

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

void judge(const Plan& plan, const Range& range, Life& life) {
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
    life.other_left = life.first == First::brake
                          ? 1.0 - used_at(rows, &LifeRow::tyre_J, life.first_landing) / life.tyre_budget_J
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
    life.feasible = std::abs(life.brought - 1.0) <= plan.tolerance &&
                    wanted >= share_per_slip * range.lowest && wanted <= share_per_slip * range.highest;
    life.met = std::abs(life.brake_at_plan - 1.0) <= plan.tolerance &&
               std::abs(life.tyre_at_plan - 1.0) <= plan.tolerance;
    life.floor_held = std::all_of(rows.begin(), rows.end(), [](const LifeRow& row) {
        return row.worst_distance_m <= 0.0 || row.distance_m <= row.worst_distance_m * (1.0 + kDistanceNoise);
    });
}

}  // namespace

std::vector<Draw> draw_life(std::uint64_t seed, std::uint64_t life, std::size_t count, std::size_t planned,
                            std::size_t scenarios, Mix mix, double missing) {
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
                for (std::size_t i = deck.size(); i > 1; --i)
                    std::swap(deck[i - 1], deck[below(generator, i)]);
            }
            draw.scenario = deck.back();
            deck.pop_back();
        }
        draw.sensor_seed = generator() >> 1U;
        draw.measured = wear::uniform(generator) >= missing;
    }
    return draws;
}

Life live(const Plan& plan, const Rules& rules, const Range& range, const std::vector<Draw>& draws,
          const LifeOptions& options, const Lander& land) {
    Regulator regulator(plan, rules, range);
    wear::WearingBrake brake(options.brake, options.rule,
                             {.seed = options.brake_seed, .maneuvers = 0, .c_e_J = plan.brake_taken_J});
    Life life;
    life.brake_budget_J = options.brake.life_J - plan.brake_taken_J;
    life.tyre_budget_J = plan.tyre_budget_J();
    life.rows.reserve(draws.size());
    double brake_J = 0.0;
    double tyre_J = 0.0;
    for (const Draw& draw : draws) {
        const bool over = brake_J >= life.brake_budget_J || tyre_J >= life.tyre_budget_J;
        if (over && life.rows.size() >= static_cast<std::size_t>(plan.landings)) break;
        LifeRow row;
        row.reference = options.fixed.value_or(regulator.reference());
        row.required_share = options.fixed ? 0.0 : regulator.required_share();
        const double friction = brake.next_friction();
        const Stop stop = land(draw, row.reference, friction);
        if (options.worst_stops)
            row.worst_distance_m = std::max(land(draw, regulator.range().lowest, friction).distance_m,
                                            land(draw, regulator.range().highest, friction).distance_m);
        brake.take(stop.brake_J);
        brake_J += stop.brake_J;
        tyre_J += stop.tyre_J;
        if (!options.fixed) {
            Landing measured;
            if (draw.measured) {
                measured = stop.measured;
                measured.reference = row.reference;
            }
            const bool inspected =
                options.inspection > 0 && (regulator.landings() + 1) % options.inspection == 0;
            if (inspected) measured.brake_wear_J = brake.state().c_e_J;
            row.reading = regulator.after(measured);
            if (inspected) regulator.revise_brake_life(options.brake.life_J);
        }
        row.share = stop.tyre_J / (stop.tyre_J + stop.brake_J);
        row.brake_J = brake_J;
        row.tyre_J = tyre_J;
        row.distance_m = stop.distance_m;
        row.j_mu = stop.j_mu;
        life.rows.push_back(row);
    }
    judge(plan, range, life);
    return life;
}

}  // namespace regulation
