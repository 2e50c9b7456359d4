#include "firmware/host/loop_statistics.hpp"

namespace antiskid::host {

void LoopStatistics::add(const CycleRecord& record) {
    ++steps;
    latency.add(record.latency);
    if (record.work) work.add(*record.work);
    if (record.edge_to_command) edge_to_command.add(*record.edge_to_command);
    if (record.skipped > 0) {
        ++overruns;
        missed_periods += record.skipped;
        overrun.add(record.latency);
    }
    if (!record.synchronised) ++unsynchronised;
    if (record.by_timer) ++by_timer;
    frames_received += record.received;
    frames_unsent += record.unsent;

    const bool link_good = record.link.up && !record.link.bus_off;
    if (link_was_good_ && !link_good) ++link_outages;
    link_was_good_ = link_good;

    last_state = record.command.state;
    if (const auto state = static_cast<std::size_t>(last_state); state < steps_in_state.size()) ++steps_in_state[state];
    if ((record.command.faults.bits() & ~faults_seen.bits()) == 0) return;
    for (std::uint8_t number = 0; number < control::kFaultCount; ++number) {
        const auto fault = static_cast<control::Fault>(number);
        if (record.command.faults.contains(fault) && !faults_seen.contains(fault)) first_seen[number] = record.now;
    }
    faults_seen.insert(record.command.faults);
}

}  // namespace antiskid::host
