#include "plant_sim/simulation/fault_timeline.hpp"

#include <algorithm>

namespace plant_sim::simulation {

using antiskid::control::Time;

FaultTimeline::FaultTimeline(std::span<const PlannedFault> faults) {
    for (const PlannedFault& fault : faults) faults_.push_back({.planned = fault});
}

void FaultTimeline::reached(rig::Phase phase, std::int64_t attempt, Time now) {
    for (Fault& fault : faults_)
        if (!fault.begins && fault.planned.phase == phase && attempt >= fault.planned.attempt) fault.begins = now + duration(fault.planned.after_s);
}

bool FaultTimeline::advance(Time now, const Change& change) {
    bool changed = false;
    for (Fault& fault : faults_) {
        if (!fault.begins || fault.over) continue;
        const double lasts_s = of_disk(fault.planned.fault) ? kMaxWait_s : fault.planned.lasts_s;
        const bool active = now >= *fault.begins && now < *fault.begins + duration(lasts_s);
        if (active == fault.active) continue;
        changed = true;
        fault.active = active;
        fault.over = !active;
        change(fault.planned, active);
    }
    return changed;
}

bool FaultTimeline::any() const {
    return std::any_of(faults_.begin(), faults_.end(), [](const Fault& fault) { return fault.active; });
}

std::vector<PlannedFault> FaultTimeline::active() const {
    std::vector<PlannedFault> all;
    for (const Fault& fault : faults_)
        if (fault.active) all.push_back(fault.planned);
    return all;
}

}  // namespace plant_sim::simulation
