#include "plant_sim/study/identification/friction_fit.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <stdexcept>
#include <utility>

#include "plant_sim/study/identification/friction_readings.hpp"

namespace identification {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

using Readings = std::vector<FrictionReadings>;

/// A family of curves, and where its fit begins.
struct Shape {
    std::vector<std::string> names;
    rig::Surface (*curve)(const VectorXd& theta);
    LeastSquares problem;
};

rig::Surface burckhardt(const VectorXd& theta) {
    return {.name = {}, .c1 = theta[0], .c2 = theta[1], .c3 = theta[2]};
}

rig::Surface magic(const VectorXd& theta) {
    return {.name = {}, .magic = rig::MagicFormula{.B = theta[0], .C = theta[1], .D = theta[2], .E = theta[3]}};
}

Shape eq_4(const Readings& runs) {
    double max_mu = 0.0;
    double at_slip = 0.1;
    for (const FrictionReadings& run : runs) {
        for (const FrictionReading& r : run.all()) {
            if (r.mu <= max_mu) continue;
            max_mu = r.mu;
            at_slip = r.slip;
        }
    }
    LeastSquares p;
    p.start = Eigen::Vector3d(1.1 * max_mu, 4.0 / std::max(at_slip, 0.01), 0.3 * max_mu);
    p.scale = Eigen::Vector3d(0.1 * max_mu, 0.1 * p.start[1], 0.1 * max_mu);
    p.min = Eigen::Vector3d(1e-3, 1.0, -1.0);
    p.max = Eigen::Vector3d(3.0, 1000.0, 3.0);
    p.whitened = true;
    return {.names = {"c1", "c2", "c3"}, .curve = burckhardt, .problem = p};
}

/// Begins at the peak of the curve that was fitted.
Shape magic_formula(const rig::Surface& fitted, double C, double E) {
    const rig::Peak peak = rig::peak(fitted);
    const rig::MagicFormula start = rig::magic_formula_with_peak(std::clamp(peak.slip, 0.01, 0.5), peak.mu, C, E);
    LeastSquares p;
    p.start = Eigen::Vector4d(start.B, start.C, start.D, start.E);
    p.scale = Eigen::Vector4d(0.1 * p.start[0], 0.1, 0.1 * peak.mu, 0.3);
    p.min = Eigen::Vector4d(0.5, 1.02, 1e-3, -10.0);
    p.max = Eigen::Vector4d(1000.0, 1.98, 3.0, 0.99);
    p.whitened = true;
    return {.names = {"B", "C", "D", "E"}, .curve = magic, .problem = p};
}

/// Readings of one run, weighted so that their errors about a curve are white.
class Weighted {
  public:
    Weighted(const FrictionReadings& run, const rig::Surface& about, double force_noise_N) : readings_(run.all()) {
        const ReadingCovariance v = run.covariance(about, force_noise_N);
        deviation_ = (v.own.diagonal() + v.common.cwiseAbs2()).cwiseSqrt();
        own_.compute(v.own);
        common_ = own_.matrixL().solve(v.common);
        const double square = common_.squaredNorm();
        shrink_ = square > 0.0 ? (1.0 - 1.0 / std::sqrt(1.0 + square)) / square : 0.0;
    }

    [[nodiscard]] const std::vector<FrictionReading>& readings() const { return readings_; }
    [[nodiscard]] const VectorXd& deviation() const { return deviation_; }

    /// (I + a a')^(-1/2) L^-1 (mu - curve), with L L' the readings' own covariance and a = L^-1 common.
    void residuals(const rig::Surface& s, Eigen::Ref<VectorXd> out) const {
        VectorXd error(out.size());
        for (Index i = 0; i < out.size(); ++i) {
            const FrictionReading& r = readings_[static_cast<std::size_t>(i)];
            error[i] = r.mu - rig::friction(s, r.slip).mu;
        }
        own_.matrixL().solveInPlace(error);
        out = error - shrink_ * common_.dot(error) * common_;
    }

  private:
    using Own = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>;

    const std::vector<FrictionReading>& readings_;
    VectorXd deviation_;
    Own own_;
    VectorXd common_;
    double shrink_ = 0.0;
};

struct Fitted {
    Shape shape;
    Fit fit;
    std::deque<Weighted> weighted;  ///< about `curve`

    [[nodiscard]] rig::Surface curve() const { return shape.curve(fit.theta); }
};

Fitted fitted(Shape shape, const Readings& runs, double noise_N) {
    Fitted out{.shape = std::move(shape), .fit = {}, .weighted = {}};
    LeastSquares& min = out.shape.problem;
    Index count = 0;
    for (const FrictionReadings& run : runs) count += static_cast<Index>(run.all().size());
    // The weights depend on the curve, so both are iterated.
    for (int round = 0; round < 4; ++round) {
        out.weighted.clear();
        for (const FrictionReadings& run : runs) out.weighted.emplace_back(run, out.shape.curve(min.start), noise_N);
        out.fit = fit(min, out.shape.names, [&](const VectorXd& theta, VectorXd& residuals) {
            residuals.resize(count);
            Index row = 0;
            for (const Weighted& w : out.weighted) {
                const auto n = static_cast<Index>(w.readings().size());
                w.residuals(out.shape.curve(theta), residuals.segment(row, n));
                row += n;
            }
        });
        min.start = out.fit.theta;
    }
    return out;
}

/// B, C and E can make up for each other over much of the curve: a fit from one start may end in a valley beside the best.
std::optional<Fitted> with_magic_formula(const rig::Surface& begin, const Readings& runs, double noise_N) {
    std::optional<Fitted> best;
    for (const double C : {1.2, 1.4, 1.6, 1.8}) {
        for (const double E : {-0.5, 0.5}) {
            try {
                Fitted next = fitted(magic_formula(begin, C, E), runs, noise_N);
                if (!best || next.fit.rms < best->fit.rms) best = std::move(next);
            } catch (const NotIdentifiable&) {
            }
        }
    }
    return best;
}

/// Eq. (4), unless the magic formula leaves clearly less, or eq. (4) leaves a locked wheel no friction.
Fitted better(const Readings& runs, double noise_N) {
    Fitted plain = fitted(eq_4(runs), runs, noise_N);
    std::optional<Fitted> other = with_magic_formula(plain.curve(), runs, noise_N);
    // Readings of one stop are correlated, so that a few per cent are no evidence for a fourth coefficient.
    constexpr double kClearly = 0.9;
    const bool locks = plain.fit.theta[2] < plain.fit.theta[0];
    if (other && (!locks || other->fit.rms < kClearly * plain.fit.rms)) return std::move(*other);
    return plain;
}

/// Whether slip ranges from low to beyond the peak, which tells the coefficients apart.
void check_range(const FrictionFit& f) {
    const rig::Peak peak = rig::peak(f.curve);
    const bool eq_4 = !f.curve.magic;
    if (f.largest_slip < 1.1 * peak.slip || (eq_4 && f.of("c3").high - f.of("c3").low > f.of("c1").value)) {
        throw NotIdentifiable(
            fmt::format("{}: slip is held up to {:.3f} only, {}: the coefficients cannot be told apart; expected a landing that is recorded from "
                        "before touchdown, with a slip reference beyond the peak (config/scenarios/heavy.toml)",
                        f.surface, f.largest_slip,
                        std::isfinite(peak.slip) ? fmt::format("the friction's peak lies near {:.3f}", peak.slip) : "where friction still rises"));
    }
    constexpr double kWorst = 0.3;
    const Coefficient& rise = f.coefficients[eq_4 ? 1 : 0];
    if (rise.estimate.high - rise.estimate.low > kWorst * rise.estimate.value) {
        throw NotIdentifiable(fmt::format("{}: {} is {:.3g} to {:.3g}, {}", f.surface, rise.name, rise.estimate.low, rise.estimate.high,
                                          f.misfit > kMaxMisfit
                                              ? "since the readings fit neither eq. (4) nor a magic formula; expected recordings of one road"
                                              : "which says nothing of low slip; expected a landing under a current that rises slowly "
                                                "(config/scenarios/slow_braking.toml)"));
    }
}

}  // namespace

const Estimate& FrictionFit::of(std::string_view name) const {
    for (const Coefficient& c : coefficients)
        if (c.name == name) return c.estimate;
    throw std::out_of_range(surface + " has no coefficient " + std::string(name));
}

FrictionFit fit_friction(std::span<const Run> runs, const std::string& surface) {
    const double age_s = cell_age_s(runs);
    Readings seen;
    std::size_t count = 0;
    for (const Run& run : runs) {
        if (run.surface != surface) continue;
        auto readings = FrictionReadings::of(run, age_s);
        if (!readings || readings->all().empty()) continue;
        count += readings->all().size();
        seen.push_back(std::move(*readings));
    }
    if (count < 50) {
        throw NotIdentifiable(
            fmt::format("{}: only {} readings of the load cells while braking above {:.0f} m/s; a friction curve needs landings "
                        "(config/scenarios/slow_braking.toml for low slip, heavy.toml for slip beyond the peak)",
                        surface, count, FrictionReadings::kSlowest_mps));
    }
    const Fitted found = better(seen, force_noise_N(seen));
    FrictionFit out;
    out.surface = surface;
    for (std::size_t i = 0; i < found.shape.names.size(); ++i)
        out.coefficients.push_back({found.shape.names[i], found.fit.estimate(static_cast<Index>(i))});
    out.curve = found.curve();
    out.curve.name = surface;
    out.misfit = found.fit.rms;
    out.lags_s = found.fit.lags * FrictionReadings::kWindow_s;
    double sum = 0.0;
    double held = 0.0;
    for (const Weighted& w : found.weighted) {
        for (std::size_t i = 0; i < w.readings().size(); ++i) {
            const FrictionReading& r = w.readings()[i];
            out.slip.push_back(r.slip);
            out.mu.push_back(r.mu);
            out.deviation.push_back(w.deviation()[static_cast<Index>(i)]);
            if (!r.held) continue;
            out.largest_slip = std::max(out.largest_slip, r.slip);
            const double error = r.mu - rig::friction(out.curve, r.slip).mu;
            sum += error * error;
            held += 1.0;
        }
    }
    out.rms = held > 0.0 ? std::sqrt(sum / held) : 0.0;
    check_range(out);
    return out;
}

}  // namespace identification
