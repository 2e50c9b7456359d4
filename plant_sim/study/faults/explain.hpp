/// Explains why a stop with a fault was longer although no fault was named: whether its symptoms differ from those of fault-free stops.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "plant_sim/study/faults/fault_campaign.hpp"
#include "plant_sim/study/faults/symptoms.hpp"
#include "plant_sim/study/robust/uncertainty.hpp"

namespace faults {

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
