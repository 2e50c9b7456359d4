/// Writes the loop's records to the log: changes of state, faults, link and synchronisation as they happen, and a summary on request. A change that
/// keeps recurring is logged three times between two summaries, then only counted; it is logged again after a summary interval without it. May block:
/// not for the loop's thread.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "firmware/host/cycle_record.hpp"

namespace spdlog {
class logger;
}

namespace antiskid::controller {

class Telemetry {
  public:
    /// `interface` is the name in messages; `logger` must outlive this.
    Telemetry(spdlog::logger& logger, std::string interface);

    /// Empties the ring and logs every change since the last record.
    void drain(host::CycleRing& ring);

    /// Number of the newest cycle read from the ring; 0 before the first.
    [[nodiscard]] std::uint64_t cycles() const { return last_.step; }

    /// Logs one line about the records since the last summary, also if there were none.
    void summarise(const host::CycleRing& ring);

  private:
    void on_record(const host::CycleRecord& record);
    void report_faults(const host::CycleRecord& record);
    void report_link(const host::CycleRecord& record);
    [[nodiscard]] bool suppressed(const std::string& what);

    spdlog::logger& logger_;
    std::string interface_;
    host::CycleRecord last_;
    std::uint64_t steps_ = 0;
    std::uint64_t missed_ = 0;
    control::Time worst_latency_{};
    std::uint64_t dropped_ = 0;
    std::map<std::string, std::uint64_t> changes_;  // number since the last summary, by state, fault, link or SYNC
    std::set<std::string> flaps_;                   // those that recurred in the last summary interval
    std::uint64_t suppressed_count_ = 0;
};

}  // namespace antiskid::controller
