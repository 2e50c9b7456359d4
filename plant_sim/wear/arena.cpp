#include "plant_sim/wear/arena.hpp"

#include <algorithm>
#include <boost/math/distributions/lognormal.hpp>
#include <cmath>
#include <numbers>

#include "plant_sim/wear/law_filter.hpp"
#include "rig_bridge/wear/landings_forecast.hpp"
#include "rig_bridge/wear/learn_population.hpp"
#include "rig_bridge/wear/life_filter.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace wear::arena {

namespace {

constexpr int kHorizon = 2000;
constexpr std::size_t kDraws = 200;

double density(double z) {
    return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
}
double cumulative(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}
/// E|X| of a normal X.
double mean_size(double mean, double deviation) {
    return mean * (2.0 * cumulative(mean / deviation) - 1.0) + 2.0 * deviation * density(mean / deviation);
}

/// Closed form for normal mixtures (Grimit et al., Q. J. R. Meteorol. Soc. 132, 2006).
double crps(const Conditional& c, double x) {
    double out = 0.0;
    for (const Conditional::Term& a : c.terms) {
        out += a.weight * mean_size(x - a.mean, std::sqrt(a.variance));
        for (const Conditional::Term& b : c.terms) out -= 0.5 * a.weight * b.weight * mean_size(a.mean - b.mean, std::sqrt(a.variance + b.variance));
    }
    return out;
}

double log_score(const Conditional& c, double x) {
    double p = 1e-300;
    for (const Conditional::Term& t : c.terms) p += t.weight * density((x - t.mean) / std::sqrt(t.variance)) / std::sqrt(t.variance);
    return -std::log(p);
}

/// Level and slope that walk, seen through white noise. Deviations a landing are relative to the noise, which is measured in the training lives.
class LocalLinear {
  public:
    explicit LocalLinear(double noise) : noise_(noise * noise) {}
    [[nodiscard]] Conditional next() const { return {{{1.0, level_ + slope_, ahead_level() + noise_}}}; }
    void learn(double friction) {
        const double off = friction - level_ - slope_;
        const double p00 = ahead_level(), p01 = p01_ + p11_, p11 = p11_ + kSlope * kSlope * noise_;
        const double all = p00 + noise_;
        level_ += slope_ + p00 / all * off;
        slope_ += p01 / all * off;
        p00_ = p00 - p00 * p00 / all;
        p01_ = p01 - p00 * p01 / all;
        p11_ = p11 - p01 * p01 / all;
    }
    [[nodiscard]] int landings_left(double limit, Generator& generator) const {
        const double root = std::sqrt(p00_), z = normal(generator);
        double level = level_ + root * z;
        double slope = slope_ + p01_ / root * z + std::sqrt(std::max(0.0, p11_ - p01_ * p01_ / p00_)) * normal(generator);
        int n = 0;
        for (; level >= limit && n < kHorizon; ++n) {
            slope += kSlope * std::sqrt(noise_) * normal(generator);
            level += slope + kLevel * std::sqrt(noise_) * normal(generator);
        }
        return n;
    }

  private:
    static constexpr double kLevel = 0.1;
    static constexpr double kSlope = 0.003;
    [[nodiscard]] double ahead_level() const { return p00_ + 2.0 * p01_ + p11_ + kLevel * kLevel * noise_; }
    double noise_;
    double level_ = 0.27, slope_ = 0.0;
    double p00_ = 0.03 * 0.03, p01_ = 0.0, p11_ = 0.001 * 0.001;
};

/// What methods learnt of one law's lives.
struct Trained {
    Population population;
    double log_life = 0.0, log_life_deviation = 0.0;
    double step = 0.0;  // root mean square of the change of friction from one landing to the next
    std::vector<Conditional> by_landing;
};

Trained train(const Plan& plan, Law law) {
    std::vector<Campaign> campaigns;
    for (std::size_t k = 0; k < plan.training_lives; ++k) campaigns.push_back(live(law, plan.settings, plan.settings.training + k).campaign);
    Trained t;
    LearnSettings learn;
    learn.fit.max_components = 5;
    learn.fit.starts = 5;
    learn.limit = plan.settings.limit;
    t.population = learn_population(campaigns, learn);
    const auto n = static_cast<double>(campaigns.size());
    double squares = 0.0, steps = 0.0, count = 0.0;
    std::size_t longest = 0;
    for (const Campaign& c : campaigns) {
        longest = std::max(longest, c.points.size());
        t.log_life += std::log(static_cast<double>(c.points.size())) / n;
        for (std::size_t i = 1; i < c.points.size(); ++i, count += 1.0)
            steps += std::pow(c.points[i].mean_friction - c.points[i - 1].mean_friction, 2);
    }
    for (const Campaign& c : campaigns) squares += std::pow(std::log(static_cast<double>(c.points.size())) - t.log_life, 2);
    t.log_life_deviation = std::sqrt(squares / (n - 1.0));
    t.step = std::sqrt(steps / count);
    for (std::size_t i = 0; i < longest; ++i) {
        double sum = 0.0, sum2 = 0.0, m = 0.0;
        for (const Campaign& c : campaigns) {
            if (i >= c.points.size()) continue;
            sum += c.points[i].mean_friction;
            sum2 += c.points[i].mean_friction * c.points[i].mean_friction;
            m += 1.0;
        }
        if (m < 3.0) break;
        // The scatter of one more reading: a few lives may by chance agree.
        const double variance = (std::max(0.0, sum2 - sum * sum / m) + t.step * t.step) / m;
        t.by_landing.push_back({{{1.0, sum / m, variance}}});
    }
    return t;
}

/// A distribution of landings left: equally probable values, rising.
using Left = std::vector<double>;

/// Of a lognormal life that is longer than `landed`.
Left lognormal_left(const Trained& t, double landed, std::size_t count = kDraws) {
    const boost::math::lognormal life(t.log_life, t.log_life_deviation);
    const double longer = boost::math::cdf(complement(life, landed));
    Left out(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        out[i] = boost::math::quantile(complement(life, longer * (1.0 - share))) - landed;
    }
    return out;
}

/// The same, weighed by readings of the lining.
Left read_left(const Trained& t, const Plan& plan, const LiningLikelihood& lining, double landed, double taken_J) {
    if (!lining.any()) return lognormal_left(t, landed);
    const double landing_J = plan.settings.mean_energy_J();
    Left out = lognormal_left(t, landed, 20 * kDraws);
    for (double& left : out) left = taken_J + left * landing_J;
    out = lining.given(out, kDraws);
    for (double& left : out) left = (left - taken_J) / landing_J;
    return out;
}

template <typename Draw>
Left drawn_left(const Draw& draw) {
    Left out(kDraws);
    for (std::size_t i = 0; i < kDraws; ++i) out[i] = draw(i);
    std::sort(out.begin(), out.end());
    return out;
}

/// One method's sums over one life.
struct Tally {
    double crps = 0.0, log_score = 0.0;
    std::vector<double> pit;
    std::array<LeftScore, kTenths> left{};

    void next(const Conditional& c, double x) {
        crps += arena::crps(c, x);
        log_score += arena::log_score(c, x);
        pit.push_back(c.cumulative(x));
    }
    void landings(std::size_t tenth, const Left& rising, double truth) {
        LeftScore& s = left.at(tenth);
        const double low = rising[kDraws / 10 - 1], high = rising[kDraws - kDraws / 10 - 1];
        ++s.asked;
        s.held += truth >= low && truth <= high ? 1.0 : 0.0;
        s.width += high - low;
        s.crps += wear::crps(rising, truth);
    }
};
using Tallies = std::array<Tally, kMethodNames.size()>;

Left left_of(const Forecast& f) {
    Left out;
    out.reserve(f.landings.size());
    for (const double n : f.landings) out.push_back(std::min(n, static_cast<double>(kHorizon)));
    return out;
}

/// Landings until the brake is below its limit.
int landings_of(Brake brake, const Plan& plan, Generator generator) {
    int n = 0;
    for (; brake.condition() >= plan.settings.limit && n < kHorizon; ++n) brake.land(landing_energy_J(plan.settings, generator), generator);
    return n;
}

Left oracle_left(const Brake& brake, const Plan& plan, std::uint64_t seed) {
    return drawn_left([&](std::size_t i) { return landings_of(brake, plan, generator_of(seed, 1000 + i)); });
}

/// Landings until the brake has taken the energy of its life.
Left curves_left(const LifeFilter& filter, const Plan& plan, std::uint64_t seed) {
    const std::vector<double> lives_J = filter.lives_J(kDraws);
    return drawn_left([&](std::size_t i) {
        Generator generator = generator_of(seed, 7000 + i);
        double taken_J = filter.taken_J();
        int n = 0;
        for (; taken_J < lives_J[i] && n < kHorizon; ++n) taken_J += landing_energy_J(plan.settings, generator);
        return n;
    });
}

/// How often and how many landings have come when forecasts are asked: the first landing of each tenth of life.
bool asked(std::size_t& tenth, std::size_t landed, std::size_t life) {
    if (tenth >= kTenths || static_cast<double>(landed) < 0.1 * static_cast<double>((tenth + 1) * life)) return false;
    ++tenth;
    return true;
}

/// The method that is told the law learns from nobody: once for each judged life.
Tally judge_told(const Plan& plan, Law law, std::uint64_t seed, bool reads) {
    const Life life = live(law, plan.settings, seed);
    const std::vector<Point>& points = life.campaign.points;
    LawFilter filter(law, plan.settings, seed);
    auto reading = life.campaign.readings.begin();
    Tally out;
    std::size_t tenth = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i > 0) {
            const Expectation e = filter.expected();
            out.next({{{1.0, e.mean, e.deviation * e.deviation}}}, points[i].mean_friction);
        }
        while (asked(tenth, i, points.size())) {
            const std::vector<Brake> brakes = filter.drawn(kDraws);
            const Left left = drawn_left([&](std::size_t k) { return landings_of(brakes[k], plan, generator_of(seed, 8000 + k)); });
            out.landings(tenth - 1, left, static_cast<double>(points.size() - i));
        }
        filter.learn(points[i]);
        for (; reads && reading != life.campaign.readings.end() && reading->c_e_J <= points[i].c_e_J; ++reading) filter.read(*reading);
    }
    return out;
}

Tallies judge(const Plan& plan, const Trained& t, Law law, std::uint64_t seed) {
    const Life life = live(law, plan.settings, seed);
    const std::vector<Point>& points = life.campaign.points;
    LandingsForecast shipped(t.population), shipped_read(t.population);
    LiningLikelihood lining(t.population.curves);
    auto reading = life.campaign.readings.begin();
    const BrakeFilter& filter = shipped.filter();
    ForecastSettings ask;
    ask.limit = plan.settings.limit;
    ask.horizon = kHorizon;
    ask.draws = static_cast<int>(kDraws);
    ask.seed = seed;
    ask.fan_points = 0;
    LocalLinear linear(t.step / std::numbers::sqrt2);
    LifeFilter curves(t.population.curves);
    Tallies out;
    const auto of = [&](Method e) -> Tally& { return out.at(static_cast<std::size_t>(e)); };
    std::size_t tenth = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double x = points[i].mean_friction;
        if (i > 0) {
            const double taken_J = points[i - 1].c_e_J, next_J = taken_J + plan.settings.mean_energy_J();
            const double newest = points[i - 1].mean_friction;
            of(Method::persistence).next({{{1.0, newest, t.step * t.step}}}, x);
            for (const Method e : {Method::past_lives, Method::past_lives_read}) of(e).next(t.by_landing[std::min(i, t.by_landing.size() - 1)], x);
            const Model& model = t.population.models.front();
            of(Method::nearest).next(friction_given_energy(model, taken_J, {Variance::exact, Choice::nearest}), x);
            of(Method::mixture).next(friction_given_energy(model, taken_J, {Variance::exact, Choice::mixture}), x);
            of(Method::local_linear).next(linear.next(), x);
            const Expectation e = filter.expected(next_J);
            of(Method::filter).next({{{1.0, e.mean, e.deviation * e.deviation}}}, x);
            of(Method::shipped).next(shipped.next(), x);
            of(Method::shipped_read).next(shipped_read.next(), x);
            const Expectation c = curves.expected();
            of(Method::life_curves).next({{{1.0, c.mean, c.deviation * c.deviation}}}, x);
            of(Method::oracle).next({{{1.0, life.before[i].expected(), Brake::kFresh * Brake::kFresh}}}, x);
        }
        for (std::size_t k = tenth; asked(tenth, i, points.size()); k = tenth) {
            const auto truth = static_cast<double>(points.size() - i);
            of(Method::past_lives).landings(k, lognormal_left(t, static_cast<double>(i)), truth);
            of(Method::local_linear)
                .landings(k, drawn_left([&](std::size_t n) {
                              Generator generator = generator_of(seed, 5000 + n);
                              return linear.landings_left(plan.settings.limit, generator);
                          }),
                          truth);
            of(Method::filter).landings(k, left_of(forecast(filter, points[i - 1].c_e_J, plan.settings.mix, ask)), truth);
            of(Method::past_lives_read).landings(k, read_left(t, plan, lining, static_cast<double>(i), points[i - 1].c_e_J), truth);
            of(Method::shipped).landings(k, left_of(shipped.forecast(plan.settings.mix, ask)), truth);
            of(Method::shipped_read).landings(k, left_of(shipped_read.forecast(plan.settings.mix, ask)), truth);
            of(Method::life_curves).landings(k, curves_left(curves, plan, seed), truth);
            of(Method::oracle).landings(k, oracle_left(life.before[i], plan, seed), truth);
        }
        linear.learn(x);
        shipped.learn(points[i]);
        shipped_read.learn(points[i]);
        curves.learn(points[i]);
        for (; reading != life.campaign.readings.end() && reading->c_e_J <= points[i].c_e_J; ++reading) {
            shipped_read.read(*reading);
            lining.read(*reading);
        }
    }
    return out;
}

std::array<Score, kMethodNames.size()> scores(const std::vector<const Tallies*>& tallies) {
    std::array<Score, kMethodNames.size()> out;
    for (std::size_t e = 0; e < out.size(); ++e) {
        Score& s = out.at(e);
        std::vector<double> pit;
        for (const Tallies* all : tallies) {
            const Tally& t = all->at(e);
            s.crps += t.crps;
            s.log_score += t.log_score;
            pit.insert(pit.end(), t.pit.begin(), t.pit.end());
            for (std::size_t k = 0; k < kTenths; ++k) {
                LeftScore& sum = s.left.at(k);
                const LeftScore& one = t.left.at(k);
                sum.asked += one.asked;
                sum.held += one.held;
                sum.width += one.width;
                sum.crps += one.crps;
            }
        }
        const auto n = static_cast<double>(pit.size());
        s.crps /= n;
        s.log_score /= n;
        std::sort(pit.begin(), pit.end());
        for (std::size_t i = 0; i < pit.size(); ++i) {
            const auto at = static_cast<double>(i);
            s.pit = std::max({s.pit, pit[i] - at / n, (at + 1.0) / n - pit[i]});
        }
        for (LeftScore& k : s.left) {
            if (k.asked == 0) continue;
            s.forecasts = true;
            for (double* sum : {&k.held, &k.width, &k.crps}) *sum /= static_cast<double>(k.asked);
        }
    }
    for (std::size_t k = 0; k < kTenths; ++k) {
        const double past = out.at(static_cast<std::size_t>(Method::past_lives)).left.at(k).crps;
        const double oracle = out.at(static_cast<std::size_t>(Method::oracle)).left.at(k).crps;
        for (Score& s : out) s.left.at(k).skill = (past - s.left.at(k).crps) / (past - oracle);
    }
    return out;
}

}  // namespace

Result run(const Plan& plan) {
    const std::size_t laws = plan.laws.size();
    std::vector<Trained> trained(laws);
    run_jobs(plan.threads, laws, [&](std::size_t i) { trained[i] = train(plan, plan.laws[i]); });
    std::vector<std::array<Tally, 2>> told(laws * plan.judged_lives);
    run_jobs(plan.threads, told.size(), [&](std::size_t job) {
        for (const bool reads : {false, true})
            told[job].at(reads ? 1 : 0) = judge_told(plan, plan.laws[job / plan.judged_lives], plan.judged_seed + job % plan.judged_lives, reads);
    });
    std::vector<Tallies> tallies(laws * laws * plan.judged_lives);
    run_jobs(plan.threads, tallies.size(), [&](std::size_t job) {
        const std::size_t pair = job / plan.judged_lives;
        tallies[job] = judge(plan, trained[pair / laws], plan.laws[pair % laws], plan.judged_seed + job % plan.judged_lives);
        const auto& [friction_only, read] = told[pair % laws * plan.judged_lives + job % plan.judged_lives];
        tallies[job].at(static_cast<std::size_t>(Method::law_told)) = friction_only;
        tallies[job].at(static_cast<std::size_t>(Method::law_told_read)) = read;
    });
    std::vector<const Tallies*> within, across;
    std::vector<std::vector<const Tallies*>> by_law(2 * laws);
    for (std::size_t job = 0; job < tallies.size(); ++job) {
        const std::size_t learnt = job / plan.judged_lives / laws, judged = job / plan.judged_lives % laws;
        (learnt == judged ? within : across).push_back(&tallies[job]);
        by_law[judged + (learnt == judged ? 0 : laws)].push_back(&tallies[job]);
    }
    Result out{scores(within), {}, {}, {}, {}};
    out.watch.resize(plan.watch ? laws : 0);
    run_jobs(plan.threads, out.watch.size(), [&](std::size_t i) {
        out.watch[i] = judge_watch(plan.laws[i], plan.settings, trained[i].population, plan.judged_seed, plan.judged_lives);
    });
    for (std::size_t i = 0; i < laws; ++i) out.within_by_law.push_back(scores(by_law[i]));
    if (across.empty()) return out;
    out.across = scores(across);
    for (std::size_t i = 0; i < laws; ++i) out.across_by_law.push_back(scores(by_law[laws + i]));
    return out;
}

}  // namespace wear::arena
