#include "plant_sim/study/identification/friction_fit.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "plant_sim/study/identification/friction_readings.hpp"

namespace identification {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

rig::Surface curve(const VectorXd& theta) {
    return {.name = {}, .c1 = theta[0], .c2 = theta[1], .c3 = theta[2]};
}

LeastSquares problem(const std::vector<FrictionReadings>& runs) {
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
    return p;
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

}  // namespace

FrictionFit fit_friction(std::span<const Run> runs, const std::string& surface) {
    const double age_s = cell_age_s(runs);
    std::vector<FrictionReadings> seen;
    Index count = 0;
    for (const Run& run : runs) {
        if (run.surface != surface) continue;
        auto readings = FrictionReadings::of(run, age_s);
        if (!readings || readings->all().empty()) continue;
        count += static_cast<Index>(readings->all().size());
        seen.push_back(std::move(*readings));
    }
    if (count < 50) {
        throw NotIdentifiable(
            fmt::format("{}: only {} readings of the load cells while braking above {:.0f} m/s; Burckhardt's coefficients need landings "
                        "(config/scenarios/slow_braking.toml for low slip, heavy.toml for slip beyond the peak)",
                        surface, count, FrictionReadings::kSlowest_mps));
    }
    const double noise_N = force_noise_N(seen);
    LeastSquares min = problem(seen);
    const std::vector<std::string> names{"c1", "c2", "c3"};
    std::deque<Weighted> weighted;
    Fit found;
    // The weights depend on the curve, so both are iterated.
    for (int round = 0; round < 4; ++round) {
        weighted.clear();
        for (const FrictionReadings& run : seen) weighted.emplace_back(run, curve(min.start), noise_N);
        found = fit(min, names, [&](const VectorXd& theta, VectorXd& out) {
            out.resize(count);
            Index row = 0;
            for (const Weighted& w : weighted) {
                const auto n = static_cast<Index>(w.readings().size());
                w.residuals(curve(theta), out.segment(row, n));
                row += n;
            }
        });
        min.start = found.theta;
    }
    FrictionFit out;
    out.surface = surface;
    out.c1 = found.estimate(0);
    out.c2 = found.estimate(1);
    out.c3 = found.estimate(2);
    out.lags_s = found.lags * FrictionReadings::kWindow_s;
    const rig::Surface s = curve(found.theta);
    double sum = 0.0;
    double held = 0.0;
    for (const Weighted& w : weighted) {
        for (std::size_t i = 0; i < w.readings().size(); ++i) {
            const FrictionReading& r = w.readings()[i];
            out.slip.push_back(r.slip);
            out.mu.push_back(r.mu);
            out.deviation.push_back(w.deviation()[static_cast<Index>(i)]);
            if (!r.held) continue;
            out.largest_slip = std::max(out.largest_slip, r.slip);
            const double error = r.mu - rig::friction(s, r.slip).mu;
            sum += error * error;
            held += 1.0;
        }
    }
    out.rms = held > 0.0 ? std::sqrt(sum / held) : 0.0;
    const rig::Peak peak = rig::peak(s);
    if (out.largest_slip < 1.1 * peak.slip || out.c3.high - out.c3.low > out.c1.value) {
        throw NotIdentifiable(
            fmt::format("{}: slip is held up to {:.3f} only, {}: c1 and c3 cannot be told apart; expected a landing that is recorded from before "
                        "touchdown, with a slip reference beyond the peak (config/scenarios/heavy.toml)",
                        surface, out.largest_slip,
                        std::isfinite(peak.slip) ? fmt::format("the friction's peak lies near {:.3f}", peak.slip) : "where friction still rises"));
    }
    constexpr double kWorst = 0.3;
    if (out.c2.high - out.c2.low > kWorst * out.c2.value) {
        throw NotIdentifiable(
            fmt::format("{}: c2 is {:.3g} to {:.3g}, which says nothing of low slip; expected a landing under a current that rises slowly "
                        "(config/scenarios/slow_braking.toml)",
                        surface, out.c2.low, out.c2.high));
    }
    return out;
}

}  // namespace identification
