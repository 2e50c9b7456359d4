#include "plant_sim/wear/fault_trial.hpp"

#include <algorithm>
#include <array>

#include "rig_bridge/wear/draw.hpp"

namespace wear {

std::size_t flagged_at(const Population& population, const Campaign& campaign) {
    HealthMonitor monitor(population);
    for (std::size_t i = 0; i < campaign.points.size(); ++i)
        if (monitor.after(campaign.points[i]).condition == Condition::abnormal) return i;
    return campaign.points.size();
}

const char* name(BrakeFault fault) {
    constexpr std::array kNames{"glazing", "sudden drop", "piston drag"};
    return kNames.at(static_cast<std::size_t>(fault));
}

Campaign with_fault(const Campaign& healthy, BrakeFault fault, double size, std::size_t begin) {
    Campaign out = healthy;
    for (std::size_t i = begin; i < out.points.size(); ++i) {
        const double grown =
            fault == BrakeFault::glazing ? std::min(1.0, static_cast<double>(i - begin + 1) / static_cast<double>(kGlazingManeuvers)) : 1.0;
        out.points[i].mean_friction *= fault == BrakeFault::drag ? 1.0 + size : 1.0 - size * grown;
    }
    return out;
}

HealthyTrial try_healthy(const Population& population, const std::vector<Campaign>& healthy) {
    HealthyTrial out;
    for (const Campaign& c : healthy) {
        HealthMonitor monitor(population);
        bool flagged = false;
        for (const Point& p : c.points) {
            const Condition condition = monitor.after(p).condition;
            flagged = flagged || condition == Condition::abnormal;
            out.suspected_maneuvers += condition == Condition::suspect ? 1 : 0;
        }
        ++out.campaigns;
        out.maneuvers += c.points.size();
        out.flagged += flagged ? 1 : 0;
    }
    return out;
}

FaultTrial try_fault(const Population& population, const std::vector<Campaign>& healthy, BrakeFault fault, double size, std::uint64_t seed) {
    FaultTrial out{fault, size};
    std::vector<std::size_t> delays;
    for (std::size_t k = 0; k < healthy.size(); ++k) {
        Generator generator = generator_of(seed, k);
        const auto n = static_cast<double>(healthy[k].points.size());
        const auto begin = static_cast<std::size_t>(n * (0.2 + 0.5 * uniform(generator)));
        const std::size_t at = flagged_at(population, with_fault(healthy[k], fault, size, begin));
        if (at < begin) continue;
        ++out.campaigns;
        if (at < healthy[k].points.size()) delays.push_back(at - begin + 1);
    }
    std::sort(delays.begin(), delays.end());
    out.flagged = delays.size();
    const auto at_share = [&](double share) {
        const auto i = static_cast<std::size_t>(share * static_cast<double>(out.campaigns));
        return i < delays.size() ? delays[i] : 0;
    };
    out.median = at_share(0.5);
    out.ninety = at_share(0.9);
    return out;
}

}  // namespace wear
