/// The result of one stop as JSON and as a table on the screen: the same figures from every way of running it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

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
    std::optional<double> brake_taken_J;  ///< energy that the brake had taken before, where its wear is simulated
    StopFigures figures;
    antiskid::control::FaultSet faults;
    std::uint64_t frames_sent = 0;  ///< by the rig
    std::uint64_t frames_received = 0;
    std::uint64_t frames_lost = 0;  ///< gaps in alive counters, and frames that a queue dropped
    std::uint64_t overruns = 0;     ///< periods that the rig missed
    std::uint64_t seed = 0;
    std::string version;
    std::string config_hash;  ///< of every configuration file in force
};

[[nodiscard]] std::string to_json(const StopReport& report);
[[nodiscard]] std::string to_table(const StopReport& report);

}  // namespace study
