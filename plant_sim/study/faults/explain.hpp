/// Why a stop with a fault was longer and nothing said so: whether the controller's inputs differ from those of a sound stop.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plant_sim/study/faults/evidence.hpp"
#include "plant_sim/study/faults/fault_campaign.hpp"
#include "plant_sim/study/robust/uncertainty.hpp"

namespace faults {

/// What sound stops show of a sign.
struct Span {
    double least = 0.0, most = 0.0;
    /// Further outside than the sound stops differ among each other.
    [[nodiscard]] bool shows(double value) const { return value > most + (most - least) || value < least - (most - least); }
};

struct Explanation {
    Case run;
    Result result;
    Signs seen{};  ///< from the fault's begin on
    /// Friction of the runway from the place of the fault's begin on, over that of the surface, at which a sound stop is as long; 1 where none is.
    double grip = 1.0;
    double twin_share = 1.0;                      ///< distance of that stop over the sound one's
    std::array<Span, kSignNames.size()> twins{};  ///< of sound stops there, by sensor seed
    std::array<Span, kSignNames.size()> drawn{};  ///< of sound stops there on drawn rigs
};

struct ExplainOptions {
    std::size_t twins = 16;
    std::size_t rigs = 56;
    std::uint64_t rig_seed = 21;  ///< of the draws
};

/// Drawn rigs are those of the family `all` of `basis`, on the surface of the run. Throws as run_sound.
[[nodiscard]] Explanation explain(const FaultPlan& plan, const Case& c, const robust::Basis& basis, const ExplainOptions& options = {});

}  // namespace faults
