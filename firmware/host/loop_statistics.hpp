/// What a run of the loop amounts to. Written by the loop's thread only; read once that has ended.
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
    Histogram overrun;  ///< of steps that came after missed periods: how late, counted from the first one missed

    std::uint64_t steps = 0;
    std::uint64_t overruns = 0;  ///< steps that came after missed periods
    std::uint64_t missed_periods = 0;
    std::uint64_t unsynchronised = 0;  ///< lockstep: steps taken without SYNC
    std::uint64_t by_timer = 0;        ///< by the sensors: steps taken without their frame
    std::uint64_t link_outages = 0;    ///< times that the link went down, vanished or went bus-off
    std::uint64_t frames_received = 0;
    std::uint64_t frames_sent = 0;
    std::uint64_t frames_unsent = 0;       ///< not taken by the bus: queue full or link down
    std::uint64_t full_drains = 0;         ///< periods that ended with frames left unread on the bus
    std::uint32_t safe_commands_sent = 0;  ///< the closing ones

    control::State last_state = control::State::self_test;
    std::array<std::uint64_t, control::kStateCount> steps_in_state{};
    control::FaultSet faults_seen;
    std::array<control::Time, control::kFaultCount> first_seen{};  ///< valid for those in `faults_seen`

    /// Everything that one period adds, except the frames that were sent.
    void add(const CycleRecord& record);

  private:
    bool link_was_good_ = true;
};

}  // namespace antiskid::host
