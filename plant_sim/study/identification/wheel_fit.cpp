#include "plant_sim/study/identification/wheel_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <utility>

#include "plant_sim/model/clamp.hpp"
#include "plant_sim/study/order_statistics.hpp"

namespace identification {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::size_t kPowers = 4;
constexpr double kSpeedWindow_s = 0.02;
constexpr double kBefore_s = 1.0;          // of the rim's coasting before contact
constexpr double kSlowestStart_mps = 6.0;  // of a stop that counts: below it, drop-out may lock the wheel
constexpr double kMinStop_mps = 20.0;      // a stop from a lower speed does not show friction over speed
constexpr double kSettle_s = 0.05;
constexpr double kContact_s = 5e-3;  // error of the instant of contact: half of the interval of the load readings
constexpr double kContactStart_MPa = 0.5, kMaxContact_MPa = 10.0;
constexpr double kPistonStart = 0.02, kMaxPiston = 0.5;
constexpr int kSmooth = 5;
constexpr double kSurely = 25.0;  // decrease of the sum of squares for a parameter, in squares of the residuals' deviation: five deviations of it

using Powers = std::array<double, kPowers>;

/// One window: the terms of the balance, which is linear in them.
struct Row {
    double time_s = 0.0, v_mps = 0.0;
    double momentum_Nms = 0.0;  // integral of r m dv since the start
    double omega_radps = 0.0;
    double coasting_s = 0.0;  // time off the rim since the start
    Powers impulse{};         // integral of G P_clamp x^k dt, mean over the window
};

/// One sample of the gauge.
struct Reading {
    double time_s = 0.0;
    double pressure_Pa = 0.0;  // 0 before brake-on, where a reading is noise, cut off at zero
    double smooth_Pa = 0.0;    // mean of kSmooth readings: discs that follow the gauge's noise would never let go
    double x = 0.0;
};

struct Segment {
    std::string name;
    bool braking = false;
    double brake_on_s = 0.0;
    double to_mps = 1.0;        // N m s per m/s
    double radius_share = 0.0;  // relative deviation of the free radius
    double gain_m3 = 0.0;       // G
    std::vector<Reading> readings;
    std::vector<double> middles_s;      // of the windows, without a gap between them
    std::vector<Row> rows;              // those of them that count
    Eigen::LLT<Eigen::MatrixXd> noise;  // of the rows' expected covariance, (N m s)^2
};

/// Rim speed linear between the centres of windows.
double speed_at(const std::vector<Row>& rows, double time_s) {
    const auto next = std::lower_bound(rows.begin(), rows.end(), time_s, [](const Row& r, double t) { return r.time_s < t; });
    if (next == rows.begin()) return rows.front().v_mps;
    if (next == rows.end()) return rows.back().v_mps;
    const Row& a = *(next - 1);
    return a.v_mps + (next->v_mps - a.v_mps) * (time_s - a.time_s) / (next->time_s - a.time_s);
}

std::vector<Reading> readings(const Run& run, const Motion& motion, const std::vector<Row>& rows) {
    std::vector<Reading> all;
    all.reserve(run.recording.samples.size());
    for (const Sample& s : run.recording.samples)
        if (s.time_s >= rows.front().time_s - kSpeedWindow_s && s.phase <= phase::kBraking)
            all.push_back({.time_s = s.time_s,
                           .pressure_Pa = s.time_s < motion.brake_on_s() ? 0.0 : s.pressure_Pa,
                           .x = std::min(speed_at(rows, s.time_s) / motion.brake_on_mps(), 1.0)});
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
std::vector<Powers> impulses(const Segment& segment, const rig::Clamping& clamping) {
    std::vector<Powers> all;
    all.reserve(segment.middles_s.size());
    Powers power_last{}, sum{}, sum_of_sums{};
    Powers at_start{};  // sum_of_sums at the start of the window
    double last_s = segment.readings.empty() ? 0.0 : segment.readings.front().time_s;
    bool inside = false;
    plant::Clamp clamp(clamping);
    for (const Reading& reading : segment.readings) {
        const double pressure_Pa = clamping.piston_friction > 0.0 ? reading.smooth_Pa : reading.pressure_Pa;
        clamp.follow(plant::PressureArc::linear(pressure_Pa, pressure_Pa), 0.0, 0.0);
        double power = segment.gain_m3 * clamp.pressure_Pa(0.0);
        const double step_s = reading.time_s - last_s;
        const Powers before = sum_of_sums;
        for (std::size_t k = 0; k < kPowers; ++k) {
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
            for (std::size_t k = 0; k < kPowers; ++k) {
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

/// Sets the rows' impulses.
void press(Segment& segment, const rig::Clamping& clamping) {
    const std::vector<Powers> all = impulses(segment, clamping);
    auto row = segment.rows.begin();
    for (std::size_t i = 0; i < all.size() && row != segment.rows.end(); ++i)
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
Eigen::MatrixXd covariance(const Run& run, const Motion& motion, const Segment& segment) {
    constexpr double kLikelyFriction = 0.3;
    const auto n = static_cast<Index>(segment.rows.size());
    const double per_reading = kLikelyFriction * run.rig.brake_gain_m3 * gauge_noise_Pa(run.recording);
    const double walk = per_reading * per_reading * run.recording.period_s;  // per s of braking
    Eigen::MatrixXd v(n, n);
    std::vector<double> border(segment.rows.size());
    std::vector<double> walked(segment.rows.size());
    for (std::size_t i = 0; i < segment.rows.size(); ++i) {
        const double noise = segment.to_mps * segment.rows[i].v_mps * run.rig.edge_jitter_s / kSpeedWindow_s;
        border[i] = noise * noise;
        walked[i] = walk * std::max(segment.rows[i].time_s - motion.brake_on_s(), 0.0);
    }
    // The drag loss of the rim before contact has the error of the instant of contact, which is the same in all windows before it.
    const std::size_t off =
        static_cast<std::size_t>(std::count_if(segment.rows.begin(), segment.rows.end(), [](const Row& row) { return row.coasting_s < 0.0; }));
    double contact = 0.0;
    if (off > 1) {
        const Row& first = segment.rows.front();
        const Row& last = segment.rows[off - 1];
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
        const bool neighbours = i > 0 && segment.rows[a].time_s - segment.rows[a - 1].time_s < 1.5 * kSpeedWindow_s;
        if (neighbours) {
            v(i, i - 1) -= border[a - 1];
            v(i - 1, i) -= border[a - 1];
        }
    }
    return v;
}

Segment segment(const Run& run, const Motion& motion, bool braking) {
    Segment s{.name = run.recording.name,
              .braking = braking,
              .brake_on_s = motion.brake_on_s(),
              .to_mps = 1.0,
              .radius_share = motion.free_radius_deviation_m() / motion.free_radius_m(),
              .gain_m3 = run.rig.brake_gain_m3,
              .readings = {},
              .middles_s = {},
              .rows = {},
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
        s.rows.push_back({.time_s = middle_s,
                          .v_mps = v,
                          .momentum_Nms = mean,
                          .omega_radps = off ? 0.0 : motion.omega_radps(t, t + kSpeedWindow_s),
                          .coasting_s = std::min(middle_s - motion.contact_s(), 0.0)});
    }
    if (s.rows.empty()) return s;
    s.readings = readings(run, motion, s.rows);
    s.middles_s.reserve(s.rows.size());
    for (const Row& row : s.rows) s.middles_s.push_back(row.time_s);
    s.middles_s.resize(impulses(s, {}).size());
    s.rows.resize(s.middles_s.size());
    // A window around contact would be on both sides of it.
    std::erase_if(s.rows, [&](const Row& row) { return std::abs(row.time_s - motion.contact_s()) < kSettle_s; });
    s.noise.compute(covariance(run, motion, s));
    return s;
}

/// Adds an independent error to the one shown by the residuals.
Estimate with_error(const Estimate& e, double deviation) {
    const double factor = std::hypot(e.deviation, deviation) / e.deviation;
    return {.value = e.value,
            .deviation = e.deviation * factor,
            .low = e.value - (e.value - e.low) * factor,
            .high = e.value + (e.high - e.value) * factor};
}

/// Which part of rig::Clamping a fit looks for; the other is 0.
struct Sought {
    bool contact = false, piston_friction = false;
};

/// theta: J_w, the kPowers friction coefficients, the contact pressure in MPa and the piston friction as far as they are sought, then offset and drag
/// of each segment.
class Balance {
  public:
    Balance(std::vector<Segment> segments, const Sought& sought) : segments_(std::move(segments)), sought_(sought) {
        for (Segment& s : segments_) {
            press(s, clamping_);
            rows_ += s.rows.size();
        }
    }

    [[nodiscard]] Index contact() const { return 1 + static_cast<Index>(kPowers); }
    [[nodiscard]] Index piston_friction() const { return contact() + (sought_.contact ? 1 : 0); }
    [[nodiscard]] Index common() const { return piston_friction() + (sought_.piston_friction ? 1 : 0); }
    [[nodiscard]] const Sought& sought() const { return sought_; }
    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] Index parameters() const { return common() + 2 * static_cast<Index>(segments_.size()); }

    void residuals(const VectorXd& theta, VectorXd& out) {
        clamp({.contact_Pa = sought_.contact ? theta[contact()] * 1e6 : 0.0,
               .piston_friction = sought_.piston_friction ? theta[piston_friction()] : 0.0});
        out.resize(static_cast<Index>(rows_));
        Index n = 0;
        Index own = common();
        for (const Segment& s : segments_) {
            const auto count = static_cast<Index>(s.rows.size());
            for (Index i = 0; i < count; ++i) out[n + i] = error_Nms(s.rows[static_cast<std::size_t>(i)], theta, own);
            s.noise.matrixL().solveInPlace(out.segment(n, count));
            n += count;
            own += 2;
        }
    }
    [[nodiscard]] static double error_Nms(const Row& row, const VectorXd& theta, Index own) {
        double balance = row.momentum_Nms + theta[0] * row.omega_radps - theta[own] - theta[own + 1] * row.coasting_s;
        for (std::size_t k = 0; k < kPowers; ++k) balance += theta[1 + static_cast<Index>(k)] * row.impulse[k];
        return balance;
    }
    /// Of the theta that residuals() was called with last.
    [[nodiscard]] std::vector<WheelResiduals> report(const VectorXd& theta) const {
        std::vector<WheelResiduals> all;
        all.reserve(segments_.size());
        Index own = common();
        for (const Segment& s : segments_) {
            WheelResiduals r{.recording = s.name, .braking = s.braking, .time_s = {}, .speed_mps = {}, .error_mps = {}};
            for (const Row& row : s.rows) {
                r.time_s.push_back(row.time_s - s.brake_on_s);
                r.speed_mps.push_back(row.v_mps);
                r.error_mps.push_back(error_Nms(row, theta, own) / s.to_mps);
            }
            own += 2;
            all.push_back(std::move(r));
        }
        return all;
    }

  private:
    void clamp(const rig::Clamping& clamping) {
        if (clamping.contact_Pa == clamping_.contact_Pa && clamping.piston_friction == clamping_.piston_friction) return;
        clamping_ = clamping;
        for (Segment& s : segments_) press(s, clamping);
    }

    std::vector<Segment> segments_;
    Sought sought_;
    rig::Clamping clamping_{};
    std::size_t rows_ = 0;
};

struct Candidate {
    Balance balance;
    Fit fit;
    [[nodiscard]] double square() const { return fit.residuals.squaredNorm(); }
    /// Whether all that was sought is above 0 beyond doubt.
    [[nodiscard]] bool shown() const {
        for (Index i = balance.contact(); i < balance.common(); ++i)
            if (!(fit.estimate(i).low > 0.0)) return false;
        return true;
    }
};

Candidate candidate(const std::vector<Segment>& segments, const Sought& sought) {
    Balance balance(segments, sought);
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
Candidate best_candidate(const std::vector<Segment>& segments) {
    Candidate best = candidate(segments, {});
    if (best.fit.rms <= 1.0) return best;  // errors of the sensors explain all
    constexpr std::array<Sought, 3> kMore{{{.contact = true}, {.piston_friction = true}, {.contact = true, .piston_friction = true}}};
    for (const Sought& sought : kMore) {
        const Candidate next = candidate(segments, sought);
        const double more = static_cast<double>(next.balance.common() - best.balance.common());
        const double unit = std::max(next.square() / static_cast<double>(next.balance.rows()), 1.0);
        if (next.shown() && next.square() + kSurely * unit * more < best.square()) best = next;
    }
    return best;
}

}  // namespace

WheelFit fit_wheel(std::span<const Run> runs, const std::string& friction_class) {
    for (const Run& run : runs) check(run.recording);
    std::vector<Segment> segments;
    int stops = 0;
    double radius_variance = 0.0;  // relative, of the stops' sum
    const double age_s = cell_age_s(runs);
    for (const Run& run : runs) {
        const auto motion = Motion::of(run, age_s);
        if (!motion) continue;
        const bool braking = run.friction_class == friction_class && motion->brake_on_mps() >= kMinStop_mps;
        Segment s = segment(run, *motion, braking);
        if (s.rows.empty()) continue;
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
    for (std::size_t k = 0; k < kPowers; ++k) mean[1 + static_cast<Index>(k)] = 1.0 / static_cast<double>(k + 1);
    // An error of the radius gives the same relative error of the flywheel's torque and of k_b; no residual shows it.
    const Estimate shown = found.combination(mean);
    const double mu = shown.value;
    out.friction = with_error(shown, mu * std::sqrt(radius_variance) / stops);
    for (std::size_t k = 0; k < kPowers; ++k) {
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
