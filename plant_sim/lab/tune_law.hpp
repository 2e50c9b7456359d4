/// The part of `rig-lab tune` for the slip law.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/host/settings/json.hpp"
#include "plant_sim/study/margins/cells.hpp"
#include "plant_sim/study/margins/margins_input.hpp"
#include "plant_sim/study/margins/search.hpp"

namespace plant_sim::lab {

struct LawTuning {
    StopOptions scenario;
    study::margins::StudyOptions options;
    study::margins::SearchOptions search;
    bool check = false;                        ///< judges the shipped gains without search or output files
    std::filesystem::path out;                 ///< directory of slip.toml
    std::vector<std::filesystem::path> write;  ///< controller files to which the gains are written
    std::string json_file;                     ///< "-": no tables on standard output
};

/// Prints its results and adds them to `json`. Returns the exit status: 0; with `check` 1 if the stops with the shipped gains miss the requirement.
[[nodiscard]] int tune_law(const LawTuning& tuning, const study::margins::MarginsInput& input, settings::Json& json);

}  // namespace plant_sim::lab
