#include "plant_sim/study/identification/wheel_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "plant_sim/study/identification/wheel_balance.hpp"

namespace identification {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kMinStop_mps = 20.0;  // a stop from a lower speed does not show friction over speed
constexpr double kContactStart_MPa = 0.5, kMaxContact_MPa = 10.0;
constexpr double kPistonStart = 0.02, kMaxPiston = 0.5;
constexpr double kSurely = 25.0;  // decrease of the sum of squares for a parameter, in squares of the residuals' deviation: five deviations of it

/// Adds an independent error to the one shown by the residuals.
Estimate with_error(const Estimate& e, double deviation) {
    const double factor = std::hypot(e.deviation, deviation) / e.deviation;
    return {.value = e.value,
            .deviation = e.deviation * factor,
            .low = e.value - (e.value - e.low) * factor,
            .high = e.value + (e.high - e.value) * factor};
}

struct Candidate {
    WheelBalance balance;
    Fit fit;
    [[nodiscard]] double square() const { return fit.residuals.squaredNorm(); }
    /// Whether all that was sought is above 0 beyond doubt.
    [[nodiscard]] bool shown() const {
        for (Index i = balance.contact(); i < balance.common(); ++i)
            if (!(fit.estimate(i).low > 0.0)) return false;
        return true;
    }
};

Candidate candidate(const std::vector<WheelSegment>& segments, const Sought& sought) {
    WheelBalance balance(segments, sought);
    const Index n = balance.parameters();
    LeastSquares min;
    min.start = VectorXd::Zero(n);
    min.start[0] = 1.0;
    min.start[1] = 0.3;
    min.scale = VectorXd::Constant(n, 10.0);
    min.scale.head(balance.common()).setConstant(0.1);
    min.min = VectorXd::Constant(n, -1e9);
    min.max = VectorXd::Constant(n, 1e9);
    std::vector<std::string> names{"the wheel's inertia"};
    names.resize(static_cast<std::size_t>(balance.contact()), "the brake's friction over speed");
    if (sought.contact) {
        names.emplace_back("the pressure at which the discs touch");
        min.start[balance.contact()] = kContactStart_MPa;
        min.min[balance.contact()] = 0.0;
        min.max[balance.contact()] = kMaxContact_MPa;
    }
    if (sought.piston_friction) {
        names.emplace_back("the friction of its pistons");
        min.start[balance.piston_friction()] = kPistonStart;
        min.min[balance.piston_friction()] = 0.0;
        min.max[balance.piston_friction()] = kMaxPiston;
    }
    names.resize(static_cast<std::size_t>(n), "the rim's drag before touchdown");
    Fit found = fit(min, names, [&balance](const VectorXd& theta, VectorXd& r) { balance.residuals(theta, r); });
    VectorXd last;
    balance.residuals(found.theta, last);
    return {std::move(balance), std::move(found)};
}

/// A parameter more than the brake has would widen the intervals of the others: each must explain more than chance would.
Candidate best_candidate(const std::vector<WheelSegment>& segments) {
    Candidate best = candidate(segments, {});
    if (best.fit.rms <= 1.0) return best;  // errors of the sensors explain all
    constexpr std::array<Sought, 3> kMore{{{.contact = true}, {.piston_friction = true}, {.contact = true, .piston_friction = true}}};
    for (const Sought& sought : kMore) {
        try {
            Candidate next = candidate(segments, sought);
            const double more = static_cast<double>(next.balance.common() - best.balance.common());
            const double unit = std::max(next.square() / static_cast<double>(next.balance.windows()), 1.0);
            if (next.shown() && next.square() + kSurely * unit * more < best.square()) best = std::move(next);
        } catch (const NotIdentifiable&) {  // these recordings do not tell it from the friction over speed
            continue;
        }
    }
    return best;
}

}  // namespace

WheelFit fit_wheel(std::span<const Run> runs, const std::string& friction_class) {
    for (const Run& run : runs) check(run.recording);
    std::vector<WheelSegment> segments;
    int stops = 0;
    double radius_variance = 0.0;  // relative, of the stops' sum
    const double age_s = cell_age_s(runs);
    for (const Run& run : runs) {
        const auto motion = Motion::of(run, age_s);
        if (!motion) continue;
        const bool braking = run.friction_class == friction_class && motion->brake_on_mps() >= kMinStop_mps;
        WheelSegment s = wheel_segment(run, *motion, braking);
        if (s.windows.empty()) continue;
        if (braking) {
            ++stops;
            radius_variance += s.radius_share * s.radius_share;
        }
        segments.push_back(std::move(s));
    }
    if (stops == 0) {
        throw NotIdentifiable(
            fmt::format("no stop of friction class '{}' from {:.0f} m/s or more: k_b needs a landing (config/scenarios/heavy.toml, "
                        "slow_braking.toml), J_w its touchdown",
                        friction_class, kMinStop_mps));
    }
    const auto [balance, found] = best_candidate(segments);
    const Index n = balance.parameters();

    WheelFit out;
    out.inertia_kgm2 = found.estimate(0);
    VectorXd mean = VectorXd::Zero(n);
    for (std::size_t k = 0; k < kFrictionPowers; ++k) mean[1 + static_cast<Index>(k)] = 1.0 / static_cast<double>(k + 1);
    // An error of the radius gives the same relative error of the flywheel's torque and of k_b; no residual shows it.
    const Estimate shown = found.combination(mean);
    const double mu = shown.value;
    out.friction = with_error(shown, mu * std::sqrt(radius_variance) / stops);
    for (std::size_t k = 0; k < kFrictionPowers; ++k) {
        const Index i = 1 + static_cast<Index>(k);
        const VectorXd gradient = (VectorXd::Unit(n, i) - found.theta[i] / mu * mean) / mu;
        Estimate e = found.combination(gradient);
        const double shift = found.theta[i] / mu - e.value;  // of a quotient, about its value
        e.value += shift;
        e.low += shift;
        e.high += shift;
        out.relative_friction[k] = e;
    }
    if (balance.sought().contact) out.contact_Pa = scaled(found.estimate(balance.contact()), 1e6);
    if (balance.sought().piston_friction) out.piston_friction = found.estimate(balance.piston_friction());
    out.gain_m3 = scaled(out.friction, runs.front().rig.brake_gain_m3);
    out.friction_class = friction_class;
    out.misfit = found.rms;
    out.lags_s = found.lags * kSpeedWindow_s;
    out.residuals = balance.report(found.theta);
    if (!(out.inertia_kgm2.low > 0.0)) {
        throw NotIdentifiable(
            fmt::format("the wheel's inertia is {:.3g} to {:.3g} kg m2, which says nothing: expected recordings that begin before touchdown with the "
                        "wheel at rest",
                        out.inertia_kgm2.low, out.inertia_kgm2.high));
    }
    return out;
}

}  // namespace identification
