#include "plant_sim/wear/dynamics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <utility>

#include "plant_sim/study/order_statistics.hpp"
#include "plant_sim/wear/robust_curve.hpp"

namespace wear {

namespace {

using settings::Error;

constexpr std::size_t kMinSamples = 40;  // ten for each coefficient
constexpr double kMinSpan = 0.5;         // of x in [0, 1]
constexpr double kMinInStop = 0.001;
constexpr double kGreatestInStop = 1.5;
constexpr double kMaxRejected = 0.5;
/// With few stops: each is cut into this many bands of x, every kBandGroups-th band is one group.
constexpr std::size_t kSpeedBands = 24;
constexpr std::size_t kBandGroups = 6;

void check(const RecordedStop& stop) {
    const auto reject = [&](const std::string& what) { throw Error(stop.source, 0, "", what); };
    if (!(stop.brake_on_mps > 0.0) || !std::isfinite(stop.brake_on_mps))
        reject(fmt::format("brake-on speed {} m/s is not positive", stop.brake_on_mps));
    if (!(stop.brake_gain_m3 > 0.0) || !std::isfinite(stop.brake_gain_m3))
        reject(fmt::format("brake gain {} m3 is not positive", stop.brake_gain_m3));
    for (std::size_t i = 0; i < stop.samples.size(); ++i) {
        const BrakeSample& s = stop.samples[i];
        if (!std::isfinite(s.time_s) || !std::isfinite(s.speed_mps) || !std::isfinite(s.pressure_Pa) || !std::isfinite(s.brake_torque_Nm))
            reject(fmt::format("sample {}: time, speed, pressure and torque must be finite numbers", i + 1));
        if (i > 0 && s.time_s < stop.samples[i - 1].time_s)
            reject(fmt::format("sample {}: time {} s is before that of the sample ahead of it, {} s", i + 1, s.time_s, stop.samples[i - 1].time_s));
    }
}

double median_pressure_Pa(const RecordedStop& stop) {
    // Transducers read a little below zero at rest; what brakes is above.
    std::vector<double> pressures;
    pressures.reserve(stop.samples.size());
    for (const BrakeSample& s : stop.samples)
        if (s.speed_mps < stop.brake_on_mps && s.pressure_Pa > 0.0) pressures.push_back(s.pressure_Pa);
    return study::median(std::move(pressures));
}

/// Sum over k of b_k (x^k - 1 / (k + 1)) + 1 as powers of x; d(curve) = T d(b).
Eigen::Matrix<double, 4, 3> to_powers() {
    Eigen::Matrix<double, 4, 3> t = Eigen::Matrix<double, 4, 3>::Zero();
    for (int k = 1; k <= 3; ++k) {
        t(0, k - 1) = -1.0 / (k + 1);
        t(k, k - 1) = 1.0;
    }
    return t;
}

Eigen::Vector4d powers(double x) {
    return {1.0, x, x * x, x * x * x};
}

struct Grouping {
    bool by_stops = true;
    std::size_t groups = 0;
};

Grouping grouping_of(std::size_t stops, const DynamicsSettings& settings) {
    if (stops >= std::max<std::size_t>(settings.min_stops, 2)) return {true, std::min(stops, kMaxGroups)};
    return {false, kBandGroups};
}

std::size_t group_of(const Grouping& grouping, std::size_t stop, double x) {
    if (grouping.by_stops) return stop % grouping.groups;
    const auto band = static_cast<std::size_t>(std::clamp(x, 0.0, 0.999999) * static_cast<double>(kSpeedBands));
    return (band + stop) % grouping.groups;
}

/// Fits with each group left out, for one order.
struct LeaveOut {
    std::vector<Eigen::Vector3d> b;
    std::vector<double> losses;
};

LeaveOut leave_out(const std::vector<CurveSample>& samples, std::size_t stops, std::size_t order, std::size_t groups, double scale) {
    LeaveOut out;
    for (std::size_t g = 0; g < groups; ++g) {
        out.b.push_back(fit_curve(samples, stops, order, g).b);
        out.losses.push_back(loss_of_group(samples, stops, g, out.b.back(), scale));
    }
    return out;
}

double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double v : values) sum += v;
    return sum / static_cast<double>(values.size());
}

std::vector<OrderLoss> losses_of(const std::vector<LeaveOut>& tried) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < tried.size(); ++k)
        if (mean(tried[k].losses) < mean(tried[best].losses)) best = k;
    std::vector<OrderLoss> out;
    out.reserve(tried.size());
    for (std::size_t k = 0; k < tried.size(); ++k) {
        const std::size_t n = tried[k].losses.size();
        std::vector<double> excess(n);
        for (std::size_t g = 0; g < n; ++g) excess[g] = tried[k].losses[g] - tried[best].losses[g];
        const double centre = mean(excess);
        double squares = 0.0;
        for (const double e : excess) squares += (e - centre) * (e - centre);
        const auto count = static_cast<double>(n);
        out.push_back({k, mean(tried[k].losses), std::sqrt(squares / (count - 1.0) / count)});
    }
    return out;
}

std::size_t chosen_order(const std::vector<OrderLoss>& orders) {
    double best = orders.front().loss;
    for (const OrderLoss& o : orders) best = std::min(best, o.loss);
    for (const OrderLoss& o : orders)
        if (o.loss - best <= o.excess_error) return o.order;
    return orders.back().order;
}

Eigen::Matrix3d jackknife(const std::vector<Eigen::Vector3d>& b) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& v : b) centre += v / static_cast<double>(b.size());
    Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& v : b) out += (v - centre) * (v - centre).transpose();
    const auto n = static_cast<double>(b.size());
    return out * ((n - 1.0) / n);
}

void take_over(const CurveFit& fit, const Eigen::Matrix3d& covariance, FrictionDynamics& out) {
    const Eigen::Matrix<double, 4, 3> t = to_powers();
    const Eigen::Vector4d curve = Eigen::Vector4d::UnitX() + t * fit.b;
    const Eigen::Matrix4d spread = t * covariance * t.transpose();
    for (std::size_t i = 0; i < 4; ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        out.curve[i] = curve[row];
        for (std::size_t j = 0; j < 4; ++j) out.covariance[i][j] = spread(row, static_cast<Eigen::Index>(j));
        out.half_width[i] = out.quantile * std::sqrt(std::max(spread(row, row), 0.0));
    }
}

void check_positive(const FrictionDynamics& found, const std::string& source) {
    constexpr int kParts = 256;
    for (int i = 0; i <= kParts; ++i) {
        const double x = static_cast<double>(i) / kParts;
        if (found.at(x) <= 0.0)
            throw Error(source, 0, "",
                        fmt::format("the curve falls to {:.3f} at x = {:.2f}: no brake is like that; check columns and "
                                    "units, or allow a lower order only",
                                    found.at(x), x));
    }
}

}  // namespace

double FrictionDynamics::at(double x) const {
    return curve[0] + x * (curve[1] + x * (curve[2] + x * curve[3]));
}

double FrictionDynamics::half_width_at(double x) const {
    const Eigen::Vector4d p = powers(x);
    double variance = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) variance += p[static_cast<Eigen::Index>(i)] * covariance[i][j] * p[static_cast<Eigen::Index>(j)];
    return quantile * std::sqrt(std::max(variance, 0.0));
}

std::vector<FrictionSample> friction_samples(const RecordedStop& stop, const DynamicsSettings& settings) {
    check(stop);
    const double median_Pa = median_pressure_Pa(stop);
    if (!(median_Pa > 0.0))
        throw Error(
            stop.source, 0, "",
            fmt::format("no pressure in any of its {} samples below the brake-on speed of {:.2f} m/s", stop.samples.size(), stop.brake_on_mps));
    std::vector<FrictionSample> out;
    for (const BrakeSample& s : stop.samples) {
        if (s.speed_mps > stop.brake_on_mps || s.speed_mps < settings.min_speed_mps) continue;
        if (s.pressure_Pa < settings.min_pressure_share * median_Pa) continue;
        out.push_back({s.speed_mps / stop.brake_on_mps, s.brake_torque_Nm / (stop.brake_gain_m3 * s.pressure_Pa)});
    }
    if (out.size() < kMinSamples)
        throw Error(stop.source, 0, "",
                    fmt::format("{} of its {} samples have pressure between {} m/s and the brake-on speed of "
                                "{:.2f} m/s; expected "
                                "at least {}",
                                out.size(), stop.samples.size(), settings.min_speed_mps, stop.brake_on_mps, kMinSamples));
    const auto [slowest, fastest] = std::minmax_element(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
    if (fastest->x - slowest->x < kMinSpan)
        throw Error(stop.source, 0, "",
                    fmt::format("its speeds cover {:.2f} to {:.2f} of the brake-on speed only; expected a "
                                "stop over at least half "
                                "of it",
                                slowest->x, fastest->x));
    std::vector<double> mu;
    mu.reserve(out.size());
    for (const FrictionSample& s : out) mu.push_back(s.mu_b);
    const double middle = study::median(std::move(mu));
    if (!(middle >= kMinInStop && middle <= kGreatestInStop))
        throw Error(stop.source, 0, "",
                    fmt::format("mu_b is {:.4g} in the middle, expected {} to {}: check the units of torque "
                                "and pressure, and the "
                                "brake's geometry ({:.4g} m3)",
                                middle, kMinInStop, kGreatestInStop, stop.brake_gain_m3));
    if (out.size() <= settings.max_samples) return out;
    const std::size_t every = (out.size() + settings.max_samples - 1) / settings.max_samples;
    std::vector<FrictionSample> thinned;
    thinned.reserve(settings.max_samples);
    for (std::size_t i = 0; i < out.size(); i += every) thinned.push_back(out[i]);
    return thinned;
}

FrictionDynamics learn_dynamics(const std::vector<RecordedStop>& stops, const DynamicsSettings& settings) {
    if (stops.empty()) throw Error("friction dynamics", 0, "", "no stop to learn from");
    FrictionDynamics out;
    std::vector<std::vector<FrictionSample>> data;
    data.reserve(stops.size());
    out.stops.reserve(stops.size());
    for (const RecordedStop& stop : stops) {
        data.push_back(friction_samples(stop, settings));
        out.stops.push_back({stop.source, stop.brake_on_mps, 0.0, data.back().size(), 0.0, true});
    }
    const std::size_t highest = std::min<std::size_t>(settings.highest_order, 3);
    for (;;) {
        // Only stops that are used count, from 0 on.
        std::vector<std::size_t> used;
        for (std::size_t i = 0; i < stops.size(); ++i)
            if (out.stops[i].used) used.push_back(i);
        if (used.empty())
            throw Error(stops.front().source, 0, "",
                        "no stop follows a curve that it shares with the others: more than half of every "
                        "stop's samples lie far off");
        const Grouping grouping = grouping_of(used.size(), settings);
        std::vector<CurveSample> samples;
        for (std::size_t j = 0; j < used.size(); ++j)
            for (const FrictionSample& s : data[used[j]]) samples.push_back({s.x, s.mu_b, j, group_of(grouping, j, s.x)});
        const CurveFit widest = fit_curve(samples, used.size(), highest);
        const std::vector<double> rejected = rejected_shares(samples, widest);
        bool again = false;
        for (std::size_t j = 0; j < used.size(); ++j) {
            StopShape& shape = out.stops[used[j]];
            shape.mean_friction = widest.means[j];
            shape.rejected = rejected[j];
            shape.used = rejected[j] <= kMaxRejected;
            again = again || !shape.used;
        }
        if (again) continue;
        std::vector<LeaveOut> tried;
        tried.reserve(highest + 1);
        for (std::size_t order = 0; order <= highest; ++order) tried.push_back(leave_out(samples, used.size(), order, grouping.groups, widest.scale));
        out.orders = losses_of(tried);
        out.order = chosen_order(out.orders);
        const CurveFit fit = fit_curve(samples, used.size(), out.order);
        for (std::size_t j = 0; j < used.size(); ++j) out.stops[used[j]].mean_friction = fit.means[j];
        out.scale = fit.scale;
        out.by_stops = grouping.by_stops;
        out.groups = grouping.groups;
        constexpr double kUpper = 0.975;
        out.quantile = boost::math::quantile(boost::math::students_t_distribution<double>(static_cast<double>(grouping.groups - 1)), kUpper);
        take_over(fit, jackknife(tried[out.order].b), out);
        check_positive(out, stops.front().source);
        return out;
    }
}

}  // namespace wear
