#include "rig_bridge/wear/life_curves.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "rig_bridge/wear/life_kalman.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace wear {

namespace {

using life::at;
using life::of;
using life::Values;
using life::ValuesCovariance;

constexpr int kIterations = 20;
constexpr std::array kEvidence{1.0, 0.7, 0.5, 0.35, 0.25, 0.15};

double square(double x) {
    return x * x;
}

/// A worn-out brake as the learning takes it.
struct WornOut {
    double life_J = 0.0;
    std::vector<KnotPlace> places;
    std::vector<std::array<double, kEnergiesBefore>> energies;  // as LifeFilter has them before each maneuver
    std::vector<double> friction;
};

WornOut worn_out(const Campaign& campaign, double life_J, double landing_J) {
    constexpr double kAfterEnd = 1.05;  // of a life: the curve is that of a brake in use
    WornOut out;
    out.life_J = life_J;
    double taken_J = taken_before_J(campaign);
    std::array<double, kEnergiesBefore> before{};
    for (std::size_t i = 0; i < campaign.points.size() && taken_J <= kAfterEnd * life_J; ++i) {
        out.places.push_back(knot_place(taken_J / life_J));
        out.energies.push_back(before);
        out.friction.push_back(campaign.points[i].mean_friction);
        life::come(before, (campaign.points[i].c_e_J - taken_J) / landing_J - 1.0);
        taken_J = campaign.points[i].c_e_J;
    }
    return out;
}

/// Curve of one worn-out brake given all of its maneuvers.
struct Smoothed {
    Values mean;
    ValuesCovariance covariance;
};
Smoothed smoothed(const WornOut& brake, const LifeCurves& c, const Values& prior) {
    life::State state = life::State::Zero();
    state.head<life::kKnots>() = prior;
    life::Covariance covariance = life::prior(c);
    for (std::size_t i = 0; i < brake.friction.size(); ++i)
        (void)life::update(state, covariance, brake.places[i], brake.friction[i] - of(c.energy, brake.energies[i]), c);
    return {state.head<life::kKnots>(), covariance.topLeftCorner<life::kKnots, life::kKnots>()};
}

/// Expectation maximisation of what learn_life_curves() says, `evidence` apart.
LifeCurves fitted(const std::vector<WornOut>& brakes, double landing_J) {
    LifeCurves c;
    Eigen::Map<Values> mean(c.mean.data()), by_life(c.by_life.data());
    Eigen::Map<ValuesCovariance> covariance(c.covariance.front().data());
    const auto n = static_cast<double>(brakes.size());
    c.lives = brakes.size();
    c.landing_J = landing_J;
    for (const WornOut& b : brakes) c.log_life += std::log(b.life_J) / n;
    for (const WornOut& b : brakes) c.log_life_deviation += square(std::log(b.life_J) - c.log_life) / (n - 1.0);
    constexpr double kMinDeviation = 1e-3;
    c.log_life_deviation = std::max(kMinDeviation, std::sqrt(c.log_life_deviation));
    std::vector<double> z;
    double squares = 0.0;
    for (const WornOut& b : brakes) {
        z.push_back((std::log(b.life_J) - c.log_life) / c.log_life_deviation);
        squares += square(z.back());
    }
    // Begins with one curve through all of them.
    ValuesCovariance normal_matrix = ValuesCovariance::Identity() * 1e-6;
    Values right = Values::Zero();
    double sum = 0.0, count = 0.0;
    for (const WornOut& b : brakes)
        for (std::size_t i = 0; i < b.friction.size(); ++i) {
            Values row = Values::Zero();
            const auto knot = static_cast<Eigen::Index>(b.places[i].knot);
            row(knot) = 1.0 - b.places[i].next;
            row(knot + 1) = b.places[i].next;
            normal_matrix += row * row.transpose();
            right += row * b.friction[i];
            sum += b.friction[i];
            count += 1.0;
        }
    right += Values::Constant(1e-6 * sum / count);
    mean = normal_matrix.ldlt().solve(right);
    double off2 = 0.0;
    for (const WornOut& b : brakes)
        for (std::size_t i = 0; i < b.friction.size(); ++i) off2 += square(b.friction[i] - at(mean, b.places[i])) / count;
    covariance = ValuesCovariance::Identity() * off2;
    c.memory = 0.3;
    c.remembered = 0.5 * std::sqrt(off2);
    c.fresh = std::sqrt(off2);
    for (int iteration = 0; iteration < kIterations; ++iteration) {
        std::vector<Smoothed> curves;
        ValuesCovariance uncertain = ValuesCovariance::Zero();
        Values level = Values::Zero(), slope = Values::Zero();
        for (std::size_t k = 0; k < brakes.size(); ++k) {
            curves.push_back(smoothed(brakes[k], c, mean + z[k] * by_life));
            uncertain += curves.back().covariance;
            level += curves.back().mean / n;
            constexpr double kRidge = 2.0;  // of the slope: as if two more lives had shown none
            slope += z[k] * curves.back().mean / (squares + kRidge);
        }
        mean = level;
        by_life = slope;
        // How frictions depend on energies before, and the scatter that is left.
        using Energies = Eigen::Matrix<double, static_cast<int>(kEnergiesBefore), 1>;
        Eigen::Matrix<double, static_cast<int>(kEnergiesBefore), static_cast<int>(kEnergiesBefore)> products;
        products.setIdentity();
        products *= 1e-3;
        Energies moments = Energies::Zero();
        for (std::size_t k = 0; k < brakes.size(); ++k)
            for (std::size_t i = 0; i < brakes[k].friction.size(); ++i) {
                const Energies e = Eigen::Map<const Energies>(brakes[k].energies[i].data());
                products += e * e.transpose();
                moments += e * (brakes[k].friction[i] - at(curves[k].mean, brakes[k].places[i]));
            }
        Eigen::Map<Energies>(c.energy.data()) = products.ldlt().solve(moments);
        ValuesCovariance spread = uncertain;
        for (std::size_t k = 0; k < brakes.size(); ++k) {
            const Values off = curves[k].mean - mean - z[k] * by_life;
            spread += off * off.transpose();
        }
        constexpr double kDiagonal = 3.0;  // as if so many more lives had shown no correlation between the knots
        spread += kDiagonal / n * ValuesCovariance(spread.diagonal().asDiagonal());
        covariance = spread / (n + kDiagonal) + ValuesCovariance::Identity() * 1e-9;
        constexpr std::size_t kLags = 4;
        std::array<double, kLags> gamma{};
        for (std::size_t k = 0; k < brakes.size(); ++k) {
            const WornOut& b = brakes[k];
            std::vector<double> residual;
            for (std::size_t i = 0; i < b.friction.size(); ++i)
                residual.push_back(b.friction[i] - at(curves[k].mean, b.places[i]) - of(c.energy, b.energies[i]));
            for (std::size_t i = 0; i < residual.size(); ++i) {
                const ValuesCovariance& v = curves[k].covariance;
                const auto knot = static_cast<Eigen::Index>(b.places[i].knot);
                const Values row = v.col(knot) * (1.0 - b.places[i].next) + v.col(knot + 1) * b.places[i].next;
                for (std::size_t lag = 0; lag < kLags && lag <= i; ++lag)
                    gamma.at(lag) += (residual[i] * residual[i - lag] + at(row, b.places[i - lag])) / count;
            }
        }
        constexpr double kMaxMemory = 0.95;
        const double two = gamma[1] + gamma[2];
        c.memory = two > 0.0 ? std::clamp((gamma[2] + gamma[3]) / two, 0.0, kMaxMemory) : 0.0;
        const double remembered = c.memory > 0.0 ? std::clamp(gamma[1] / c.memory, 0.0, 0.9 * gamma[0]) : 0.0;
        c.remembered = std::sqrt(remembered);
        c.fresh = std::sqrt(gamma[0] - remembered);
    }
    return c;
}

/// Log of the probability density of log L, by straight lines between the grid's lives, at the true one.
double log_score(const LifeFilter& filter, double evidence, double truth) {
    const std::vector<LifeFilter::Hypothesis>& h = filter.hypotheses();
    const auto log_weight = [&](std::size_t i) { return h[i].log_prior + evidence * h[i].log_likelihood; };
    double greatest = -std::numeric_limits<double>::infinity(), sum = 0.0;
    for (std::size_t i = 0; i < h.size(); ++i) greatest = std::max(greatest, log_weight(i));
    for (std::size_t i = 0; i < h.size(); ++i) sum += std::exp(log_weight(i) - greatest);
    const double first = std::log(h[0].life_J), step = std::log(h[1].life_J) - first;
    const double place = std::clamp((truth - first) / step, 0.0, static_cast<double>(h.size()) - 1.001);
    const auto i = static_cast<std::size_t>(place);
    const double next = place - static_cast<double>(i);
    constexpr double kMin = 1e-4;  // so that one odd life does not decide
    return std::log(kMin + ((1.0 - next) * std::exp(log_weight(i) - greatest) + next * std::exp(log_weight(i + 1) - greatest)) / sum / step);
}

/// A level that walks, seen through white noise: the walk and the noise that make the readings most likely. The ratio is searched, the noise follows.
void learn_walk(const std::vector<WornOut>& brakes, LifeCurves& c) {
    double best = -std::numeric_limits<double>::infinity();
    for (const double ratio : {0.05, 0.1, 0.2, 0.3, 0.45, 0.7, 1.0}) {
        double squares = 0.0, logs = 0.0, n = 0.0;
        for (const WornOut& b : brakes) {
            double level = b.friction.front(), variance = 1.0;  // in units of the noise's
            for (std::size_t i = 1; i < b.friction.size(); ++i, n += 1.0) {
                const double ahead = variance + ratio * ratio, all = ahead + 1.0, off = b.friction[i] - level;
                squares += off * off / all;
                logs += std::log(all);
                level += ahead / all * off;
                variance = ahead / all;
            }
        }
        const double noise2 = squares / n, score = -0.5 * (n * std::log(noise2) + logs);
        if (score <= best) continue;
        best = score;
        c.noise = std::sqrt(noise2);
        c.walk = ratio * c.noise;
    }
}

}  // namespace

KnotPlace knot_place(double share) {
    constexpr double kMaxNext = 2.0;
    const auto above = std::upper_bound(kLifeKnots.begin(), kLifeKnots.end(), share);
    const auto i = std::clamp<std::ptrdiff_t>(above - kLifeKnots.begin() - 1, 0, static_cast<std::ptrdiff_t>(kCurve) - 2);
    const auto k = static_cast<std::size_t>(i);
    return {k, std::clamp((share - kLifeKnots.at(k)) / (kLifeKnots.at(k + 1) - kLifeKnots.at(k)), 0.0, kMaxNext)};
}

double end_of_life_J(const Campaign& campaign, double limit) {
    const std::vector<Point>& p = campaign.points;
    double sum = 0.0, greatest = -std::numeric_limits<double>::infinity(), steps = 0.0;
    std::size_t end = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        sum += p[i].mean_friction - limit;
        if (i > 0) steps += square(p[i].mean_friction - p[i - 1].mean_friction);
        if (sum < greatest) continue;
        greatest = sum;
        end = i;
    }
    const double scatter = std::sqrt(0.5 * steps / static_cast<double>(std::max<std::size_t>(1, p.size() - 1)));
    constexpr double kDeviations = 2.0;
    if (limit <= 0.0 || greatest - sum < kDeviations * scatter * std::sqrt(static_cast<double>(p.size() - 1 - end))) end = p.size() - 1;
    return p[end].c_e_J;
}

LifeCurves learn_life_curves(const std::vector<Campaign>& campaigns, double limit, unsigned threads) {
    if (campaigns.size() < 3) throw std::invalid_argument("lives are learnt from three campaigns at least, better twenty");
    double landing_J = 0.0;
    for (const Campaign& c : campaigns)
        landing_J += (c.points.back().c_e_J - taken_before_J(c)) / static_cast<double>(c.points.size() * campaigns.size());
    std::vector<WornOut> brakes;
    brakes.reserve(campaigns.size());
    for (const Campaign& c : campaigns) brakes.push_back(worn_out(c, end_of_life_J(c, limit), landing_J));
    LifeCurves out = fitted(brakes, landing_J);
    out.limit = limit;
    learn_walk(brakes, out);
    std::vector<std::array<double, kEvidence.size()>> scores(brakes.size());
    if (brakes.size() == 3) return out;
    run_jobs(threads, brakes.size(), [&](std::size_t k) {
        std::vector<WornOut> others = brakes;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
        const LifeCurves by = fitted(others, landing_J);
        LifeFilter filter(by);
        int tenth = 1;
        for (const Point& p : campaigns[k].points) {
            filter.learn(p);
            if (p.c_e_J < 0.1 * tenth * brakes[k].life_J) continue;
            for (std::size_t e = 0; e < kEvidence.size(); ++e) scores[k].at(e) += log_score(filter, kEvidence.at(e), std::log(brakes[k].life_J));
            if (++tenth > 9) break;
        }
    });
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t e = 0; e < kEvidence.size(); ++e) {
        double sum = 0.0;
        for (const auto& brake : scores) sum += brake.at(e);
        if (sum <= most) continue;
        most = sum;
        out.evidence = kEvidence.at(e);
    }
    return out;
}

}  // namespace wear
