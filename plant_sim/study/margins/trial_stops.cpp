#include "plant_sim/study/margins/trial_stops.hpp"

#include <algorithm>
#include <numeric>

#include "plant_sim/study/side_by_side.hpp"

namespace study::margins {

namespace {

/// With stops that are not made yet taken as perfect.
void judge(StopsShown& shown, const TrialStops& trial, const std::vector<double>& j_mu) {
    const std::size_t surfaces = trial.surfaces.size();
    std::vector<double> sum(surfaces, 0.0), count(surfaces, 0.0);
    for (std::size_t i = 0; i < trial.stops.size(); ++i) {
        if (!trial.stops[i].friction_counts) continue;
        sum[trial.stops[i].surface] += j_mu[i];
        count[trial.stops[i].surface] += 1.0;
    }
    shown.mean_j_mu =
        std::accumulate(sum.begin(), sum.end(), 0.0) / std::accumulate(count.begin(), count.end(), 0.0);
    shown.violation = std::max(0.0, trial.requirement.mean_j_mu - shown.mean_j_mu) +
                      std::max(0.0, shown.longest_lock_s - trial.requirement.longest_lock_s) +
                      std::max(0.0, trial.requirement.tracked_share - shown.least_tracked.value_or(0.0)) +
                      (shown.faults ? 1.0 : 0.0);
    shown.surface_j_mu.resize(surfaces);
    for (std::size_t s = 0; s < surfaces; ++s) {
        shown.surface_j_mu[s] = sum[s] / count[s];
        shown.violation +=
            std::max(0.0, trial.least_j_mu[s] - shown.surface_j_mu[s]) / static_cast<double>(surfaces);
    }
}

}  // namespace

StopsShown make_stops(const TrialStops& trial, const antiskid::control::Config& controller,
                      double most_violation) {
    StopsShown shown;
    std::vector<double> j_mu(trial.stops.size(), 1.0);
    for (std::size_t first = 0; first < trial.stops.size();) {
        const std::size_t end = first < trial.first ? trial.first : trial.stops.size();
        std::size_t next = first;
        run_side_by_side(
            *trial.layout,
            [&]() -> std::optional<Maneuver> {
                if (next == end) return std::nullopt;
                const TrialStop& s = trial.stops[next++];
                return Maneuver{controller, s.rig, s.session};
            },
            [&](std::size_t number, const RunResult& result) {
                j_mu[first + number] = result.figures.j_mu;
                shown.longest_lock_s = std::max(shown.longest_lock_s, result.figures.longest_lock_s);
                const std::optional<double> tracked = result.figures.tracked_share;
                if (tracked) shown.least_tracked = std::min(*tracked, shown.least_tracked.value_or(1.0));
                shown.faults = shown.faults || !result.faults.empty();
            });
        judge(shown, trial, j_mu);
        if (shown.violation > most_violation && end < trial.stops.size()) return shown;
        first = end;
    }
    shown.whole = true;
    return shown;
}

}  // namespace study::margins
