/// Result of one stop as JSON and as a table, with the same figures for every way of running it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/control/types.hpp"
#include "plant_sim/study/stop_meter.hpp"

namespace study {

struct StopReport {
    std::string maneuver;
    std::string surface;
    std::string law;
    double slip_reference = 0.0;
    double mass_kg = 0.0;
    double speed_mps = 0.0;
    std::optional<double> brake_taken_J;  ///< energy that the brake took before this stop; none: its wear is not simulated
    StopFigures figures;
    antiskid::control::FaultSet faults;
    std::uint64_t frames_sent = 0;  ///< by the rig
    std::uint64_t frames_received = 0;
    std::uint64_t frames_lost = 0;  ///< gaps in alive counters, and frames dropped by a queue
    std::uint64_t overruns = 0;     ///< periods that the rig missed
    std::uint64_t seed = 0;
    std::string version;
    std::string config_hash;  ///< of every configuration file used
};

[[nodiscard]] std::string to_json(const StopReport& report);
[[nodiscard]] std::string to_table(const StopReport& report);

}  // namespace study
