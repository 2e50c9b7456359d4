#include "plant_sim/study/regulation/fleet.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rig_bridge/wear/draw.hpp"

namespace regulation {

namespace {

/// The brake of one life as it really is: it can take more or less until it is worn out, and wears the slower or faster for it.
wear::BrakeWear brake_of(const wear::WearPlan& plan, const wear::BrakeWear& brake, const FleetOptions& options, std::uint64_t life) {
    constexpr std::uint64_t kStream = 1U << 20U;  // beyond those of the lives' landings
    wear::Generator generator = wear::generator_of(options.seed, kStream + life);
    const double budget = std::max(1.0 + options.brake_deviation * wear::normal(generator), 0.5);
    wear::BrakeWear own = brake;
    own.life_J = plan.brake_taken_J + budget * plan.brake_budget_J();
    own.scale.energy *= own.life_J / plan.brake_life_J;
    return own;
}

LivingPair pair_of(const wear::WearPlan& plan, const wear::Rules& rules, const wear::Range& range, const Policy& policy, const wear::BrakeWear& brake,
                   const FleetOptions& options, std::uint64_t life) {
    constexpr std::size_t kBeyond = 2;  // times the plan: even a life of light landings is over by then
    const auto planned = static_cast<std::size_t>(plan.landings);
    return {plan, rules, range, draw_life(options.seed, life, kBeyond * planned, planned, options.scenarios, options.mix, options.missing),
            LifeOptions{.fixed = policy.fixed,
                        .brake = brake_of(plan, brake, options, life),
                        .rule = {},
                        .brake_seed = options.seed + life,
                        .inspection = options.inspection,
                        .allowed_on = options.allowed_on,
                        .life_forecast = options.life_forecast,
                        .worst_stops = options.worst_stops && !policy.fixed}};
}

}  // namespace

std::vector<PolicyLives> run_fleet(const wear::WearPlan& plan, const wear::Rules& rules, const wear::Range& range,
                                   const std::vector<Policy>& policies, const wear::BrakeWear& brake, const FleetOptions& options,
                                   const Lander& land) {
    std::vector<LivingPair> pairs;  // all policies of the first life, then of the second
    pairs.reserve(static_cast<std::size_t>(options.lives) * policies.size());
    for (std::uint64_t life = 0; life < static_cast<std::uint64_t>(options.lives); ++life) {
        for (const Policy& policy : policies) pairs.push_back(pair_of(plan, rules, range, policy, brake, options, life));
    }
    struct Request {
        LivingPair* pair;
        std::size_t count;
    };
    std::vector<Request> asked;
    std::vector<LandingRequest> requests;
    std::size_t done = 0;
    for (;;) {
        asked.clear();
        requests.clear();
        for (LivingPair& pair : pairs) {
            if (pair.over()) continue;
            const std::vector<LandingRequest> own = pair.requests();
            asked.push_back({&pair, own.size()});
            requests.insert(requests.end(), own.begin(), own.end());
        }
        if (requests.empty()) break;
        if (options.stop != nullptr && options.stop->load()) return {};
        const std::vector<Stop> stops = land(requests);
        std::span<const Stop> left = stops;
        for (const Request& one : asked) {
            one.pair->landed(left.first(one.count));
            left = left.subspan(one.count);
        }
        done += stops.size();
        if (options.on_stops) options.on_stops(done);
    }
    std::vector<PolicyLives> all;
    all.reserve(policies.size());
    for (std::size_t p = 0; p < policies.size(); ++p) {
        PolicyLives lives{policies[p], {}};
        for (std::size_t i = p; i < pairs.size(); i += policies.size()) lives.lives.push_back(pairs[i].life());
        all.push_back(std::move(lives));
    }
    return all;
}

Summary summary(const PolicyLives& policy, const std::vector<bool>& feasible, double tolerance) {
    Summary s;
    const auto lives = static_cast<double>(policy.lives.size());
    double stops = 0.0;
    for (std::size_t i = 0; i < policy.lives.size(); ++i) {
        const Life& life = policy.lives[i];
        if (feasible[i]) ++s.feasible;
        if (feasible[i] && life.met) ++s.met;
        if (life.other_left <= tolerance) ++s.together;
        s.first_landing += life.first_landing / lives;
        s.other_left += life.other_left / lives;
        s.worst_other_left = std::max(s.worst_other_left, life.other_left);
        s.brake_at_plan += life.brake_at_plan / lives;
        s.tyre_at_plan += life.tyre_at_plan / lives;
        s.floor_held = s.floor_held && life.floor_held;
        for (const LifeRow& row : life.rows) {
            s.j_mu += row.j_mu;
            s.min_j_mu = std::min(s.min_j_mu, row.j_mu);
            s.distance_m += row.distance_m;
            stops += 1.0;
        }
    }
    s.j_mu /= stops;
    s.distance_m /= stops;
    return s;
}

double best_fixed(const wear::WearPlan& plan, const std::vector<double>& grid, const std::vector<double>& tyre_share, const wear::Range& range) {
    constexpr double kStep = 0.01;  // as references are set
    const double wanted = plan.tyre_budget_J() / (plan.tyre_budget_J() + plan.brake_budget_J());
    double best = 0.0;
    double min = 2.0;
    const int first = static_cast<int>(std::ceil(range.lowest / kStep - 1e-9));
    const int last = static_cast<int>(std::floor(range.highest / kStep + 1e-9));
    for (int k = first; k <= last; ++k) {
        const double reference = k * kStep;
        const auto above = std::clamp<std::ptrdiff_t>(std::upper_bound(grid.begin(), grid.end(), reference) - grid.begin(), 1,
                                                      static_cast<std::ptrdiff_t>(grid.size()) - 1);
        const auto j = static_cast<std::size_t>(above);
        const double t = (reference - grid[j - 1]) / (grid[j] - grid[j - 1]);
        const double share = tyre_share[j - 1] + t * (tyre_share[j] - tyre_share[j - 1]);
        if (const double off = std::abs(share - wanted); off < min) {
            min = off;
            best = reference;
        }
    }
    return best;
}

}  // namespace regulation
