/// The loop's records as log lines: changes of state, faults by name, link and synchronisation as they
/// happen, and a summary on request. What comes and goes all the time is said three times between two summaries, and then counted; in the
/// next ones it is counted alone, until one has gone by without it.
/// For the thread that is allowed to wait.
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

    /// Empties the ring and logs what has changed since the last record.
    void drain(host::CycleRing& ring);

    /// Number of the loop's newest cycle that was drained; 0 before the first.
    [[nodiscard]] std::uint64_t cycles() const { return last_.step; }

    /// One line on the records since the last summary; says so when there were none.
    void summarise(const host::CycleRing& ring);

  private:
    void on_record(const host::CycleRecord& record);
    void report_faults(const host::CycleRecord& record);
    void report_link(const host::CycleRecord& record);
    [[nodiscard]] bool often(const std::string& what);

    spdlog::logger& logger_;
    std::string interface_;
    host::CycleRecord last_;
    std::uint64_t steps_ = 0;
    std::uint64_t missed_ = 0;
    control::Time worst_latency_{};
    std::uint64_t dropped_ = 0;
    std::map<std::string, std::uint64_t> changes_;  // since the last summary, by state, fault, link, SYNC
    std::set<std::string> flaps_;                   // what did until the last summary
    std::uint64_t unsaid_ = 0;
};

}  // namespace antiskid::controller
