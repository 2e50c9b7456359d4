/// Against a process that is written down here: curve, life, scatter and what energies do are known.
#include "rig_bridge/wear/life_curves.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "plant_sim/wear/law_filter.hpp"
#include "rig_bridge/wear/draw.hpp"
#include "rig_bridge/wear/glazing_watch.hpp"
#include "rig_bridge/wear/landings_forecast.hpp"
#include "rig_bridge/wear/life_filter.hpp"
#include "tests/catch.hpp"

namespace {

constexpr double kLimit = 0.2;
constexpr double kLandings = 150.0;  // of a mean life
constexpr double kLifeScatter = 0.1;
constexpr double kOffset = 0.005;  // of a brake, none at the end of its life
constexpr double kHot = -0.004;    // friction for a mean energy more in the landing before
constexpr double kFresh = 0.002;

/// Straight between the knots 0.6 and 1.02, and before: falls to the limit at 1.
double curve(double share, double offset) {
    return share < 0.6 ? 0.26 - 0.02 * share + offset : 0.248 + offset - (0.048 + offset) / 0.4 * (share - 0.6);
}

constexpr double kSlope = 0.95, kSlopeScatter = 0.04;  // of the lining's wear; a brake with more friction wears further
constexpr double kReadingError = 0.02;
constexpr std::size_t kReadingEvery = 10;

struct Known {
    wear::Campaign campaign;
    double life_J = 0.0;
};
Known brake(std::uint64_t seed) {
    wear::Generator generator = wear::generator_of(seed, 77);
    Known out;
    out.life_J = 1e6 * kLandings * std::exp(kLifeScatter * wear::normal(generator));
    const double offset = kOffset * wear::normal(generator);
    double taken_J = 0.0, before = 0.0;
    while (taken_J < out.life_J) {
        const double friction = curve(taken_J / out.life_J, offset) + kHot * before + kFresh * wear::normal(generator);
        const double energy = 0.5 + wear::uniform(generator);
        before = energy - 1.0;
        taken_J += 1e6 * energy;
        out.campaign.points.push_back({taken_J, friction});
    }
    return out;
}

/// The same brake, with readings.
Known read_brake(std::uint64_t seed) {
    Known out = brake(seed);
    wear::Generator offsets = wear::generator_of(seed, 77), generator = wear::generator_of(seed, 78);
    (void)wear::normal(offsets);
    const double slope = kSlope + kSlopeScatter * (0.8 * wear::normal(offsets) + 0.6 * wear::normal(generator));
    for (std::size_t i = kReadingEvery - 1; i < out.campaign.points.size(); i += kReadingEvery) {
        const double taken_J = out.campaign.points[i].c_e_J;
        out.campaign.readings.push_back({taken_J, slope * taken_J / out.life_J + kReadingError * wear::normal(generator)});
    }
    return out;
}

const wear::LifeCurves& learnt() {
    static const wear::LifeCurves c = [] {
        std::vector<wear::Campaign> lives;
        for (std::uint64_t seed = 0; seed < 30; ++seed) lives.push_back(brake(seed).campaign);
        return wear::learn_life_curves(lives, kLimit);
    }();
    return c;
}

}  // namespace

TEST_CASE("curves over the share of life are those that the brakes were made from", "[WEAR-073]") {
    const wear::LifeCurves& c = learnt();
    CHECK(c.lives == 30);
    // 30 lives: the mean is known to 1.8 %, the deviation to 13 %.
    CHECK(c.log_life == Approx(std::log(1e6 * kLandings)).margin(3.0 * 0.018));
    CHECK(c.log_life_deviation == Approx(kLifeScatter).epsilon(0.4));
    CHECK(c.landing_J == Approx(1e6).epsilon(0.02));
    CHECK(c.fresh == Approx(kFresh).epsilon(0.05));
    CHECK(c.remembered < 0.3 * kFresh);
    CHECK(c.energy[0] == Approx(kHot).margin(3e-4));
    for (std::size_t k = 1; k < wear::kEnergiesBefore; ++k) CHECK(std::abs(c.energy.at(k)) < 3e-4);
    for (std::size_t k = 0; k < wear::kCurve; ++k) {
        CAPTURE(wear::kLifeKnots.at(k));
        const double offset = wear::kLifeKnots.at(k) < 0.6 ? 1.0 : std::max(0.0, (1.0 - wear::kLifeKnots.at(k)) / 0.4);
        // The mean of 30 offsets, and what scatter leaves; before the sixth landing few readings speak for a knot.
        CHECK(c.mean.at(k) == Approx(curve(wear::kLifeKnots.at(k), 0.0)).margin(3.0 * kOffset / std::sqrt(30.0) + 5e-4));
        CHECK(std::sqrt(c.covariance.at(k).at(k)) == Approx(kOffset * offset).margin(0.4 * kOffset));
    }
}

TEST_CASE("the same lives give the same curves on any number of threads; less than three are refused", "[WEAR-073]") {
    std::vector<wear::Campaign> lives;
    for (std::uint64_t seed = 0; seed < 5; ++seed) lives.push_back(brake(seed).campaign);
    CHECK(wear::learn_life_curves(lives, kLimit, 1) == wear::learn_life_curves(lives, kLimit, 2));
    lives.resize(2);
    CHECK_THROWS_AS(wear::learn_life_curves(lives, kLimit), std::invalid_argument);
}

TEST_CASE("a life ends where friction stays below the limit, or with the campaign", "[WEAR-073]") {
    wear::Campaign c;
    // Below in run-in, above until 100, below after.
    for (int i = 1; i <= 140; ++i) c.points.push_back({1e6 * i, i <= 5 ? 0.18 : 0.2 + 0.001 * (100.5 - i) + (i % 2 == 0 ? 2e-4 : -2e-4)});
    CHECK(wear::end_of_life_J(c, 0.2) == 100e6);
    CHECK(wear::end_of_life_J(c, 0.0) == 140e6);
    c.points.resize(102);  // two readings a little below: scatter
    CHECK(wear::end_of_life_J(c, 0.15) == 102e6);
}

TEST_CASE("with a known life the filter is the joint normal distribution of all readings", "[WEAR-073]") {
    wear::LifeCurves c = learnt();
    c.memory = 0.6;
    c.remembered = 0.0015;
    const double life_J = 140e6, deviations = (std::log(life_J) - c.log_life) / c.log_life_deviation;
    constexpr int n = 5;
    const double friction[n] = {0.262, 0.257, 0.259, 0.251, 0.254};
    const double end_J[n] = {0.7e6, 2.1e6, 3.0e6, 4.4e6, 5.0e6};
    double rows[n][wear::kCurve] = {}, mean[n] = {};
    for (int i = 0; i < n; ++i) {
        const double share = i == 0 ? 0.0 : end_J[i - 1] / life_J;
        for (std::size_t k = 0; k + 1 < wear::kCurve; ++k) {
            if (share < wear::kLifeKnots.at(k) || share >= wear::kLifeKnots.at(k + 1)) continue;
            rows[i][k + 1] = (share - wear::kLifeKnots.at(k)) / (wear::kLifeKnots.at(k + 1) - wear::kLifeKnots.at(k));
            rows[i][k] = 1.0 - rows[i][k + 1];
        }
        for (std::size_t k = 0; k < wear::kCurve; ++k) mean[i] += rows[i][k] * (c.mean.at(k) + deviations * c.by_life.at(k));
        for (int lag = 1; lag <= i; ++lag)
            mean[i] += c.energy.at(static_cast<std::size_t>(lag - 1)) * ((end_J[i - lag] - (i > lag ? end_J[i - lag - 1] : 0.0)) / c.landing_J - 1.0);
    }
    double l[n][n] = {}, z[n], expected = 0.0;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j <= i; ++j) {
            double sum = c.remembered * c.remembered * std::pow(c.memory, i - j) + (i == j ? c.fresh * c.fresh : 0.0);
            for (std::size_t a = 0; a < wear::kCurve; ++a)
                for (std::size_t b = 0; b < wear::kCurve; ++b) sum += rows[i][a] * c.covariance.at(a).at(b) * rows[j][b];
            for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
            l[i][j] = i == j ? std::sqrt(sum) : sum / l[j][j];
        }
        double off = friction[i] - mean[i];
        for (int k = 0; k < i; ++k) off -= l[i][k] * z[k];
        z[i] = off / l[i][i];
        expected += -0.5 * z[i] * z[i] - std::log(l[i][i]) - 0.5 * std::log(2.0 * std::numbers::pi);
    }
    wear::LifeFilter filter = wear::LifeFilter::of_life(c, life_J);
    double got = 0.0;
    for (int i = 0; i < n; ++i) {
        got += filter.log_density(friction[i]);
        CHECK(filter.expected().deviation == Approx(l[i][i]).epsilon(1e-9));
        filter.learn({end_J[i], friction[i]});
    }
    CHECK(got == Approx(expected).epsilon(1e-9));
    // Likelihoods of two lives, each by itself, are those of one filter that holds both.
    wear::LifeFilter grid(c);
    for (int i = 0; i < n; ++i) grid.learn({end_J[i], friction[i]});
    for (const std::size_t k : {40U, 90U}) {
        const wear::LifeFilter::Hypothesis& h = grid.hypotheses()[k];
        wear::LifeFilter one = wear::LifeFilter::of_life(c, h.life_J);
        double sum = 0.5 * n * std::log(2.0 * std::numbers::pi);
        for (int i = 0; i < n; ++i) {
            sum += one.log_density(friction[i]);
            one.learn({end_J[i], friction[i]});
        }
        CHECK(h.log_likelihood == Approx(sum).epsilon(1e-9));
    }
}

TEST_CASE("the lining's wear is learnt with its scatter, its error and what it has to do with friction", "[WEAR-074][figures]") {
    std::vector<wear::Campaign> lives;
    for (std::uint64_t seed = 0; seed < 60; ++seed) lives.push_back(read_brake(seed).campaign);
    const wear::LifeCurves c = wear::learn_life_curves(lives, kLimit);
    CHECK(c.lining.lives == 60);
    CHECK(c.lining.slope == Approx(kSlope).margin(3.0 * kSlopeScatter / std::sqrt(60.0)));
    CHECK(std::sqrt(c.lining.variance) == Approx(kSlopeScatter).epsilon(0.3));
    CHECK(c.lining.error == Approx(kReadingError).epsilon(0.1));
    // 0.8 of the slope's scatter is that of the offset.
    CHECK(c.lining.with_curve.at(5) == Approx(0.8 * kSlopeScatter * kOffset).epsilon(0.5));
    // One reading a life, or readings of four lives, do not say how readings err.
    std::vector<wear::Campaign> few(lives.begin(), lives.begin() + 20);
    for (wear::Campaign& life : few) life.readings = {life.readings.back()};
    CHECK(wear::learn_life_curves(few, kLimit).lining == wear::LiningWear{});
    for (std::size_t k = 0; k < 4; ++k) few[k].readings = lives[k].readings;
    CHECK(wear::learn_life_curves(few, kLimit).lining == wear::LiningWear{});
    // What friction says is what it says without readings.
    std::vector<wear::Campaign> bare = lives;
    for (wear::Campaign& life : bare) life.readings.clear();
    const wear::LifeCurves friction_only = wear::learn_life_curves(bare, kLimit);
    CHECK(friction_only.lining == wear::LiningWear{});
    CHECK(c.fresh == Approx(friction_only.fresh).epsilon(0.01));
    for (std::size_t k = 0; k < wear::kCurve; ++k) CHECK(c.mean.at(k) == Approx(friction_only.mean.at(k)).margin(5e-4));
}

TEST_CASE("a friction and a reading are jointly normal", "[WEAR-074]") {
    wear::LifeCurves c = learnt();
    c.remembered = 0.0;
    c.lining = {.lives = 30, .slope = 0.95, .by_life = 0.01, .with_curve = {}, .variance = 0.0016, .error = 0.02};
    c.lining.with_curve.at(0) = 0.7 * std::sqrt(c.covariance.at(0).at(0) * c.lining.variance);
    const double life_J = 140e6, deviations = (std::log(life_J) - c.log_life) / c.log_life_deviation, share = 0.3;
    wear::LifeFilter filter = wear::LifeFilter::of_life(c, life_J);
    const double friction = c.mean.at(0) + deviations * c.by_life.at(0) + 0.004, worn = 0.31;
    filter.learn({share * life_J, friction});
    filter.read({share * life_J, worn});
    // Of the reading given the friction, by the formula of the bivariate normal.
    const double cross = share * c.lining.with_curve.at(0), of_friction = c.covariance.at(0).at(0) + c.fresh * c.fresh;
    const double variance = share * share * c.lining.variance + c.lining.error * c.lining.error - cross * cross / of_friction;
    const double off = worn - share * (0.95 + deviations * 0.01) - cross / of_friction * 0.004;
    CHECK(filter.hypotheses()[0].log_readings == Approx(-0.5 * (off * off / variance + std::log(variance))).epsilon(1e-9));
    // And the curve has moved with the reading.
    const double slope_variance = c.lining.variance - std::pow(c.lining.with_curve.at(0), 2) / of_friction;
    const double curve_slope = c.lining.with_curve.at(0) * (1.0 - c.covariance.at(0).at(0) / of_friction);
    const double gain = share * curve_slope / (share * share * slope_variance + c.lining.error * c.lining.error);
    CHECK(filter.hypotheses()[0].state.at(0) == Approx(friction - 0.004 + c.covariance.at(0).at(0) / of_friction * 0.004 + gain * off).epsilon(1e-9));
}

TEST_CASE("readings of the lining tell lives apart that friction does not; without learnt ones they say nothing", "[WEAR-074][figures]") {
    std::vector<wear::Campaign> lives;
    for (std::uint64_t seed = 0; seed < 60; ++seed) lives.push_back(read_brake(seed).campaign);
    const wear::LifeCurves c = wear::learn_life_curves(lives, kLimit);
    double held = 0.0, width_J = 0.0, width_by_friction_J = 0.0;
    constexpr int kBrakes = 100;
    for (std::uint64_t seed = 5000; seed < 5000 + kBrakes; ++seed) {
        const Known b = read_brake(seed);
        wear::LifeFilter read(c), by_friction(c);
        const std::size_t half = b.campaign.points.size() / 2;
        for (std::size_t i = 0; i < half; ++i) {
            read.learn(b.campaign.points[i]);
            by_friction.learn(b.campaign.points[i]);
        }
        for (const wear::LiningReading& r : b.campaign.readings)
            if (r.c_e_J <= b.campaign.points[half - 1].c_e_J) read.read(r);
        const std::vector<double> lives_J = read.lives_J(100), wide_J = by_friction.lives_J(100);
        held += b.life_J >= lives_J[9] && b.life_J <= lives_J[90] ? 1.0 / kBrakes : 0.0;
        width_J += lives_J[90] - lives_J[9];
        width_by_friction_J += wide_J[90] - wide_J[9];
    }
    CHECK(held == Approx(0.81).margin(0.12));  // standard error 0.04, and 60 lives learnt from
    CHECK(width_J < 0.6 * width_by_friction_J);
    wear::LifeFilter untold(learnt()), same(learnt());
    untold.learn({1e6, 0.26});
    same.learn({1e6, 0.26});
    untold.read({1e6, 0.5});
    CHECK(untold.lives_J(100) == same.lives_J(100));
}

TEST_CASE("the likelihood of readings integrates over the slope", "[WEAR-074]") {
    wear::LifeCurves c;
    c.log_life = std::log(150e6);
    c.log_life_deviation = 0.1;
    c.lining = {.lives = 30, .slope = 0.95, .by_life = 0.02, .with_curve = {}, .variance = 0.0019, .error = 0.02};
    wear::LiningLikelihood lining(c, 0.09);
    const double deviation = std::sqrt(0.0019 + std::pow(0.09 * 0.95, 2));
    CHECK_FALSE(lining.any());
    const wear::LiningReading readings[] = {{20e6, 0.12}, {50e6, 0.36}, {70e6, 0.44}};
    for (const wear::LiningReading& r : readings) lining.read(r);
    const auto by_sum = [&](double life_J) {
        double sum = 0.0;
        constexpr double kStep = 1e-4;
        for (double slope = 0.0; slope < 2.0; slope += kStep) {
            double log_p = -0.5 * std::pow((slope - 0.95 - 0.02 * std::log(life_J / 150e6) / 0.1) / deviation, 2);
            for (const wear::LiningReading& r : readings) log_p -= 0.5 * std::pow((r.worn - slope * r.c_e_J / life_J) / 0.02, 2);
            sum += kStep * std::exp(log_p);
        }
        return std::log(sum);
    };
    for (const double life_J : {120e6, 140e6, 180e6})
        CHECK(lining.log_likelihood(life_J) - lining.log_likelihood(150e6) == Approx(by_sum(life_J) - by_sum(150e6)).epsilon(1e-6));
    // Of lives that are spread evenly, those that fit the readings.
    std::vector<double> lives_J;
    for (int i = 0; i <= 2000; ++i) lives_J.push_back(100e6 + 0.05e6 * i);
    const std::vector<double> given = lining.given(lives_J, 200);
    CHECK(std::is_sorted(given.begin(), given.end()));
    double sum = 0.0, below = 0.0;
    for (const double life_J : lives_J) {
        const double p = std::exp(lining.log_likelihood(life_J) - lining.log_likelihood(150e6));
        sum += p;
        below += life_J < given[49] ? p : 0.0;
    }
    CHECK(below / sum == Approx(0.2475).margin(0.003));
}

TEST_CASE("before any reading lives are those of Student's t", "[WEAR-073]") {
    const wear::LifeCurves& c = learnt();
    const std::vector<double> before = wear::LifeFilter(c).lives_J(1000);
    // Student's t with 29 degrees of freedom: 90 % are below 1.311.
    CHECK(std::log(before[899]) ==
          Approx(c.log_life + 1.311 * c.log_life_deviation * std::sqrt(1.0 + 1.0 / 30.0)).margin(0.01 * c.log_life_deviation));
    CHECK(std::is_sorted(before.begin(), before.end()));
}

TEST_CASE("by the curves of the process itself 80 % of lives are in the interval from 10 to 90 %", "[WEAR-073]") {
    wear::LifeCurves c;
    c.lives = 1000;
    c.landing_J = 1e6;
    c.log_life = std::log(1e6 * kLandings);
    c.log_life_deviation = kLifeScatter;
    c.energy = {kHot};
    c.fresh = kFresh;
    const auto offset = [](double share) { return share < 0.6 ? 1.0 : (1.0 - share) / 0.4; };
    for (std::size_t k = 0; k < wear::kCurve; ++k) {
        c.mean.at(k) = curve(wear::kLifeKnots.at(k), 0.0);
        for (std::size_t j = 0; j < wear::kCurve; ++j)
            c.covariance.at(k).at(j) = kOffset * kOffset * offset(wear::kLifeKnots.at(k)) * offset(wear::kLifeKnots.at(j));
    }
    double held_half = 0.0, held_late = 0.0, width_half_J = 0.0, width_late_J = 0.0;
    constexpr int kBrakes = 150;
    for (std::uint64_t seed = 1000; seed < 1000 + kBrakes; ++seed) {
        const Known b = brake(seed);
        wear::LifeFilter filter(c, 641);  // late in life the end is known to less than a step of the usual grid
        const std::size_t half = b.campaign.points.size() / 2, late = b.campaign.points.size() * 9 / 10;
        for (std::size_t i = 0; i <= late; ++i) {
            if (i == half || i == late) {
                const std::vector<double> lives_J = filter.lives_J(100);
                const double held = b.life_J >= lives_J[9] && b.life_J <= lives_J[90] ? 1.0 / kBrakes : 0.0;
                (i == late ? held_late : held_half) += held;
                (i == late ? width_late_J : width_half_J) += (lives_J[90] - lives_J[9]) / kBrakes;
            }
            filter.learn(b.campaign.points[i]);
        }
    }
    // Values 9 and 90 of 100 are those of 9.5 and 90.5 %. Standard error of a share of 150: 0.032.
    CHECK(held_half == Approx(0.81).margin(0.08));
    CHECK(held_late == Approx(0.81).margin(0.08));
    CHECK(width_late_J < 0.3 * width_half_J);
}

TEST_CASE("another limit is crossed where the brake's own curve crosses it", "[WEAR-073]") {
    wear::LifeCurves c = learnt();
    wear::LifeFilter filter(c);
    const Known b = brake(2000);
    for (std::size_t i = 0; i < b.campaign.points.size() * 8 / 10; ++i) filter.learn(b.campaign.points[i]);
    const std::vector<double> lives = filter.ends_J(kLimit, 200, 1), sooner = filter.ends_J(0.22, 200, 1), never = filter.ends_J(0.02, 200, 1);
    CHECK(lives == filter.lives_J(200));
    CHECK(std::is_sorted(sooner.begin(), sooner.end()));
    CHECK(filter.ends_J(0.22, 200, 1) == sooner);
    wear::Generator generator = wear::generator_of(2000, 77);
    (void)wear::normal(generator);
    const double offset = kOffset * wear::normal(generator);
    const double truth_J = b.life_J * (0.6 + 0.4 * (0.248 + offset - 0.22) / (0.048 + offset));
    CHECK(sooner[100] == Approx(truth_J).epsilon(0.03));
    CHECK(std::isinf(never.back()));
}

TEST_CASE("a glaze is told from an early end of life", "[WEAR-060][WEAR-073]") {
    const double limit = std::log(100.0 * kLandings / wear::GlazingWatch::kEvery * wear::GlazingWatch::kSizes.size());
    int false_alarms = 0, found = 0;
    constexpr int kBrakes = 40;
    for (std::uint64_t seed = 3000; seed < 3000 + kBrakes; ++seed) {
        const Known b = brake(seed);
        wear::GlazingWatch healthy(learnt()), glazed(learnt());
        bool alarm = false, soon = false;
        constexpr std::size_t kBegin = 30;
        for (std::size_t i = 0; i < b.campaign.points.size(); ++i) {
            wear::Point p = b.campaign.points[i];
            alarm = alarm || healthy.after(p) > limit;
            if (i >= kBegin) p.mean_friction *= 1.0 - 0.1 * std::min(1.0, static_cast<double>(i - kBegin + 1) / 40.0);
            if (i < kBegin + 25) soon = glazed.after(p) > limit || soon;
        }
        false_alarms += alarm ? 1 : 0;
        found += soon ? 1 : 0;
    }
    // A likelihood ratio exceeds c with a probability of at most 1 / c where the model is true: 1 % over all supposed begins.
    CHECK(false_alarms <= 2);
    CHECK(found >= 34);
}

TEST_CASE("who is told the law finds life and level of a brake", "[WEAR-070]") {
    using namespace wear::arena;
    const Settings settings = load_settings("config/wear_arena.toml");
    double held = 0.0;
    constexpr int kBrakes = 20;
    for (std::uint64_t seed = 0; seed < kBrakes; ++seed) {
        const Life life = live(Law::archard, settings, seed);
        LawFilter filter(Law::archard, settings, seed);
        for (std::size_t i = 0; i < life.landings() * 8 / 10; ++i) filter.learn(life.campaign.points[i]);
        const double truth = life.before[life.landings() * 8 / 10].expected();
        CHECK(filter.expected().mean == Approx(truth).margin(0.003));
        CHECK(filter.expected().deviation >= Brake::kFresh);
        std::vector<double> lives_J;
        for (const Brake& b : filter.drawn(200)) lives_J.push_back(b.life_J());
        std::sort(lives_J.begin(), lives_J.end());
        const double own_J = life.before.front().life_J();
        CHECK(own_J == Approx(lives_J[100]).epsilon(0.05));
        held += own_J >= lives_J[20] && own_J <= lives_J[179] ? 1.0 / kBrakes : 0.0;
    }
    CHECK(held > 0.5);  // 0.8; of 20, standard error 0.09
}
