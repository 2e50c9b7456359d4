/// The part of `rig-lab tune` that finds gains of the slip law.
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
    bool check = false;                        ///< no search: the shipped gains are judged, nothing is written
    std::filesystem::path out;                 ///< gets slip.toml
    std::vector<std::filesystem::path> write;  ///< controller files that get the gains
    std::string json_file;                     ///< "-": standard output is not for tables
};

/// Prints and reports what it found. 0; with `check` 1 where the stops of the shipped gains are not what is asked.
[[nodiscard]] int tune_law(const LawTuning& tuning, const study::margins::MarginsInput& input, settings::Json& json);

}  // namespace plant_sim::lab
