#include "plant_sim/study/identification/motion.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace identification {

namespace {

constexpr double kRolling_s = 0.4;  // before brake-on the wheel rolls freely for at least this long

/// First sample in the phase, from `from` on; the number of samples if there is none.
std::size_t first_in(const Recording& recording, std::uint8_t wanted, std::size_t from = 0) {
    const auto& s = recording.samples;
    while (from < s.size() && s[from].phase != wanted) ++from;
    return from;
}

}  // namespace

ShaftTrack::ShaftTrack(const Recording& recording, Edges Sample::*shaft, double teeth, std::size_t from, std::size_t to) {
    const double per_edge = 2.0 * std::numbers::pi / teeth;
    const auto& samples = recording.samples;
    double offset_s = std::numeric_limits<double>::max();
    double edges = 0.0;
    for (std::size_t i = from; i < to; ++i) {
        const Edges& now = samples[i].*shaft;
        if (i > from) {
            const std::uint32_t passed = now.count - (samples[i - 1].*shaft).count;
            if (passed == 0) continue;
            edges += passed;
        }
        // Before the first new edge, the last one may be long ago.
        if (i > from) offset_s = std::min(offset_s, samples[i].time_s - now.time_s);
        if (!points_.empty() && now.time_s <= points_.back().time_s) continue;
        points_.push_back({now.time_s, edges * per_edge});
    }
    if (points_.size() < 2)
        throw NotIdentifiable(recording.name + ": an encoder has no edges while the rig moves; expected both encoders in the recording");
    for (Point& p : points_) p.time_s += offset_s;
}

ShaftTrack::Place ShaftTrack::place(double time_s) const {
    const auto next = std::upper_bound(points_.begin(), points_.end(), time_s, [](double t, const Point& p) { return t < p.time_s; });
    if (next == points_.begin()) return {0, 0.0};
    const auto edge = static_cast<std::size_t>(next - points_.begin()) - 1;
    if (next == points_.end()) return {edge, 0.0};
    const double length_s = next->time_s - points_[edge].time_s;
    return {edge, length_s > kRest_s ? 0.0 : (time_s - points_[edge].time_s) / length_s};
}

double ShaftTrack::angle(double time_s) const {
    const Place at = place(time_s);
    const double from_rad = points_[at.edge].angle_rad;
    return at.share > 0.0 ? from_rad + (points_[at.edge + 1].angle_rad - from_rad) * at.share : from_rad;
}

std::optional<Motion> Motion::of(const Run& run, double cell_age_s) {
    const Recording& r = run.recording;
    const std::size_t brake_on = first_in(r, phase::kBraking);
    const std::size_t touchdown = first_in(r, phase::kTouchdown);
    if (brake_on == r.samples.size() || touchdown >= brake_on) return std::nullopt;
    std::size_t end = brake_on;
    while (end < r.samples.size() && r.samples[end].phase == phase::kBraking) ++end;
    return Motion(run, cell_age_s, touchdown, end);
}

Motion::Motion(const Run& run, double cell_age_s, std::size_t from, std::size_t to)
    : wheel_(run.recording, &Sample::wheel, run.rig.wheel_teeth, from, to),
      flywheel_(run.recording, &Sample::flywheel, run.rig.flywheel_teeth, from, to),
      R_f_m_(run.rig.flywheel_radius_m),
      stiffness_Npm_(run.rig.stiffness_Npm) {
    const auto& samples = run.recording.samples;
    for (std::size_t i = from; i < to; ++i) {
        const Sample& s = samples[i];
        if (brake_on_s_ == 0.0 && s.phase == phase::kBraking) brake_on_s_ = s.time_s;
        if (contact_s_ == 0.0 && i > from && s.wheel.count != samples[i - 1].wheel.count) contact_s_ = s.time_s;
        if (s.cells_new) cells_.push_back({s.time_s - cell_age_s, s.vertical_N, s.longitudinal_N});
    }
    end_s_ = samples[to - 1].time_s;
    if (cells_.empty())
        throw NotIdentifiable(run.recording.name +
                              ": no readings of the load cells; friction and rolling radius need vertical load and longitudinal force");
    if (contact_s_ == 0.0 || brake_on_s_ - contact_s_ < kRolling_s) {
        throw NotIdentifiable(
            fmt::format("{}: the wheel rolls for less than {:.1f} s before brake-on; expected a settled wheel, whose rolling shows its radius",
                        run.recording.name, kRolling_s));
    }
    const double rolling_from_s = brake_on_s_ - 0.75 * kRolling_s;
    brake_on_mps_ = v_mps(rolling_from_s, brake_on_s_);
    const double omega = omega_radps(rolling_from_s, brake_on_s_);
    if (!(omega > 0.0) || !(brake_on_mps_ > 0.0))
        throw NotIdentifiable(run.recording.name + ": the wheel does not turn before brake-on; expected it to roll on the rim");
    double load = 0.0;
    double squares = 0.0;
    double readings = 0.0;
    for (const CellReading& c : cells_) {
        if (c.time_s < rolling_from_s || c.time_s > brake_on_s_) continue;
        load += c.vertical_N;
        squares += c.vertical_N * c.vertical_N;
        readings += 1.0;
    }
    if (readings > 0.0) load /= readings;
    free_radius_m_ = brake_on_mps_ / omega + load / stiffness_Npm_;
    // Four ends, two on each shaft; an instant between two edges has 2/3 of the variance of one edge.
    const double rolling_s = brake_on_s_ - rolling_from_s;
    const double by_edges = std::sqrt(4.0 * 2.0 / 3.0) * run.rig.edge_jitter_s / rolling_s * free_radius_m_;
    const double variance = readings > 1.0 ? (squares / readings - load * load) / (readings - 1.0) : 0.0;
    free_radius_deviation_m_ = std::hypot(by_edges, std::sqrt(std::max(variance, 0.0)) / stiffness_Npm_);
    find_contact();
}

/// The wheel's first edge is late: it starts to turn slowly, under a load that rises from zero. The load shows contact earlier; it approaches its
/// set-point with a lag, F = F_set (1 - exp(-t / lag)), and two readings determine both unknowns.
void Motion::find_contact() {
    constexpr double kSeen = 0.03;
    const double set_N = load_N(brake_on_s_);
    for (std::size_t i = 0; i + 1 < cells_.size() && cells_[i].time_s < brake_on_s_; ++i) {
        const CellReading& a = cells_[i];
        const CellReading& b = cells_[i + 1];
        if (a.vertical_N < kSeen * set_N) continue;
        if (b.vertical_N <= a.vertical_N || b.vertical_N >= set_N) return;
        const double lag_s = (b.time_s - a.time_s) / std::log((set_N - a.vertical_N) / (set_N - b.vertical_N));
        contact_s_ = std::min(contact_s_, a.time_s + lag_s * std::log(1.0 - a.vertical_N / set_N));
        // Contact, where the load starts to rise, is between the last reading of zero and the first non-zero one.
        const auto first = std::find_if(cells_.begin(), cells_.end(), [this](const CellReading& c) { return c.time_s > contact_s_; });
        if (first != cells_.begin() && contact_s_ > (first - 1)->time_s) cells_.insert(first, {contact_s_, 0.0, 0.0});
        return;
    }
}

/// m (v(t0) - v(t)) - integral of the cell's force = age F(t) + gain error times the integral.
double cell_age_s(std::span<const Run> runs) {
    constexpr double kBuildUp_s = 1.0;
    constexpr double kHalf_s = 10e-3;
    constexpr double kMax_s = 0.1;
    double weighted = 0.0;
    double weights = 0.0;
    for (const Run& run : runs) {
        const auto motion = Motion::of(run, 0.0);
        if (!motion) continue;
        const auto& cells = motion->cells();
        const double on_s = motion->brake_on_s();
        const double start_mps = motion->v_mps(on_s - 0.2, on_s);
        std::vector<Eigen::Vector2d> rows;
        std::vector<double> missing_Ns;
        double impulse_Ns = 0.0;
        for (std::size_t i = 1; i < cells.size(); ++i) {
            const double t = cells[i].time_s;
            if (t < on_s) continue;
            if (t > std::min(on_s + kBuildUp_s, motion->end_s() - kHalf_s)) break;
            impulse_Ns += 0.5 * (cells[i].longitudinal_N + cells[i - 1].longitudinal_N) * (t - cells[i - 1].time_s);
            rows.emplace_back(cells[i].longitudinal_N, impulse_Ns);
            missing_Ns.push_back(run.rig.mass_kg * (start_mps - motion->v_mps(t - kHalf_s, t + kHalf_s)) - impulse_Ns);
        }
        if (rows.size() < 20) continue;
        const auto n = static_cast<Eigen::Index>(rows.size());
        Eigen::MatrixX2d a(n, 2);
        for (Eigen::Index i = 0; i < n; ++i) a.row(i) = rows[static_cast<std::size_t>(i)].transpose();
        const Eigen::Map<const Eigen::VectorXd> y(missing_Ns.data(), n);
        const Eigen::Matrix2d normal = a.transpose() * a;
        const Eigen::Vector2d x = normal.ldlt().solve(a.transpose() * y);
        const double variance = (y - a * x).squaredNorm() / static_cast<double>(n - 2) * normal.inverse()(0, 0);
        if (!(variance > 0.0)) continue;
        weighted += x[0] / variance;
        weights += 1.0 / variance;
    }
    return weights > 0.0 ? std::clamp(weighted / weights, 0.0, kMax_s) : 0.0;
}

double Motion::load_N(double time_s) const {
    const auto next = std::upper_bound(cells_.begin(), cells_.end(), time_s, [](double t, const CellReading& c) { return t < c.time_s; });
    if (next == cells_.begin()) return cells_.front().vertical_N;
    if (next == cells_.end()) return cells_.back().vertical_N;
    const CellReading& a = *(next - 1);
    return a.vertical_N + (next->vertical_N - a.vertical_N) * (time_s - a.time_s) / (next->time_s - a.time_s);
}

}  // namespace identification
