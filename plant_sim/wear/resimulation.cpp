#include "plant_sim/wear/resimulation.hpp"

#include <algorithm>
#include <cmath>

namespace wear {

namespace {

constexpr std::size_t kEnergyBands = 10;

double energy_before_J(const Campaign& campaign, std::size_t i) {
    return i == 0 ? taken_before_J(campaign) : campaign.points[i - 1].c_e_J;
}

struct BandMoments {
    double n = 0.0, sum = 0.0, squares = 0.0;
    void add(double value) {
        n += 1.0;
        sum += value;
        squares += value * value;
    }
    [[nodiscard]] double mean() const { return sum / n; }
    [[nodiscard]] double deviation() const { return std::sqrt(std::max(0.0, squares / n - mean() * mean())); }
};

std::vector<double> frictions(const Campaign& campaign) {
    std::vector<double> out;
    out.reserve(campaign.points.size());
    for (const Point& p : campaign.points) out.push_back(p.mean_friction);
    std::sort(out.begin(), out.end());
    return out;
}

/// Greatest difference of the two empirical distribution functions; both sorted.
double ks_distance(const std::vector<double>& a, const std::vector<double>& b) {
    std::size_t i = 0;
    std::size_t j = 0;
    double greatest = 0.0;
    while (i < a.size() && j < b.size()) {
        const double x = std::min(a[i], b[j]);
        while (i < a.size() && a[i] <= x) ++i;
        while (j < b.size() && b[j] <= x) ++j;
        greatest = std::max(
            greatest, std::abs(static_cast<double>(i) / static_cast<double>(a.size()) - static_cast<double>(j) / static_cast<double>(b.size())));
    }
    return greatest;
}

}  // namespace

double ks_probability(double distance, std::size_t n, std::size_t m) {
    const double root = std::sqrt(static_cast<double>(n) * static_cast<double>(m) / static_cast<double>(n + m));
    const double l = (root + 0.12 + 0.11 / root) * distance;
    if (l < 0.2) return 1.0;  // 1 to 12 digits; the series converges too slowly there
    double sum = 0.0;
    for (int k = 1; k <= 100; ++k) sum += (k % 2 == 1 ? 2.0 : -2.0) * std::exp(-2.0 * k * k * l * l);
    return std::clamp(sum, 0.0, 1.0);
}

Campaign resimulated(const Campaign& recorded, const Model& model, const ConditionalRule& rule, std::uint64_t seed) {
    Campaign out;
    out.source = recorded.source + ", simulated";
    out.points.reserve(recorded.points.size());
    for (std::size_t i = 0; i < recorded.points.size(); ++i) {
        Generator generator = generator_of(seed, i);
        out.points.push_back({recorded.points[i].c_e_J, friction_at(model, {}, rule, energy_before_J(recorded, i), generator)});
    }
    return out;
}

Comparison compare(const Campaign& recorded, const Campaign& simulated, const Model& model, const ConditionalRule& rule) {
    constexpr double kTail = 0.05;
    Comparison out;
    const double first_J = recorded.points.front().c_e_J;
    const double width_J = (recorded.points.back().c_e_J - first_J) / static_cast<double>(kEnergyBands);
    std::vector<BandMoments> real(kEnergyBands);
    std::vector<BandMoments> drawn(kEnergyBands);
    std::vector<double> within(kEnergyBands, 0.0);
    for (std::size_t i = 0; i < recorded.points.size(); ++i) {
        const Point& p = recorded.points[i];
        const std::size_t band = std::min(kEnergyBands - 1, static_cast<std::size_t>((p.c_e_J - first_J) / width_J));
        real[band].add(p.mean_friction);
        drawn[band].add(simulated.points[i].mean_friction);
        const double place = friction_given_energy(model, energy_before_J(recorded, i), rule).cumulative(p.mean_friction);
        within[band] += place >= kTail && place <= 1.0 - kTail ? 1.0 : 0.0;
    }
    double all_within = 0.0;
    out.bands.reserve(kEnergyBands);
    for (std::size_t b = 0; b < kEnergyBands; ++b) {
        EnergyBand band{first_J + width_J * static_cast<double>(b), first_J + width_J * static_cast<double>(b + 1)};
        if (real[b].n > 0.0) {
            band.maneuvers = static_cast<std::size_t>(real[b].n);
            band.mean_error = drawn[b].mean() - real[b].mean();
            band.deviation_recorded = real[b].deviation();
            band.deviation_simulated = drawn[b].deviation();
            band.coverage_90 = within[b] / real[b].n;
        }
        out.bands.push_back(band);
        all_within += within[b];
    }
    out.coverage_90 = all_within / static_cast<double>(recorded.points.size());
    out.ks_distance = ks_distance(frictions(recorded), frictions(simulated));
    out.ks_probability = ks_probability(out.ks_distance, recorded.points.size(), simulated.points.size());
    return out;
}

}  // namespace wear
