/// Explains why a stop with a fault was longer although no fault was named: whether its symptoms differ from those of fault-free stops.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "plant_sim/study/faults/fault_campaign.hpp"
#include "plant_sim/study/robust/uncertainty.hpp"

namespace faults {

/// Of a fault: a figure of a stop computed only from the controller's inputs and commands. Without a fault it is near that of other fault-free stops,
/// on any runway.
enum class Symptom : std::uint8_t {
    late,     ///< s, largest delay of a wheel frame after its newest edge, beyond the smallest so far
    refused,  ///< number of rejected frames of all inputs
    wild,     ///< number of impossible readings of the wheel above 2.7 times drop-out, decreasing by two per second; its maximum
    scatter,  ///< root mean square deviation of the wheel's readings from the expected speed, in standard deviations of a reading
    mass,     ///< kg, the aircraft's: impulse of the road (by brake torque and wheel acceleration) over the loss of speed
    off_map,  ///< Pa, mean deviation of the transducer's reading from the pressure that the commands alone explain
    lag,      ///< s, delay of the pressure behind the command, by regression on the commanded rate
    excess,   ///< s, integral of the slip beyond 0.05 above the reference in force; decreases below it
};
inline constexpr std::array<std::string_view, 8> kSymptomNames{"late_s", "refused", "wild", "scatter", "mass_kg", "off_map_Pa", "lag_s", "excess_s"};

/// Indexed by Symptom.
using Symptoms = std::array<double, kSymptomNames.size()>;

/// Range of a figure in fault-free stops.
struct Span {
    double least = 0.0, most = 0.0;
    /// Whether `value` is outside the range by more than the range's width.
    [[nodiscard]] bool shows(double value) const { return value > most + (most - least) || value < least - (most - least); }
};

struct Explanation {
    Case run;
    Result result;
    Symptoms symptoms{};  ///< since the beginning of the fault
    /// Friction of the runway, from the position of the fault's beginning on, relative to that of the surface, at which a fault-free stop is as long;
    /// 1: no such friction.
    double grip = 1.0;
    double twin_share = 1.0;                         ///< distance of that stop over that of the fault-free one
    std::array<Span, kSymptomNames.size()> twins{};  ///< of fault-free stops on that runway, with other sensor seeds
    std::array<Span, kSymptomNames.size()> drawn{};  ///< of fault-free stops on that runway, on drawn rigs
};

struct ExplainOptions {
    std::size_t twins = 16;
    std::size_t rigs = 56;
    std::uint64_t rig_seed = 21;  ///< of the draws
};

/// Draws rigs from the family `all` of `basis`, on the surface of the run. Throws as run_fault_free.
[[nodiscard]] Explanation explain(const FaultPlan& plan, const Case& c, const robust::Basis& basis, const ExplainOptions& options = {});

/// Explanations as text for people, and as JSON.
[[nodiscard]] std::string to_table(const FaultPlan& plan, std::span<const Explanation> explanations);
[[nodiscard]] std::string to_json(const FaultPlan& plan, std::span<const Explanation> explanations);

}  // namespace faults
