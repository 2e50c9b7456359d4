#include "plant_sim/study/regulation/lives.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rig_bridge/wear/draw.hpp"

namespace regulation {

namespace {

wear::LiningLaw drawn_law(double lining_J, wear::Generator& generator) {
    const auto times = [&](double mean, double relative) { return mean * std::exp(relative * wear::normal(generator)); };
    return {.plateau = 0.25 + 0.006 * wear::normal(generator),
            .run_in = times(0.05, 0.20),
            .run_in_J = times(0.03 * lining_J, 0.35),
            .loss = times(0.025, 0.25),
            .lining_J = lining_J,
            .core_loss = times(0.035, 0.20),
            .core_share = 0.07 + 0.10 * wear::uniform(generator),
            .per_temperature = -times(0.002, 0.20),
            .memory = 0.45 + 0.30 * wear::uniform(generator),
            .play = 0.5 + 0.6 * wear::uniform(generator),
            .measurement = times(0.004, 0.20)};
}

UnfinishedLife pair_of(const wear::WearPlan& plan, const wear::Rules& rules, const wear::Range& range, const Policy& policy, const Truth& truth,
                       const LivesOptions& options, std::uint64_t life, bool worst_stops) {
    constexpr std::size_t kBeyond = 4;  // times the plan: enough for a brake and a tyre with long lives
    const auto planned = static_cast<std::size_t>(plan.landings);
    LifeOptions own = options.each;
    own.policy = policy;
    own.brake = truth.brake;
    own.tyre_life_J = truth.tyre_life_J;
    own.brake_seed = options.seed + life;
    if (!policy.forecast) own.life_forecast.reset();
    own.worst_stops = worst_stops;
    return {plan, rules, range, draw_life(options.seed, life, kBeyond * planned, planned, options.scenarios, options.mix, options.missing), own};
}

}  // namespace

Truth truth_of(const wear::WearPlan& plan, const wear::BrakeWear& planned, const LivesOptions& options, std::uint64_t life) {
    constexpr std::uint64_t kStream = 1U << 20U;  // beyond those of the lives' landings
    constexpr double kLeast = 0.1;
    wear::Generator generator = wear::generator_of(options.seed, kStream + life);
    const auto drawn = [&](double planned_J, double taken_J, double deviation) {
        for (;;) {
            const double life_J = planned_J * std::exp(deviation * wear::normal(generator));
            if (life_J - taken_J >= kLeast * (planned_J - taken_J)) return life_J;
        }
    };
    Truth truth{planned, 0.0};
    truth.brake.life_J = drawn(plan.brake_life_J, plan.brake_taken_J, options.brake_deviation);
    truth.tyre_life_J = drawn(plan.tyre_life_J, plan.tyre_taken_J, options.tyre_deviation);
    truth.brake.law = drawn_law(truth.brake.life_J / truth.brake.scale.energy, generator);
    return truth;
}

std::vector<PolicyLives> run_lives(const wear::WearPlan& plan, const wear::Rules& rules, const wear::Range& range,
                                   const std::vector<Policy>& policies, const wear::BrakeWear& brake, const LivesOptions& options,
                                   const Lander& land) {
    std::vector<UnfinishedLife> pairs;  // all policies of the first life, then of the second
    pairs.reserve(static_cast<std::size_t>(options.lives) * policies.size());
    for (std::uint64_t life = 0; life < static_cast<std::uint64_t>(options.lives); ++life) {
        const Truth truth = truth_of(plan, brake, options, life);
        for (const Policy& policy : policies)
            pairs.push_back(pair_of(plan, rules, range, policy, truth, options, life, options.worst_stops && &policy == &policies.front()));
    }
    struct Request {
        UnfinishedLife* pair;
        std::size_t count;
    };
    std::vector<Request> asked;
    std::vector<LandingRequest> requests;
    std::size_t done = 0;
    for (;;) {
        asked.clear();
        requests.clear();
        for (UnfinishedLife& pair : pairs) {
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
    double landings = 0.0;  // to the first limits
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
        s.cost += life.cost;
        s.loss += life.loss;
        landings += life.first_landing;
        for (const LifeRow& row : life.rows) {
            s.j_mu += row.j_mu;
            s.min_j_mu = std::min(s.min_j_mu, row.j_mu);
            s.distance_m += row.distance_m;
            stops += 1.0;
        }
    }
    s.cost /= landings;
    s.loss /= landings;
    s.j_mu /= stops;
    s.distance_m /= stops;
    return s;
}

double best_fixed(const wear::WearPlan& plan, const wear::SurfaceTable& table, const wear::Range& range) {
    constexpr double kStep = 0.01;  // as references are set
    const double wanted = plan.tyre_budget_J() / (plan.tyre_budget_J() + plan.brake_budget_J());
    double best = 0.0;
    double min = 2.0;
    const int first = static_cast<int>(std::ceil(range.lowest / kStep - 1e-9));
    const int last = static_cast<int>(std::floor(range.highest / kStep + 1e-9));
    for (int k = first; k <= last; ++k) {
        const double reference = k * kStep;
        double share = 0.0;
        for (const wear::SurfaceTable::Row& row : table.rows) share += table.at(row.tyre_share, reference) / static_cast<double>(table.rows.size());
        if (const double off = std::abs(share - wanted); off < min) {
            min = off;
            best = reference;
        }
    }
    return best;
}

}  // namespace regulation
