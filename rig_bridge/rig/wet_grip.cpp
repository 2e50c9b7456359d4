#include "rig_bridge/rig/wet_grip.hpp"

#include <cmath>
#include <span>
#include <stdexcept>

namespace rig {

namespace {

constexpr double kKnot_mps = 1852.0 / 3600.0;

/// mu_max = sum of powers[i] (V / 100 knots)^i.
struct Printed {
    double tyre_pressure_psi;
    std::array<double, 6> powers;
};
constexpr std::array<Printed, 4> kSmooth{{{50.0, {0.883, -0.851, 0.306, -0.0350}},
                                          {100.0, {0.804, -0.805, 0.320, -0.0437}},
                                          {200.0, {0.692, -0.658, 0.252, -0.0331}},
                                          {300.0, {0.614, -0.611, 0.263, -0.0401}}}};
constexpr std::array<Printed, 4> kGrooved{{{50.0, {0.859, 0.403, -2.683, 2.673, -1.05, 0.1470}},
                                           {100.0, {0.807, 0.317, -2.20, 2.13, -0.813, 0.1106}},
                                           {200.0, {0.701, 0.140, -1.285, 1.140, -0.398, 0.0498}},
                                           {300.0, {0.614, -0.00954, -0.779, 0.703, -0.247, 0.0314}}}};

std::array<double, 6> between(std::span<const Printed> curves, double tyre_pressure_psi) {
    std::size_t upper = 1;
    while (upper + 1 < curves.size() && curves[upper].tyre_pressure_psi < tyre_pressure_psi) ++upper;
    const Printed &a = curves[upper - 1], &b = curves[upper];
    const double share = (tyre_pressure_psi - a.tyre_pressure_psi) / (b.tyre_pressure_psi - a.tyre_pressure_psi);
    std::array<double, 6> powers{};
    for (std::size_t i = 0; i < powers.size(); ++i) powers[i] = a.powers[i] + share * (b.powers[i] - a.powers[i]);
    return powers;
}

}  // namespace

WetGrip::WetGrip(double tyre_pressure_psi, Texture texture, std::optional<double> flooded_mu)
    : tyre_pressure_psi_(tyre_pressure_psi), flooded_mu_(flooded_mu) {
    if (!(tyre_pressure_psi >= kMinPressure_psi && tyre_pressure_psi <= kMaxPressure_psi))
        throw std::invalid_argument("wet runway: tyre pressure must be 50 to 300 psi");
    constexpr double kMaxAfloat = 0.1;
    if (flooded_mu && !(*flooded_mu >= 0.0 && *flooded_mu <= kMaxAfloat))
        throw std::invalid_argument("flooded runway: friction above the hydroplaning speed must be 0 to 0.1");
    powers_ = between(texture == Texture::smooth ? kSmooth : kGrooved, tyre_pressure_psi);
}

WetGrip::Peak WetGrip::at(double v_mps, bool spun_up) const {
    const double x = v_mps / (100.0 * kKnot_mps);
    double mu = 0.0, mu_x = 0.0;
    for (std::size_t i = powers_.size(); i-- > 0;) {
        mu_x = mu_x * x + mu;
        mu = mu * x + powers_[i];
    }
    const Peak wet{mu, mu_x / (100.0 * kKnot_mps)};
    if (!flooded_mu_) return wet;
    constexpr double kLeaves = 0.85;
    const double afloat_mps = hydroplaning_mps(spun_up);
    const double width_mps = (1.0 - kLeaves) * afloat_mps;
    const double s = (v_mps - kLeaves * afloat_mps) / width_mps;
    if (s <= 0.0) return wet;
    if (s >= 1.0) return {*flooded_mu_, 0.0};
    const double share = s * s * (3.0 - 2.0 * s);
    const double share_v = 6.0 * s * (1.0 - s) / width_mps;
    return {wet.mu + share * (*flooded_mu_ - wet.mu), wet.mu_v + share_v * (*flooded_mu_ - wet.mu) - share * wet.mu_v};
}

double WetGrip::hydroplaning_mps(bool spun_up) const {
    return (spun_up ? 9.0 : 7.7) * std::sqrt(tyre_pressure_psi_) * kKnot_mps;
}

}  // namespace rig
