#include "plant_sim/study/identification/friction_readings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "plant_sim/study/order_statistics.hpp"

namespace identification {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kOff_s = 1e-3;  // error of a reading's instant after correction for its age
constexpr double kMinSlip = 0.003;
constexpr double kSlowSlip = 0.002;  // change over a window below which slip counts as constant

/// Covariance of the jitter at two instants, for edges of unit variance; it is not 0 if both depend on a common edge.
double shared(const ShaftTrack::Place& a, const ShaftTrack::Place& b) {
    if (a.edge == b.edge) return (1.0 - a.share) * (1.0 - b.share) + a.share * b.share;
    if (a.edge + 1 == b.edge) return a.share * (1.0 - b.share);
    if (b.edge + 1 == a.edge) return b.share * (1.0 - a.share);
    return 0.0;
}

/// The ends of one window on one shaft.
using Borders = std::array<ShaftTrack::Place, 2>;

bool apart(const Borders& earlier, const Borders& later) {
    return later[0].edge > earlier[1].edge + 1;
}

double shared(const Borders& a, const Borders& b) {
    return shared(a[0], b[0]) + shared(a[1], b[1]) - shared(a[0], b[1]) - shared(a[1], b[0]);
}

}  // namespace

std::optional<FrictionReadings> FrictionReadings::of(const Run& run, double cell_age_s) {
    const auto motion = Motion::of(run, cell_age_s);
    if (!motion) return std::nullopt;
    return FrictionReadings(run, *motion);
}

FrictionReadings::FrictionReadings(const Run& run, const Motion& motion)
    : radius_share_(motion.free_radius_deviation_m() / motion.free_radius_m()), per_load_(1.0 / (run.rig.stiffness_Npm * motion.free_radius_m())) {
    constexpr double kHalf_s = 0.5 * kWindow_s;
    std::vector<Borders> wheel, flywheel;
    double last_s = 0.0;
    for (const Motion::CellReading& c : motion.cells()) {
        const double t = c.time_s;
        if (t < motion.brake_on_s() || t + 3.0 * kHalf_s > motion.end_s() || !(c.vertical_N > 0.0)) continue;
        if (motion.v_mps(t - kHalf_s, t + kHalf_s) < kSlowest_mps) break;
        // A wheel that hardly turns has no edge in the window: its slip would be the mean over a longer one.
        if (motion.wheel().place(t - kHalf_s).edge == motion.wheel().place(t + kHalf_s).edge) continue;
        if (t - last_s < kHalf_s) continue;
        const double slip = motion.slip(t - kHalf_s, t + kHalf_s);
        const double change = motion.slip(t, t + kWindow_s) - motion.slip(t - kWindow_s, t);
        if (slip < kMinSlip) continue;
        last_s = t;
        readings_.push_back({.slip = slip,
                             .mu = c.longitudinal_N / c.vertical_N,
                             .load_N = c.vertical_N,
                             .moved = change / kWindow_s * kOff_s,
                             .held = std::abs(change) < kSlowSlip});
        wheel.push_back({motion.wheel().place(t - kHalf_s), motion.wheel().place(t + kHalf_s)});
        flywheel.push_back({motion.flywheel().place(t - kHalf_s), motion.flywheel().place(t + kHalf_s)});
    }
    const double per_window = run.rig.edge_jitter_s / kWindow_s;
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t i = 0; i < readings_.size(); ++i) {
        for (std::size_t k = i; k < readings_.size(); ++k) {
            if (apart(wheel[i], wheel[k]) && apart(flywheel[i], flywheel[k])) break;
            const double both = shared(wheel[i], wheel[k]) + shared(flywheel[i], flywheel[k]);
            const double covariance = (1.0 - readings_[i].slip) * (1.0 - readings_[k].slip) * per_window * per_window * both;
            entries.emplace_back(static_cast<int>(i), static_cast<int>(k), covariance);
            if (k > i) entries.emplace_back(static_cast<int>(k), static_cast<int>(i), covariance);
        }
    }
    const auto n = static_cast<Index>(readings_.size());
    jitter_.resize(n, n);
    jitter_.setFromTriplets(entries.begin(), entries.end());
}

ReadingCovariance FrictionReadings::covariance(const rig::Surface& curve, double force_noise_N) const {
    const auto n = static_cast<Index>(readings_.size());
    VectorXd slope(n), by_radius(n), apiece(n);
    for (Index i = 0; i < n; ++i) {
        const FrictionReading& r = readings_[static_cast<std::size_t>(i)];
        slope[i] = rig::friction(curve, r.slip).mu_1;
        by_radius[i] = slope[i] * (1.0 - r.slip);
        const double longitudinal = force_noise_N / r.load_N;
        const double vertical = force_noise_N * (r.mu / r.load_N + by_radius[i] * per_load_);
        const double moved = slope[i] * r.moved;
        apiece[i] = longitudinal * longitudinal + vertical * vertical + moved * moved;
    }
    ReadingCovariance v{.own = slope.asDiagonal() * jitter_ * slope.asDiagonal(), .common = radius_share_ * by_radius};
    v.own.diagonal() += apiece;
    return v;
}

double force_noise_N(const std::vector<FrictionReadings>& runs) {
    std::vector<double> differences;
    double load_N = 0.0;
    for (const FrictionReadings& run : runs) {
        const auto& r = run.all();
        for (std::size_t i = 1; i + 1 < r.size(); ++i) {
            load_N = std::max(load_N, r[i].load_N);
            if (r[i - 1].held && r[i].held && r[i + 1].held) {
                differences.push_back(std::abs(r[i - 1].mu - 2.0 * r[i].mu + r[i + 1].mu) * r[i].load_N / std::hypot(1.0, r[i].mu));
            }
        }
    }
    constexpr double kUnknown = 0.01;  // of the load
    if (differences.size() < 20) return kUnknown * load_N;
    constexpr double kMin = 1e-4;  // of the load
    return std::max(study::deviation_by_median(std::move(differences)) / std::sqrt(6.0), kMin * load_N);
}

}  // namespace identification
