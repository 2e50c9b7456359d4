#include "plant_sim/study/margins/trial_stops.hpp"

#include <algorithm>
#include <numeric>

#include "plant_sim/study/side_by_side.hpp"

namespace study::margins {

namespace {

/// Counts stops that have not been made as perfect.
void judge(StopsShown& shown, const TrialStops& trial, const std::vector<double>& j_mu) {
    const std::size_t groups = trial.groups.size();
    std::vector<double> sum(groups, 0.0), count(groups, 0.0);
    for (std::size_t i = 0; i < trial.stops.size(); ++i) {
        if (!trial.stops[i].friction_counts) continue;
        sum[trial.stops[i].group] += j_mu[i];
        count[trial.stops[i].group] += 1.0;
    }
    const auto over_surfaces = [&](const std::vector<double>& of) {
        return std::accumulate(of.begin(), of.begin() + static_cast<std::ptrdiff_t>(trial.surfaces), 0.0);
    };
    shown.mean_j_mu = over_surfaces(sum) / over_surfaces(count);
    shown.violation = std::max(0.0, trial.requirement.mean_j_mu - shown.mean_j_mu) +
                      std::max(0.0, shown.longest_lock_s - trial.requirement.longest_lock_s) +
                      std::max(0.0, trial.requirement.tracked_share - shown.min_tracked.value_or(0.0)) + (shown.faults ? 1.0 : 0.0);
    shown.group_j_mu.resize(groups);
    for (std::size_t g = 0; g < groups; ++g) {
        shown.group_j_mu[g] = sum[g] / count[g];
        shown.violation += std::max(0.0, trial.min_j_mu[g] - shown.group_j_mu[g]) / static_cast<double>(groups);
    }
}

}  // namespace

StopsShown make_stops(const TrialStops& trial, const antiskid::control::Config& controller, double max_violation) {
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
                shown.faults = shown.faults || !result.faults.empty();
                // On a drawn plant the reference may retreat, and ice between two patches may lock the wheel.
                if (trial.stops[first + number].group >= trial.surfaces) return;
                shown.longest_lock_s = std::max(shown.longest_lock_s, result.figures.longest_lock_s);
                const std::optional<double> tracked = result.figures.tracked_share;
                if (tracked) shown.min_tracked = std::min(*tracked, shown.min_tracked.value_or(1.0));
            });
        judge(shown, trial, j_mu);
        if (shown.violation > max_violation && end < trial.stops.size()) return shown;
        first = end;
    }
    shown.whole = true;
    return shown;
}

}  // namespace study::margins
