#include "plant_sim/endurance/outcome_summary.hpp"

#include "firmware/can/names.hpp"
#include "firmware/can/value_names.hpp"

namespace endurance {

rig::record::Summary summary_of(const rig::record::Summary& head, const Outcome& outcome, const std::vector<rig::Band>& bands) {
    rig::record::Summary summary = head;
    const bool finished = outcome.phase == rig::Phase::finished;
    summary.outcome = finished ? name(outcome.phase) : name(outcome.abort);
    summary.figures = outcome.figures;
    summary.warnings = outcome.warnings;
    summary.cumulative_energy_J += outcome.figures.energy_brake_J;
    summary.faults = antiskid::can::fault_names(outcome.faults);
    if (finished && !bands.empty()) summary.out_of_tolerance = rig::out_of_tolerance(bands, summary.figures);
    return summary;
}

}  // namespace endurance
