/// One Kalman filter of life_curves.hpp, for a life that is known: shared by the learning and by LifeFilter.
#pragma once

#include <Eigen/Dense>
#include <numeric>

#include "rig_bridge/wear/life_filter.hpp"

namespace wear::life {

inline constexpr auto kSize = static_cast<Eigen::Index>(LifeFilter::kStates);
inline constexpr auto kKnots = static_cast<Eigen::Index>(kCurve);
using State = Eigen::Matrix<double, kSize, 1>;
using Covariance = Eigen::Matrix<double, kSize, kSize>;
inline constexpr Eigen::Index kRemembered = kKnots, kSlope = kKnots + 1;
using Values = Eigen::Matrix<double, kKnots, 1>;
using ValuesCovariance = Eigen::Matrix<double, kKnots, kKnots>;

/// Value of a piecewise linear curve.
template <typename Curve>
double at(const Curve& curve, const KnotPlace& place) {
    const auto k = static_cast<Eigen::Index>(place.knot);
    return curve(k) + place.next * (curve(k + 1) - curve(k));
}

/// What is seen of a state there: its value, and the covariances of the state with it.
template <typename Any>
double seen(const Any& x, const KnotPlace& place) {
    return at(x, place) + x(kRemembered);
}
template <typename Any>
State seen_of(const Any& covariance, const KnotPlace& place) {
    const auto k = static_cast<Eigen::Index>(place.knot);
    return covariance.col(k) * (1.0 - place.next) + covariance.col(k + 1) * place.next + covariance.col(kRemembered);
}

inline double of(const std::array<double, kEnergiesBefore>& by, const std::array<double, kEnergiesBefore>& energies) {
    return std::inner_product(by.begin(), by.end(), energies.begin(), 0.0);
}

inline void come(std::array<double, kEnergiesBefore>& energies, double relative) {
    std::copy_backward(energies.begin(), energies.end() - 1, energies.end());
    energies.front() = relative;
}

inline Covariance prior(const LifeCurves& c) {
    Covariance out = Covariance::Zero();
    out.topLeftCorner<kKnots, kKnots>() = Eigen::Map<const ValuesCovariance>(c.covariance.front().data());
    out(kRemembered, kRemembered) = c.remembered * c.remembered;
    out.row(kSlope).head<kKnots>() = Eigen::Map<const Values>(c.lining.with_curve.data());
    out.col(kSlope).head<kKnots>() = Eigen::Map<const Values>(c.lining.with_curve.data());
    out(kSlope, kSlope) = c.lining.variance;
    return out;
}

struct Innovation {
    double off = 0.0, variance = 0.0;
};
/// Friction less what energies did, and the way to the next maneuver.
template <typename X, typename P>
Innovation update(X&& state, P&& covariance, const KnotPlace& place, double friction, const LifeCurves& c) {
    const State gain = seen_of(covariance, place);
    const double variance = seen(gain, place) + c.fresh * c.fresh;
    const double off = friction - seen(state, place);
    state += gain * (off / variance);
    covariance -= gain * (gain / variance).transpose();
    state(kRemembered) *= c.memory;
    covariance.row(kRemembered) *= c.memory;
    covariance.col(kRemembered) *= c.memory;
    covariance(kRemembered, kRemembered) += (1.0 - c.memory * c.memory) * c.remembered * c.remembered;
    return {off, variance};
}

/// A reading of the lining at the share `share` of life.
template <typename X, typename P>
Innovation read(X&& state, P&& covariance, double share, double worn, const LifeCurves& c) {
    const State gain = covariance.col(kSlope) * share;
    const double variance = gain(kSlope) * share + c.lining.error * c.lining.error;
    const double off = worn - state(kSlope) * share;
    state += gain * (off / variance);
    covariance -= gain * (gain / variance).transpose();
    return {off, variance};
}

}  // namespace wear::life
