#include "plant_sim/study/identification/friction_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace identification {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kWindow_s = 0.01;
constexpr double kSlowest_mps = 10.0;  // below, a window holds too few edges
constexpr double kOff_s = 1e-3;        // what a reading's instant may be off after its age is taken away
constexpr double kLeastSlip = 0.003;
constexpr double kSlowSlip = 0.002;  // change over a window below which slip counts as held

struct Reading {
    double slip, mu;
    double slip_deviation;
    bool held;
};

void add_readings(const Run& run, double age_s, std::vector<Reading>& readings) {
    const auto motion = Motion::of(run, age_s);
    if (!motion) return;
    // Ways over a window, both shafts, jitter at both ends.
    const double jitter = 2.0 * run.rig.edge_jitter_s / kWindow_s;
    const double half = 0.5 * kWindow_s;
    for (const Motion::CellReading& c : motion->cells()) {
        const double t = c.time_s;
        if (t < motion->brake_on_s() || t + 3.0 * half > motion->end_s() || !(c.vertical_N > 0.0)) continue;
        if (motion->v_mps(t - half, t + half) < kSlowest_mps) break;
        const double slip = motion->slip(t - half, t + half);
        const double change = motion->slip(t, t + kWindow_s) - motion->slip(t - kWindow_s, t);
        if (slip < kLeastSlip) continue;
        const double moved = change / kWindow_s * kOff_s;
        readings.push_back({.slip = slip,
                            .mu = c.longitudinal_N / c.vertical_N,
                            .slip_deviation = std::hypot((1.0 - slip) * jitter, moved),
                            .held = std::abs(change) < kSlowSlip});
    }
}

/// Noise of mu: readings next to each other at held slip, second differences.
double mu_noise(const std::vector<Reading>& readings) {
    std::vector<double> differences;
    for (std::size_t i = 1; i + 1 < readings.size(); ++i) {
        if (readings[i - 1].held && readings[i].held && readings[i + 1].held)
            differences.push_back(std::abs(readings[i - 1].mu - 2.0 * readings[i].mu + readings[i + 1].mu));
    }
    constexpr double kUnknown = 0.01;
    if (differences.size() < 20) return kUnknown;
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::nth_element(differences.begin(), middle, differences.end());
    constexpr double kMedianOfNormal = 0.6745;
    constexpr double kLeast = 1e-4;
    return std::max(*middle / kMedianOfNormal / std::sqrt(6.0), kLeast);
}

plant::Surface curve(const VectorXd& theta) {
    return {.name = {}, .c1 = theta[0], .c2 = theta[1], .c3 = theta[2]};
}

LeastSquares problem(const std::vector<Reading>& readings) {
    double most_mu = 0.0;
    double at_slip = 0.1;
    for (const Reading& r : readings) {
        if (r.mu <= most_mu) continue;
        most_mu = r.mu;
        at_slip = r.slip;
    }
    LeastSquares p;
    p.start = Eigen::Vector3d(1.1 * most_mu, 4.0 / std::max(at_slip, 0.01), 0.3 * most_mu);
    p.scale = Eigen::Vector3d(0.1 * most_mu, 0.1 * p.start[1], 0.1 * most_mu);
    p.least = Eigen::Vector3d(1e-3, 1.0, -1.0);
    p.most = Eigen::Vector3d(3.0, 1000.0, 3.0);
    return p;
}

}  // namespace

FrictionFit fit_friction(std::span<const Run> runs, const std::string& surface) {
    const double age_s = cell_age_s(runs);
    std::vector<Reading> readings;
    for (const Run& run : runs) {
        if (run.surface == surface) add_readings(run, age_s, readings);
    }
    if (readings.size() < 50) {
        throw NotIdentifiable(fmt::format(
            "{}: only {} readings of the load cells while braking above {:.0f} m/s; Burckhardt's "
            "coefficients need landings "
            "(config/scenarios/slow_braking.toml for low slip, heavy.toml for slip beyond the peak)",
            surface, readings.size(), kSlowest_mps));
    }
    const double noise = mu_noise(readings);
    LeastSquares least = problem(readings);
    VectorXd per_deviation = VectorXd::Constant(static_cast<Index>(readings.size()), 1.0 / noise);
    const std::vector<std::string> names{"c1", "c2", "c3"};
    Fit found;
    for (int round = 0; round < 4; ++round) {
        found = fit(least, names, [&](const VectorXd& theta, VectorXd& out) {
            out.resize(per_deviation.size());
            const plant::Surface s = curve(theta);
            for (std::size_t i = 0; i < readings.size(); ++i) {
                const auto row = static_cast<Index>(i);
                out[row] = (readings[i].mu - plant::friction(s, readings[i].slip).mu) * per_deviation[row];
            }
        });
        least.start = found.theta;
        const plant::Surface s = curve(found.theta);
        for (std::size_t i = 0; i < readings.size(); ++i) {
            const double by_slip = plant::friction(s, readings[i].slip).mu_1 * readings[i].slip_deviation;
            per_deviation[static_cast<Index>(i)] = 1.0 / std::hypot(noise, by_slip);
        }
    }
    FrictionFit out;
    out.surface = surface;
    out.c1 = found.estimate(0);
    out.c2 = found.estimate(1);
    out.c3 = found.estimate(2);
    out.lags_s = found.lags * kWindow_s;
    const plant::Surface s = curve(found.theta);
    double sum = 0.0;
    double held = 0.0;
    for (std::size_t i = 0; i < readings.size(); ++i) {
        const Reading& r = readings[i];
        out.slip.push_back(r.slip);
        out.mu.push_back(r.mu);
        out.deviation.push_back(1.0 / per_deviation[static_cast<Index>(i)]);
        if (!r.held) continue;
        out.largest_slip = std::max(out.largest_slip, r.slip);
        const double error = r.mu - plant::friction(s, r.slip).mu;
        sum += error * error;
        held += 1.0;
    }
    out.rms = held > 0.0 ? std::sqrt(sum / held) : 0.0;
    const plant::Peak peak = plant::peak(s);
    if (out.largest_slip < 1.1 * peak.slip || out.c3.high - out.c3.low > out.c1.value) {
        throw NotIdentifiable(fmt::format(
            "{}: slip is held up to {:.3f} only, the friction's peak lies near {:.3f}: c1 and c3 cannot be "
            "told apart; "
            "expected a landing with a slip reference beyond the peak (config/scenarios/heavy.toml)",
            surface, out.largest_slip, peak.slip));
    }
    constexpr double kWorst = 0.3;
    if (out.c2.high - out.c2.low > kWorst * out.c2.value) {
        throw NotIdentifiable(
            fmt::format("{}: c2 is {:.3g} to {:.3g}, which says nothing of low slip; expected a landing "
                        "under a current that rises slowly "
                        "(config/scenarios/slow_braking.toml)",
                        surface, out.c2.low, out.c2.high));
    }
    return out;
}

}  // namespace identification
