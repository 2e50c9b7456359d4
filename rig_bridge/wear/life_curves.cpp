#include "rig_bridge/wear/life_curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace wear {

namespace {

using Values = LifeCurves::Values;
using Covariance = LifeCurves::Covariance;

constexpr int kGrid = 161;
constexpr double kReach = 4.0;  // standard deviations of log L that the grid covers
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
        std::copy_backward(before.begin(), before.end() - 1, before.end());
        before.front() = (campaign.points[i].c_e_J - taken_J) / landing_J - 1.0;
        taken_J = campaign.points[i].c_e_J;
    }
    return out;
}

double at(const Values& curve, const KnotPlace& place) {
    return curve(place.knot) + place.next * (curve(place.knot + 1) - curve(place.knot));
}

double of(const std::array<double, kEnergiesBefore>& by, const std::array<double, kEnergiesBefore>& energies) {
    return std::inner_product(by.begin(), by.end(), energies.begin(), 0.0);
}

using State = Eigen::Matrix<double, LifeFilter::kStates, 1>;
using StateCovariance = Eigen::Matrix<double, LifeFilter::kStates, LifeFilter::kStates>;

/// What is seen of the state at a place: covariance with it, and variance of it.
State seen(const StateCovariance& covariance, const KnotPlace& place) {
    return covariance.col(place.knot) * (1.0 - place.next) + covariance.col(place.knot + 1) * place.next + covariance.col(kCurve);
}
double seen(const State& x, const KnotPlace& place) {
    return x(place.knot) * (1.0 - place.next) + x(place.knot + 1) * place.next + x(kCurve);
}

StateCovariance prior_covariance(const LifeCurves& c) {
    StateCovariance out = StateCovariance::Zero();
    out.topLeftCorner<kCurve, kCurve>() = c.covariance;
    out(kCurve, kCurve) = square(c.scatter.remembered);
    return out;
}

/// A measurement that was `off` the prediction, and the way to the next maneuver.
void update(State& state, StateCovariance& covariance, const State& gain, double off, double variance, const Scatter& scatter) {
    state += gain * (off / variance);
    covariance.noalias() -= gain * (gain / variance).transpose();
    state(kCurve) *= scatter.memory;
    covariance.row(kCurve) *= scatter.memory;
    covariance.col(kCurve) *= scatter.memory;
    covariance(kCurve, kCurve) += (1.0 - square(scatter.memory)) * square(scatter.remembered);
}

/// Curve of one worn-out brake given all of its maneuvers.
struct Smoothed {
    Values mean;
    Covariance covariance;
};
Smoothed smoothed(const WornOut& brake, const LifeCurves& c, const Values& prior) {
    State state = State::Zero();
    state.head<kCurve>() = prior;
    StateCovariance covariance = prior_covariance(c);
    for (std::size_t i = 0; i < brake.friction.size(); ++i) {
        const State gain = seen(covariance, brake.places[i]);
        const double variance = seen(gain, brake.places[i]) + square(c.scatter.fresh);
        const double off = brake.friction[i] - seen(state, brake.places[i]) - of(c.energy, brake.energies[i]);
        update(state, covariance, gain, off, variance, c.scatter);
    }
    return {state.head<kCurve>(), covariance.topLeftCorner<kCurve, kCurve>()};
}

/// Expectation maximisation of what learn_life_curves() says, `evidence` apart.
LifeCurves fitted(const std::vector<WornOut>& brakes, double landing_J) {
    LifeCurves c;
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
    Covariance normal_matrix = Covariance::Identity() * 1e-6;
    Values right = Values::Zero();
    double sum = 0.0, count = 0.0;
    for (const WornOut& b : brakes)
        for (std::size_t i = 0; i < b.friction.size(); ++i) {
            Values row = Values::Zero();
            row(b.places[i].knot) = 1.0 - b.places[i].next;
            row(b.places[i].knot + 1) = b.places[i].next;
            normal_matrix += row * row.transpose();
            right += row * b.friction[i];
            sum += b.friction[i];
            count += 1.0;
        }
    right += Values::Constant(1e-6 * sum / count);
    c.mean = normal_matrix.ldlt().solve(right);
    double off2 = 0.0;
    for (const WornOut& b : brakes)
        for (std::size_t i = 0; i < b.friction.size(); ++i) off2 += square(b.friction[i] - at(c.mean, b.places[i])) / count;
    c.covariance = Covariance::Identity() * off2;
    c.scatter = {0.3, 0.5 * std::sqrt(off2), std::sqrt(off2), 0.0};
    for (int iteration = 0; iteration < kIterations; ++iteration) {
        std::vector<Smoothed> curves;
        Covariance uncertain = Covariance::Zero();
        Values level = Values::Zero(), slope = Values::Zero();
        for (std::size_t k = 0; k < brakes.size(); ++k) {
            curves.push_back(smoothed(brakes[k], c, c.mean + z[k] * c.by_life));
            uncertain += curves.back().covariance;
            level += curves.back().mean / n;
            constexpr double kRidge = 2.0;  // of the slope: as if two more lives had shown none
            slope += z[k] * curves.back().mean / (squares + kRidge);
        }
        c.mean = level;
        c.by_life = slope;
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
        Covariance spread = uncertain;
        for (std::size_t k = 0; k < brakes.size(); ++k) {
            const Values off = curves[k].mean - c.mean - z[k] * c.by_life;
            spread += off * off.transpose();
        }
        constexpr double kDiagonal = 3.0;  // as if so many more lives had shown no correlation between the knots
        spread += kDiagonal / n * Covariance(spread.diagonal().asDiagonal());
        c.covariance = spread / (n + kDiagonal) + Covariance::Identity() * 1e-9;
        constexpr std::size_t kLags = 4;
        std::array<double, kLags> gamma{};
        for (std::size_t k = 0; k < brakes.size(); ++k) {
            const WornOut& b = brakes[k];
            std::vector<double> residual;
            for (std::size_t i = 0; i < b.friction.size(); ++i)
                residual.push_back(b.friction[i] - at(curves[k].mean, b.places[i]) - of(c.energy, b.energies[i]));
            for (std::size_t i = 0; i < residual.size(); ++i) {
                const Covariance& v = curves[k].covariance;
                const Values row = v.col(b.places[i].knot) * (1.0 - b.places[i].next) + v.col(b.places[i].knot + 1) * b.places[i].next;
                for (std::size_t lag = 0; lag < kLags && lag <= i; ++lag)
                    gamma.at(lag) += (residual[i] * residual[i - lag] + at(row, b.places[i - lag])) / count;
            }
        }
        constexpr double kMaxMemory = 0.95;
        const double two = gamma[1] + gamma[2];
        const double memory = two > 0.0 ? std::clamp((gamma[2] + gamma[3]) / two, 0.0, kMaxMemory) : 0.0;
        const double remembered = memory > 0.0 ? std::clamp(gamma[1] / memory, 0.0, 0.9 * gamma[0]) : 0.0;
        c.scatter = {memory, std::sqrt(remembered), std::sqrt(gamma[0] - remembered), 0.0};
    }
    return c;
}

/// Probability density of log L, by straight lines between the grid's, at the true life.
double log_score(const std::vector<double>& log_lives, const std::vector<double>& log_weights, double truth) {
    const double greatest = *std::max_element(log_weights.begin(), log_weights.end());
    double sum = 0.0;
    for (const double w : log_weights) sum += std::exp(w - greatest);
    const double step = log_lives[1] - log_lives[0];
    const double place = std::clamp((truth - log_lives.front()) / step, 0.0, static_cast<double>(log_lives.size()) - 1.001);
    const auto i = static_cast<std::size_t>(place);
    const double next = place - static_cast<double>(i);
    constexpr double kMin = 1e-4;  // so that one odd life does not decide
    return std::log(kMin + ((1.0 - next) * std::exp(log_weights[i] - greatest) + next * std::exp(log_weights[i + 1] - greatest)) / sum / step);
}

}  // namespace

KnotPlace knot_place(double share) {
    constexpr double kMaxNext = 2.0;
    const auto above = std::upper_bound(kLifeKnots.begin(), kLifeKnots.end(), share);
    const auto i = std::clamp<std::ptrdiff_t>(above - kLifeKnots.begin() - 1, 0, kCurve - 2);
    const auto k = static_cast<std::size_t>(i);
    return {static_cast<int>(i), std::clamp((share - kLifeKnots.at(k)) / (kLifeKnots.at(k + 1) - kLifeKnots.at(k)), 0.0, kMaxNext)};
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
    if (greatest - sum < kDeviations * scatter * std::sqrt(static_cast<double>(p.size() - 1 - end))) end = p.size() - 1;
    return p[end].c_e_J;
}

LifeCurves learn_life_curves(const std::vector<Campaign>& campaigns, double limit) {
    if (campaigns.size() < 3) throw std::invalid_argument("lives are learnt from three campaigns at least, better twenty");
    double landing_J = 0.0;
    for (const Campaign& c : campaigns)
        landing_J += (c.points.back().c_e_J - taken_before_J(c)) / static_cast<double>(c.points.size() * campaigns.size());
    std::vector<WornOut> brakes;
    brakes.reserve(campaigns.size());
    for (const Campaign& c : campaigns) brakes.push_back(worn_out(c, end_of_life_J(c, limit), landing_J));
    LifeCurves out = fitted(brakes, landing_J);
    std::array<double, kEvidence.size()> scores{};
    for (std::size_t k = 0; k < brakes.size() && brakes.size() > 3; ++k) {
        std::vector<WornOut> others = brakes;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
        const LifeCurves by = fitted(others, landing_J);
        LifeFilter filter(by);
        int tenth = 1;
        for (const Point& p : campaigns[k].points) {
            filter.learn(p);
            if (p.c_e_J < 0.1 * tenth * brakes[k].life_J) continue;
            for (std::size_t e = 0; e < kEvidence.size(); ++e) {
                std::vector<double> log_lives, log_weights;
                for (const LifeFilter::Hypothesis& h : filter.hypotheses()) {
                    log_lives.push_back(std::log(h.life_J));
                    log_weights.push_back(h.log_prior + kEvidence.at(e) * h.log_likelihood);
                }
                scores.at(e) += log_score(log_lives, log_weights, std::log(brakes[k].life_J));
            }
            if (++tenth > 9) break;
        }
    }
    out.evidence = kEvidence.at(static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin()));
    return out;
}

LifeFilter::LifeFilter(const LifeCurves& curves) : curves_(&curves) {
    const double freedom = static_cast<double>(curves.lives) - 1.0;
    const double deviation = std::sqrt(1.0 + 1.0 / static_cast<double>(curves.lives));
    hypotheses_.reserve(kGrid);
    for (int i = 0; i < kGrid; ++i) {
        const double t = kReach * (2.0 * i / (kGrid - 1) - 1.0);
        const double deviations = deviation * t;
        add(std::exp(curves.log_life + curves.log_life_deviation * deviations), deviations, -0.5 * (freedom + 1.0) * std::log1p(t * t / freedom));
    }
}

LifeFilter::LifeFilter(const LifeCurves& curves, double life_J) : curves_(&curves) {
    add(life_J, (std::log(life_J) - curves.log_life) / curves.log_life_deviation, 0.0);
}

void LifeFilter::add(double life_J, double deviations, double log_prior) {
    Hypothesis h{life_J, log_prior, 0.0, State::Zero(), prior_covariance(*curves_)};
    h.state.head<kCurve>() = curves_->mean + deviations * curves_->by_life;
    hypotheses_.push_back(h);
}

double LifeFilter::of_energies() const {
    return of(curves_->energy, energies_);
}

LifeFilter::Predicted LifeFilter::predicted(const Hypothesis& h) const {
    const KnotPlace place = knot_place(taken_J_ / h.life_J);
    return {seen(h.state, place) + of_energies(), seen(seen(h.covariance, place), place) + square(curves_->scatter.fresh)};
}

void LifeFilter::learn(const Point& point) {
    const double by_energies = of_energies();
    for (Hypothesis& h : hypotheses_) {
        const KnotPlace place = knot_place(taken_J_ / h.life_J);
        const State gain = seen(h.covariance, place);
        const double variance = seen(gain, place) + square(curves_->scatter.fresh);
        const double off = point.mean_friction - seen(h.state, place) - by_energies;
        h.log_likelihood -= 0.5 * (off * off / variance + std::log(variance));
        update(h.state, h.covariance, gain, off, variance, curves_->scatter);
    }
    std::copy_backward(energies_.begin(), energies_.end() - 1, energies_.end());
    // Where a brake comes with energy that was taken before, the first maneuver's own is not known.
    const double energy_J = point.c_e_J - taken_J_;
    constexpr double kMax = 3.0;
    energies_.front() = begun_ || energy_J < kMax * curves_->landing_J ? std::min(kMax, energy_J / curves_->landing_J) - 1.0 : 0.0;
    taken_J_ = point.c_e_J;
    begun_ = true;
}

std::vector<LifeFilter::Life> LifeFilter::lives() const {
    double greatest = -std::numeric_limits<double>::infinity();
    const auto log_weight = [&](const Hypothesis& h) { return h.log_prior + curves_->evidence * h.log_likelihood; };
    for (const Hypothesis& h : hypotheses_) greatest = std::max(greatest, log_weight(h));
    std::vector<Life> out;
    out.reserve(hypotheses_.size());
    double sum = 0.0;
    for (const Hypothesis& h : hypotheses_) {
        out.push_back({h.life_J, std::exp(log_weight(h) - greatest)});
        sum += out.back().weight;
    }
    for (Life& l : out) l.weight /= sum;
    return out;
}

std::vector<double> LifeFilter::lives_J(std::size_t count) const {
    const std::vector<Life> all = lives();
    std::vector<double> out(count, all.back().life_J);
    double below = 0.0;  // up to half of the weight of life `i`
    std::size_t i = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double share = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
        const auto step = [&] { return 0.5 * (all[i].weight + all[i + 1].weight); };
        if (k == 0) below = 0.5 * all.front().weight;
        for (; i + 1 < all.size() && below + step() <= share; ++i) below += step();
        if (i + 1 == all.size()) break;
        out[k] = all[i].life_J + std::max(0.0, share - below) / step() * (all[i + 1].life_J - all[i].life_J);
    }
    return out;
}

Expectation LifeFilter::expected() const {
    const std::vector<Life> all = lives();
    double mean = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Predicted p = predicted(hypotheses_[i]);
        mean += all[i].weight * p.mean;
        squares += all[i].weight * (p.variance + p.mean * p.mean);
    }
    return {mean, std::sqrt(squares - mean * mean)};
}

double LifeFilter::log_density(double friction) const {
    const std::vector<Life> all = lives();
    double sum = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Predicted p = predicted(hypotheses_[i]);
        sum += all[i].weight * std::exp(-0.5 * square(friction - p.mean) / p.variance) / std::sqrt(2.0 * std::numbers::pi * p.variance);
    }
    return std::log(std::max(sum, std::numeric_limits<double>::min()));
}

}  // namespace wear
