/// Reads config/margins.toml.
#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "plant_sim/study/margins/limits.hpp"
#include "plant_sim/study/margins/pid_loop.hpp"
#include "plant_sim/study/margins/search.hpp"
#include "plant_sim/study/margins/trial_stops.hpp"
#include "plant_sim/study/robust/uncertainty.hpp"

namespace study::margins {

/// The search for gains of the slip law.
struct LawSearch {
    SearchOptions options;  ///< without threads
    double min_gain = 0.0;  ///< of the last part, climb()
    StopsRequirement stops;
    double surface_loss = 0.0;                                      ///< largest loss of mean J_mu against the threshold law on any surface
    double worn_friction = 0.0;                                     ///< friction of the worn brake in further stops, which are judged by tracking
    std::vector<double> worn_references;                            ///< of the stops with the worn brake
    std::uint64_t drawn_seed = 1;                                   ///< of further stops on drawn plants (study/robust)
    std::size_t draws = 0;                                          ///< number of each family
    std::vector<std::pair<robust::Family, double>> min_drawn_j_mu;  ///< required mean of each family
    std::vector<Parameter> parameters;                              ///< in the order of gain_names()
};

struct MarginsSettings {
    Requirement requirement;
    Pid pid;
    LawSearch law;
};

/// Throws settings::Error naming file, line and key.
[[nodiscard]] MarginsSettings load_margins_settings(const std::filesystem::path& path);

}  // namespace study::margins
