#include "plant_sim/study/identification/wheel_balance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plant_sim/model/clamp.hpp"
#include "plant_sim/study/order_statistics.hpp"

namespace identification {

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Powers = std::array<double, kFrictionPowers>;

constexpr double kBefore_s = 1.0;          // of the rim's coasting before contact
constexpr double kSlowestStart_mps = 6.0;  // of a stop that counts: below it, drop-out may lock the wheel
constexpr double kSettle_s = 0.05;
constexpr double kContact_s = 5e-3;  // error of the instant of contact: half of the interval of the load readings
constexpr int kSmooth = 5;

/// Rim speed linear between the centres of windows.
double speed_at(const std::vector<WheelWindow>& windows, double time_s) {
    const auto next = std::lower_bound(windows.begin(), windows.end(), time_s, [](const WheelWindow& r, double t) { return r.time_s < t; });
    if (next == windows.begin()) return windows.front().v_mps;
    if (next == windows.end()) return windows.back().v_mps;
    const WheelWindow& a = *(next - 1);
    return a.v_mps + (next->v_mps - a.v_mps) * (time_s - a.time_s) / (next->time_s - a.time_s);
}

std::vector<GaugeReading> readings(const Run& run, const Motion& motion, const std::vector<WheelWindow>& windows) {
    std::vector<GaugeReading> all;
    all.reserve(run.recording.samples.size());
    for (const Sample& s : run.recording.samples)
        if (s.time_s >= windows.front().time_s - kSpeedWindow_s && s.phase <= phase::kBraking)
            all.push_back({.time_s = s.time_s,
                           .pressure_Pa = s.time_s < motion.brake_on_s() ? 0.0 : s.pressure_Pa,
                           .x = std::min(speed_at(windows, s.time_s) / motion.brake_on_mps(), 1.0)});
    constexpr std::ptrdiff_t kHalf = kSmooth / 2;
    const auto size = static_cast<std::ptrdiff_t>(all.size());
    for (std::ptrdiff_t i = 0; i < size; ++i) {
        const std::ptrdiff_t half = std::min({kHalf, i, size - 1 - i});
        double sum = 0.0;
        for (std::ptrdiff_t k = i - half; k <= i + half; ++k) sum += all[static_cast<std::size_t>(k)].pressure_Pa;
        all[static_cast<std::size_t>(i)].smooth_Pa = sum / static_cast<double>(2 * half + 1);
    }
    return all;
}

/// The mean of the running integral over each window up to the last reading, from integrals of integrals: a window need not begin at a sample.
std::vector<Powers> impulses(const WheelSegment& segment, const rig::Clamping& clamping) {
    std::vector<Powers> all;
    all.reserve(segment.middles_s.size());
    Powers power_last{}, sum{}, sum_of_sums{};
    Powers at_start{};  // sum_of_sums at the start of the window
    double last_s = segment.readings.empty() ? 0.0 : segment.readings.front().time_s;
    bool inside = false;
    plant::Clamp clamp(clamping);
    for (const GaugeReading& reading : segment.readings) {
        const double pressure_Pa = clamping.piston_friction > 0.0 ? reading.smooth_Pa : reading.pressure_Pa;
        clamp.follow(plant::PressureArc::linear(pressure_Pa, pressure_Pa), 0.0, 0.0);
        double power = segment.gain_m3 * clamp.pressure_Pa(0.0);
        const double step_s = reading.time_s - last_s;
        const Powers before = sum_of_sums;
        for (std::size_t k = 0; k < kFrictionPowers; ++k) {
            const double sum_before = sum[k];
            sum[k] += 0.5 * (power_last[k] + power) * step_s;
            sum_of_sums[k] += 0.5 * (sum_before + sum[k]) * step_s;
            power_last[k] = power;
            power *= reading.x;
        }
        while (all.size() < segment.middles_s.size()) {
            const double edge_s = segment.middles_s[all.size()] + (inside ? 0.5 : -0.5) * kSpeedWindow_s;
            if (edge_s > reading.time_s) break;
            const double share = step_s > 0.0 ? (edge_s - last_s) / step_s : 1.0;
            Powers mean{};
            for (std::size_t k = 0; k < kFrictionPowers; ++k) {
                const double at_edge = before[k] + share * (sum_of_sums[k] - before[k]);
                mean[k] = (at_edge - at_start[k]) / kSpeedWindow_s;
                at_start[k] = at_edge;
            }
            if (inside) all.push_back(mean);
            inside = true;
        }
        last_s = reading.time_s;
    }
    return all;
}

/// Sets the windows' impulses.
void press(WheelSegment& segment, const rig::Clamping& clamping) {
    const std::vector<Powers> all = impulses(segment, clamping);
    auto row = segment.windows.begin();
    for (std::size_t i = 0; i < all.size() && row != segment.windows.end(); ++i)
        if (row->time_s == segment.middles_s[i]) (row++)->impulse = all[i];
}

/// Noise of one pressure reading, from third differences, on which the valve's motion in 1 ms has hardly any effect.
double gauge_noise_Pa(const Recording& recording) {
    std::vector<double> differences;
    const auto& s = recording.samples;
    for (std::size_t i = 3; i < s.size(); ++i) {
        if (s[i - 3].phase != phase::kBraking || s[i].phase != phase::kBraking) continue;
        differences.push_back(std::abs(s[i].pressure_Pa - 3.0 * (s[i - 1].pressure_Pa - s[i - 2].pressure_Pa) - s[i - 3].pressure_Pa));
    }
    return study::deviation_by_median(std::move(differences)) / std::sqrt(20.0);
}

/// Jitter at a border counts in both adjacent windows, with opposite signs; the integral sums up the gauge's noise without end. Residuals divided by
/// this covariance are nearly white.
Eigen::MatrixXd covariance(const Run& run, const Motion& motion, const WheelSegment& segment) {
    constexpr double kLikelyFriction = 0.3;
    const auto n = static_cast<Index>(segment.windows.size());
    const double per_reading = kLikelyFriction * run.rig.brake_gain_m3 * gauge_noise_Pa(run.recording);
    const double walk = per_reading * per_reading * run.recording.period_s;  // per s of braking
    Eigen::MatrixXd v(n, n);
    std::vector<double> border(segment.windows.size());
    std::vector<double> walked(segment.windows.size());
    for (std::size_t i = 0; i < segment.windows.size(); ++i) {
        const double noise = segment.to_mps * segment.windows[i].v_mps * run.rig.edge_jitter_s / kSpeedWindow_s;
        border[i] = noise * noise;
        walked[i] = walk * std::max(segment.windows[i].time_s - motion.brake_on_s(), 0.0);
    }
    // The drag loss of the rim before contact has the error of the instant of contact, which is the same in all windows before it.
    const std::size_t off = static_cast<std::size_t>(
        std::count_if(segment.windows.begin(), segment.windows.end(), [](const WheelWindow& row) { return row.coasting_s < 0.0; }));
    double contact = 0.0;
    if (off > 1) {
        const WheelWindow& first = segment.windows.front();
        const WheelWindow& last = segment.windows[off - 1];
        contact = segment.to_mps * (first.v_mps - last.v_mps) / (last.time_s - first.time_s) * kContact_s;
    }
    constexpr double kFloor = 0.05;  // of the jitter: for effects that the balance neglects
    for (Index i = 0; i < n; ++i) {
        const auto a = static_cast<std::size_t>(i);
        for (Index j = 0; j <= i; ++j) {
            const bool both_off = a < off;
            v(i, j) = v(j, i) = walked[static_cast<std::size_t>(j)] + (both_off ? contact * contact : 0.0);
        }
        v(i, i) += (2.0 + kFloor) * border[a];
        const bool neighbours = i > 0 && segment.windows[a].time_s - segment.windows[a - 1].time_s < 1.5 * kSpeedWindow_s;
        if (neighbours) {
            v(i, i - 1) -= border[a - 1];
            v(i - 1, i) -= border[a - 1];
        }
    }
    return v;
}

}  // namespace

WheelSegment wheel_segment(const Run& run, const Motion& motion, bool braking) {
    WheelSegment s{.name = run.recording.name,
                   .braking = braking,
                   .brake_on_s = motion.brake_on_s(),
                   .to_mps = 1.0,
                   .radius_share = motion.free_radius_deviation_m() / motion.free_radius_m(),
                   .gain_m3 = run.rig.brake_gain_m3,
                   .readings = {},
                   .middles_s = {},
                   .windows = {},
                   .noise = {}};
    const double m = run.rig.mass_kg;
    const double r = motion.radius_m(motion.brake_on_s());
    s.to_mps = m * r;
    // The radius decreases within about 10 ms while the wheel spins up, so that r dv is summed in parts of a window. The jitter of the parts cancels.
    constexpr int kParts = 10;
    constexpr double kPart_s = kSpeedWindow_s / kParts;
    double momentum = 0.0;
    double last_mps = 0.0;
    const double end_s = braking ? motion.end_s() : motion.brake_on_s() - kSpeedWindow_s;
    for (double t = std::max(motion.contact_s() - kBefore_s, run.recording.samples.front().time_s); t + kSpeedWindow_s < end_s; t += kSpeedWindow_s) {
        const double v = motion.v_mps(t, t + kSpeedWindow_s);
        if (braking && t > motion.brake_on_s() && v < kSlowestStart_mps) break;
        const double middle_s = t + 0.5 * kSpeedWindow_s;
        const bool off = middle_s < motion.contact_s();
        double mean = 0.0;
        for (int part = 0; part < kParts; ++part) {
            const double from_s = t + part * kPart_s;
            const double part_mps = motion.v_mps(from_s, from_s + kPart_s);
            if (last_mps > 0.0) momentum += m * motion.radius_m(from_s) * (part_mps - last_mps);
            last_mps = part_mps;
            mean += momentum / kParts;
        }
        s.windows.push_back({.time_s = middle_s,
                             .v_mps = v,
                             .momentum_Nms = mean,
                             .omega_radps = off ? 0.0 : motion.omega_radps(t, t + kSpeedWindow_s),
                             .coasting_s = std::min(middle_s - motion.contact_s(), 0.0)});
    }
    if (s.windows.empty()) return s;
    s.readings = readings(run, motion, s.windows);
    s.middles_s.reserve(s.windows.size());
    for (const WheelWindow& row : s.windows) s.middles_s.push_back(row.time_s);
    s.middles_s.resize(impulses(s, {}).size());
    s.windows.resize(s.middles_s.size());
    // A window around contact would be on both sides of it.
    std::erase_if(s.windows, [&](const WheelWindow& row) { return std::abs(row.time_s - motion.contact_s()) < kSettle_s; });
    s.noise.compute(covariance(run, motion, s));
    return s;
}

WheelBalance::WheelBalance(std::vector<WheelSegment> segments, const Sought& sought) : segments_(std::move(segments)), sought_(sought) {
    for (WheelSegment& s : segments_) {
        press(s, clamping_);
        windows_ += s.windows.size();
    }
}

void WheelBalance::residuals(const VectorXd& theta, VectorXd& out) {
    clamp(
        {.contact_Pa = sought_.contact ? theta[contact()] * 1e6 : 0.0, .piston_friction = sought_.piston_friction ? theta[piston_friction()] : 0.0});
    out.resize(static_cast<Index>(windows_));
    Index n = 0;
    Index own = common();
    for (const WheelSegment& s : segments_) {
        const auto count = static_cast<Index>(s.windows.size());
        for (Index i = 0; i < count; ++i) out[n + i] = error_Nms(s.windows[static_cast<std::size_t>(i)], theta, own);
        s.noise.matrixL().solveInPlace(out.segment(n, count));
        n += count;
        own += 2;
    }
}

double WheelBalance::error_Nms(const WheelWindow& window, const VectorXd& theta, Index own) {
    double balance = window.momentum_Nms + theta[0] * window.omega_radps - theta[own] - theta[own + 1] * window.coasting_s;
    for (std::size_t k = 0; k < kFrictionPowers; ++k) balance += theta[1 + static_cast<Index>(k)] * window.impulse[k];
    return balance;
}

std::vector<WheelResiduals> WheelBalance::report(const VectorXd& theta) const {
    std::vector<WheelResiduals> all;
    all.reserve(segments_.size());
    Index own = common();
    for (const WheelSegment& s : segments_) {
        WheelResiduals r{.recording = s.name, .braking = s.braking, .time_s = {}, .speed_mps = {}, .error_mps = {}};
        for (const WheelWindow& row : s.windows) {
            r.time_s.push_back(row.time_s - s.brake_on_s);
            r.speed_mps.push_back(row.v_mps);
            r.error_mps.push_back(error_Nms(row, theta, own) / s.to_mps);
        }
        own += 2;
        all.push_back(std::move(r));
    }
    return all;
}

void WheelBalance::clamp(const rig::Clamping& clamping) {
    if (clamping.contact_Pa == clamping_.contact_Pa && clamping.piston_friction == clamping_.piston_friction) return;
    clamping_ = clamping;
    for (WheelSegment& s : segments_) press(s, clamping);
}

}  // namespace identification
