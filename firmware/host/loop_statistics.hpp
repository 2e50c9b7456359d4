/// Statistics of one run of the loop. Written by the loop's thread; read after it has ended.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/control/types.hpp"
#include "firmware/host/cycle_record.hpp"
#include "firmware/host/histogram.hpp"

namespace antiskid::host {

struct LoopStatistics {
    Histogram period;   ///< from one wake-up to the next
    Histogram latency;  ///< CycleRecord::latency
    Histogram work;     ///< CycleRecord::work
    Histogram edge_to_command;
    Histogram overrun;  ///< delay of steps after missed periods, from the first missed deadline

    std::uint64_t steps = 0;
    std::uint64_t overruns = 0;  ///< steps that came after missed periods
    std::uint64_t missed_periods = 0;
    std::uint64_t unsynchronised = 0;  ///< lockstep: steps taken without SYNC
    std::uint64_t by_timer = 0;        ///< clock `sensors`: steps taken without the sensor frame
    std::uint64_t link_outages = 0;    ///< number of times that the link went down, disappeared or went bus-off
    std::uint64_t frames_received = 0;
    std::uint64_t frames_sent = 0;
    std::uint64_t frames_unsent = 0;       ///< not taken by the bus: queue full or link down
    std::uint64_t full_drains = 0;         ///< periods that ended with frames left unread on the bus
    std::uint32_t safe_commands_sent = 0;  ///< at the end of run()

    control::State last_state = control::State::self_test;
    std::array<std::uint64_t, control::kStateCount> steps_in_state{};
    control::FaultSet faults_seen;
    std::array<control::Time, control::kFaultCount> first_seen{};  ///< valid for those in `faults_seen`

    /// Adds one period, except the frames that were sent.
    void add(const CycleRecord& record);

  private:
    bool link_was_good_ = true;
};

}  // namespace antiskid::host
