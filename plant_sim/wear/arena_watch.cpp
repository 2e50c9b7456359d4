#include "plant_sim/wear/arena_watch.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "plant_sim/wear/fault_trial.hpp"
#include "rig_bridge/wear/health.hpp"
#include "rig_bridge/wear/health_limits.hpp"

namespace wear::arena {

namespace {

constexpr std::size_t kWindow = 10;

/// After landing `i`.
double difference(const Campaign& campaign, std::size_t i) {
    if (i + 1 < 2 * kWindow) return 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < kWindow; ++k) sum += campaign.points[i - k].mean_friction - campaign.points[i - kWindow - k].mean_friction;
    return std::abs(sum) / kWindow;
}

/// Index of the landing after which the life is called abnormal; its size: never.
using Alarm = std::function<std::size_t(const Campaign&)>;

Found found(const Alarm& alarm, const std::vector<Campaign>& lives, std::uint64_t seed) {
    Found out;
    const auto within = [&](double size) {
        double soon = 0.0, asked = 0.0;
        for (std::size_t k = 0; k < lives.size(); ++k) {
            Generator generator = generator_of(seed + k, 9000);
            const auto begin = static_cast<std::size_t>(static_cast<double>(lives[k].points.size()) * (0.2 + 0.5 * uniform(generator)));
            const std::size_t at = alarm(with_fault(lives[k], BrakeFault::glazing, size, begin));
            if (at < begin) continue;
            asked += 1.0;
            soon += at < begin + kSoon ? 1.0 : 0.0;
        }
        return asked > 0.0 ? soon / asked : 0.0;
    };
    for (const Campaign& life : lives) out.healthy += alarm(life) < life.points.size() ? 1.0 / static_cast<double>(lives.size()) : 0.0;
    out.glazing_10 = within(0.10);
    out.glazing_5 = within(0.05);
    return out;
}

}  // namespace

WatchScore judge_watch(Law law, const Settings& settings, const Population& population, std::uint64_t first, std::size_t lives) {
    constexpr std::uint64_t kAfterTraining = 10'000;  // seeds
    Population known = population;
    known.limits = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
    std::vector<HealthLimits> greatest;
    std::vector<double> differences;
    for (std::uint64_t k = 0; k < kLimitLives; ++k) {
        const Campaign life = live(law, settings, settings.training + kAfterTraining + k).campaign;
        HealthMonitor monitor(known);
        double most = 0.0;
        for (std::size_t i = 0; i < life.points.size(); ++i) {
            (void)monitor.after(life.points[i]);
            most = std::max(most, difference(life, i));
        }
        greatest.push_back(monitor.greatest());
        differences.push_back(most);
    }
    known.limits = calibrated(greatest);
    std::sort(differences.begin(), differences.end());
    const double limit = differences[differences.size() - static_cast<std::size_t>(kFalseAlarms * kLimitLives)];
    std::vector<Campaign> judged;
    for (std::uint64_t k = 0; k < lives; ++k) judged.push_back(live(law, settings, first + k).campaign);
    const Alarm watch = [&](const Campaign& life) { return flagged_at(known, life); };
    const Alarm by_difference = [&](const Campaign& life) {
        std::size_t i = 0;
        while (i < life.points.size() && difference(life, i) < limit) ++i;
        return i;
    };
    return {found(watch, judged, first), found(by_difference, judged, first)};
}

}  // namespace wear::arena
