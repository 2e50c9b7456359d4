#include "rig_bridge/wear/life_curves.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "rig_bridge/wear/life_kalman.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace wear {

namespace {

using life::at;
using life::of;
using life::Values;
using life::ValuesCovariance;

/// Of a brake: its curve at the knots and, last, the slope of its lining's wear.
using Traits = Eigen::Matrix<double, life::kKnots + 1, 1>;
using TraitsCovariance = Eigen::Matrix<double, life::kKnots + 1, life::kKnots + 1>;

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
    std::vector<LiningReading> readings;

    [[nodiscard]] double share(const LiningReading& reading) const { return reading.c_e_J / life_J; }
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
    constexpr double kFirstShare = 0.1;  // before, a reading says more of its error than of the slope
    for (const LiningReading& r : campaign.readings)
        if (r.c_e_J >= kFirstShare * life_J && r.c_e_J <= kAfterEnd * life_J) out.readings.push_back(r);
    if (out.readings.size() < 2) out.readings.clear();  // of one alone nobody can tell error and slope apart
    return out;
}

/// Traits of one worn-out brake given all of its maneuvers and readings; `z`: log L in deviations.
struct Smoothed {
    Traits mean;
    TraitsCovariance covariance;
};
Smoothed smoothed(const WornOut& brake, const LifeCurves& c, double z) {
    life::State state = life::State::Zero();
    state.head<life::kKnots>() = Eigen::Map<const Values>(c.mean.data()) + z * Eigen::Map<const Values>(c.by_life.data());
    state(life::kSlope) = c.lining.slope + z * c.lining.by_life;
    life::Covariance covariance = life::prior(c);
    for (std::size_t i = 0; i < brake.friction.size(); ++i)
        (void)life::update(state, covariance, brake.places[i], brake.friction[i] - of(c.energy, brake.energies[i]), c);
    for (const LiningReading& r : brake.readings) (void)life::read(state, covariance, brake.share(r), r.worn, c);
    Smoothed out;
    out.mean << state.head<life::kKnots>(), state(life::kSlope);
    out.covariance << covariance.topLeftCorner<life::kKnots, life::kKnots>(), covariance.col(life::kSlope).head<life::kKnots>(),
        covariance.row(life::kSlope).head<life::kKnots>(), covariance(life::kSlope, life::kSlope);
    return out;
}

constexpr std::size_t kMinRead = 5;  // lives with readings, from which their scatter can be learnt

/// The lining's wear by each brake's own line, where EM begins. With too few readings `lives` is 0.
LiningWear first_lining(const std::vector<WornOut>& brakes) {
    LiningWear out{.slope = 1.0, .variance = 1.0, .error = 1.0};
    std::vector<double> slopes;
    double squares = 0.0, count = 0.0;
    for (const WornOut& b : brakes) {
        double xx = 0.0, xy = 0.0;
        for (const LiningReading& r : b.readings) {
            xx += square(b.share(r));
            xy += b.share(r) * r.worn;
        }
        if (b.readings.empty()) continue;
        slopes.push_back(xy / xx);
        for (const LiningReading& r : b.readings) squares += square(r.worn - slopes.back() * b.share(r));
        count += static_cast<double>(b.readings.size());
    }
    if (slopes.size() < kMinRead) return out;
    constexpr double kMinDeviation = 1e-3;
    out.lives = slopes.size();
    out.slope = std::accumulate(slopes.begin(), slopes.end(), 0.0) / static_cast<double>(slopes.size());
    out.variance = square(kMinDeviation);
    for (const double s : slopes) out.variance += square(s - out.slope) / static_cast<double>(slopes.size());
    out.error = kMinDeviation + std::sqrt(squares / count);
    return out;
}

/// Scatter of the readings about the brakes' lines.
double reading_error(const std::vector<WornOut>& brakes, const std::vector<Smoothed>& traits) {
    double squares = 0.0, count = 0.0;
    for (std::size_t k = 0; k < brakes.size(); ++k)
        for (const LiningReading& r : brakes[k].readings) {
            const double share = brakes[k].share(r);
            squares += square(r.worn - traits[k].mean(life::kKnots) * share) + square(share) * traits[k].covariance(life::kKnots, life::kKnots);
            count += 1.0;
        }
    constexpr double kMinError = 0.005;  // no gauge reads a lining better [A]
    return std::max(kMinError, std::sqrt(squares / count));
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
    c.lining = first_lining(brakes);
    for (int iteration = 0; iteration < kIterations; ++iteration) {
        std::vector<Smoothed> curves;
        TraitsCovariance uncertain = TraitsCovariance::Zero();
        Traits level = Traits::Zero(), slope = Traits::Zero();
        for (std::size_t k = 0; k < brakes.size(); ++k) {
            curves.push_back(smoothed(brakes[k], c, z[k]));
            uncertain += curves.back().covariance;
            level += curves.back().mean / n;
            constexpr double kRidge = 2.0;  // of the slope: as if two more lives had shown none
            slope += z[k] * curves.back().mean / (squares + kRidge);
        }
        mean = level.head<life::kKnots>();
        by_life = slope.head<life::kKnots>();
        c.lining.slope = level(life::kKnots);
        c.lining.by_life = slope(life::kKnots);
        if (c.lining.lives > 0) c.lining.error = reading_error(brakes, curves);
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
        TraitsCovariance spread = uncertain;
        for (std::size_t k = 0; k < brakes.size(); ++k) {
            const Traits off = curves[k].mean - level - z[k] * slope;
            spread += off * off.transpose();
        }
        constexpr double kDiagonal = 3.0;  // as if so many more lives had shown no correlation between the knots
        spread += kDiagonal / n * TraitsCovariance(spread.diagonal().asDiagonal());
        spread = spread / (n + kDiagonal) + TraitsCovariance::Identity() * 1e-9;
        covariance = spread.topLeftCorner<life::kKnots, life::kKnots>();
        Eigen::Map<Values>(c.lining.with_curve.data()) = spread.col(life::kKnots).head<life::kKnots>();
        c.lining.variance = spread(life::kKnots, life::kKnots);
        constexpr std::size_t kLags = 4;
        std::array<double, kLags> gamma{};
        for (std::size_t k = 0; k < brakes.size(); ++k) {
            const WornOut& b = brakes[k];
            std::vector<double> residual;
            for (std::size_t i = 0; i < b.friction.size(); ++i)
                residual.push_back(b.friction[i] - at(curves[k].mean, b.places[i]) - of(c.energy, b.energies[i]));
            for (std::size_t i = 0; i < residual.size(); ++i) {
                const TraitsCovariance& v = curves[k].covariance;
                const auto knot = static_cast<Eigen::Index>(b.places[i].knot);
                const Traits row = v.col(knot) * (1.0 - b.places[i].next) + v.col(knot + 1) * b.places[i].next;
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
    if (c.lining.lives == 0 || c.lining.slope <= 0.0) c.lining = {};
    return c;
}

/// Log of the probability density of log L, by straight lines between the grid's lives, at the true one, with these exponents.
double log_score(const LifeFilter& filter, double evidence, double of_readings, double truth) {
    const std::vector<LifeFilter::Hypothesis>& h = filter.hypotheses();
    const auto log_weight = [&](std::size_t i) { return h[i].log_prior + evidence * h[i].log_likelihood + of_readings * h[i].log_readings; };
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
    // Of the exponent of the friction, and of the readings' where there are some.
    const std::size_t of_readings = out.lining.lives > 0 ? kEvidence.size() : 1;
    std::vector<std::array<std::array<double, kEvidence.size()>, kEvidence.size()>> scores(brakes.size());
    if (brakes.size() == 3) return out;
    run_jobs(threads, brakes.size(), [&](std::size_t k) {
        std::vector<WornOut> others = brakes;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
        const LifeCurves by = fitted(others, landing_J);
        LifeFilter filter(by);
        int tenth = 1;
        auto reading = campaigns[k].readings.begin();
        for (const Point& p : campaigns[k].points) {
            filter.learn(p);
            for (; reading != campaigns[k].readings.end() && reading->c_e_J <= p.c_e_J; ++reading) filter.read(*reading);
            if (p.c_e_J < 0.1 * tenth * brakes[k].life_J) continue;
            for (std::size_t r = 0; r < of_readings; ++r)
                for (std::size_t e = 0; e < kEvidence.size(); ++e)
                    scores[k].at(r).at(e) += log_score(filter, kEvidence.at(e), kEvidence.at(r), std::log(brakes[k].life_J));
            if (++tenth > 9) break;
        }
    });
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < of_readings; ++r)
        for (std::size_t e = 0; e < kEvidence.size(); ++e) {
            double sum = 0.0;
            for (const auto& brake : scores) sum += brake.at(r).at(e);
            if (sum <= most) continue;
            most = sum;
            out.evidence = kEvidence.at(e);
            if (out.lining.lives > 0) out.lining.evidence = kEvidence.at(r);
        }
    return out;
}

}  // namespace wear
