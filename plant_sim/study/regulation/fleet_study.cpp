#include "plant_sim/study/regulation/fleet_study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include "rig_bridge/wear/on_threads.hpp"

namespace regulation {

namespace {

constexpr int kPastBrakes = 20;  // of each law

/// What the owner knows of brakes of one law.
struct Known {
    AircraftKind kind;
    Economy economy;
};

Known known(const FleetStudy& study, wear::arena::Law law) {
    AircraftKind kind = study.kind;
    kind.law = law;
    kind.past = past_brakes(kind, study.training_seed, kPastBrakes);
    Costs costs = study.costs;
    costs.brake_per_J = study.config.rules.prices.brake / kind.past.life_J;
    costs.planned.brake_J = kind.past.life_J;
    return {kind, Economy(study.choices, costs, kind.mean_landing_J())};
}

/// All fleets of `set` under all policies, side by side: by policy, then by fleet. Empty if it was stopped.
std::vector<std::vector<FleetResult>> run_all(const FleetStudy& study, const FleetSet& set, const std::vector<FleetPolicy>& policies,
                                              std::size_t before) {
    std::vector<Known> of_law;
    of_law.reserve(set.laws.size());
    for (const wear::arena::Law law : set.laws) of_law.push_back(known(study, law));
    const auto each = static_cast<std::size_t>(set.fleets);
    const std::size_t count = each * set.laws.size();
    std::vector<std::vector<FleetResult>> results(policies.size(), std::vector<FleetResult>(count));
    std::mutex mutex;
    std::size_t done = 0;
    const auto run_one = [&](std::size_t fleet) {
        const Known& k = of_law[fleet / each];
        std::vector<std::uint64_t> seeds(static_cast<std::size_t>(study.config.aircraft));
        std::iota(seeds.begin(), seeds.end(), set.first_seed + fleet * std::uint64_t{kMaxAircraft});
        for (std::size_t p = 0; p < policies.size(); ++p) {
            if (study.stop != nullptr && study.stop->load()) return;
            results[p][fleet] = run_fleet(k.kind, study.config.rules, k.economy, policies[p], seeds);
        }
        const std::scoped_lock lock(mutex);
        ++done;
        if (study.on_fleets) study.on_fleets(before + done);
    };
    wear::run_jobs(study.threads, count, run_one, study.stop);
    if (done < count) return {};
    return results;
}

double mean_cost(const std::vector<FleetResult>& fleets) {
    double money = 0.0;
    double landings = 0.0;
    for (const FleetResult& f : fleets) {
        money += f.money.all();
        landings += static_cast<double>(f.landings);
    }
    return money / landings;
}

}  // namespace

std::vector<Entrant> entrants(const FleetStudy& study, const std::vector<Choice>& references) {
    const std::vector<Choice>& all = study.choices.all();
    std::vector<const Choice*> one, by_surface;
    one.reserve(references.size());
    for (const Choice& choice : references) one.push_back(&choice);
    constexpr std::size_t kLevels = 8;  // from the lowest to the highest
    by_surface.reserve(kLevels);
    for (std::size_t k = 0; k < kLevels; ++k) by_surface.push_back(&all[k * (all.size() - 1) / (kLevels - 1)]);
    const std::vector<const Choice*> standing{one.front()};
    const auto entrant = [](std::string name, const std::vector<const Choice*>& shares, const FleetPolicy& policy) {
        constexpr std::array kMargins_days{0.0, 1.0, 2.0};
        Entrant e{std::move(name), {}};
        e.variants.reserve(shares.size() * kMargins_days.size());
        for (const Choice* share : shares)
            for (const double margin_days : kMargins_days)
                if (policy.visits != Visits::at_limit || margin_days == 0.0)
                    e.variants.push_back({share, policy.together, policy.visits, margin_days, policy.own_bay});
        return e;
    };
    const FleetPolicy at_limit{}, booked{.visits = Visits::earliest_due}, spread{.visits = Visits::spread};
    const FleetPolicy both_at_limit{.together = true}, both_booked{.together = true, .visits = Visits::earliest_due};
    const FleetPolicy both_spread{.together = true, .visits = Visits::spread};
    const FleetPolicy both_own_bay{.together = true, .visits = Visits::earliest_due, .own_bay = true};
    return {entrant("fixed reference, at the limit", standing, at_limit),
            entrant("fixed reference, booked", standing, booked),
            entrant("best fixed reference, booked", one, booked),
            entrant("best fixed share, at the limit", by_surface, at_limit),
            entrant("best fixed share, booked", by_surface, booked),
            entrant("best fixed share, spread", by_surface, spread),
            entrant("each by itself, at the limit", by_surface, both_at_limit),
            entrant("each by itself, booked", by_surface, both_booked),
            entrant("each by itself, spread", by_surface, both_spread),
            entrant("each by itself, booked, a bay for each", by_surface, both_own_bay)};
}

std::vector<Judged> judge(const FleetStudy& study, const std::vector<Entrant>& entrants) {
    std::vector<FleetPolicy> tried;
    for (const Entrant& e : entrants) tried.insert(tried.end(), e.variants.begin(), e.variants.end());
    const auto tuning = run_all(study, study.config.tuning, tried, 0);
    if (tuning.empty()) return {};
    std::vector<FleetPolicy> best;
    best.reserve(entrants.size());
    auto result = tuning.begin();
    for (const Entrant& e : entrants) {
        const auto end = result + static_cast<std::ptrdiff_t>(e.variants.size());
        const auto least = std::min_element(result, end, [](const auto& a, const auto& b) { return mean_cost(a) < mean_cost(b); });
        best.push_back(e.variants[static_cast<std::size_t>(least - result)]);
        result = end;
    }
    auto held_out =
        run_all(study, study.config.held_out, best, study.config.tuning.laws.size() * static_cast<std::size_t>(study.config.tuning.fleets));
    std::vector<Judged> judged;
    judged.reserve(held_out.size());
    for (std::size_t p = 0; p < held_out.size(); ++p) judged.push_back({entrants[p].name, best[p], std::move(held_out[p])});
    return judged;
}

double per_landing(const Judged& policy) {
    return mean_cost(policy.fleets);
}

Saving saving(const Judged& policy, const Judged& other) {
    const auto count = static_cast<double>(policy.fleets.size());
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < policy.fleets.size(); ++i) {
        const double less = other.fleets[i].per_landing() - policy.fleets[i].per_landing();
        sum += less;
        squares += less * less;
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / (count - 1.0))};
}

}  // namespace regulation
