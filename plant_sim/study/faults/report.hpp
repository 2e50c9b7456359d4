/// A fault campaign as tables and as a picture.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "plant_sim/study/faults/fault_campaign.hpp"

namespace faults {

/// All runs as CSV with units in the header.
[[nodiscard]] std::string to_csv(const FaultPlan& plan, std::span<const JudgedRun> rows);
/// Totals, bounds, and for each signal and kind the outcomes, the faults named and their delays.
[[nodiscard]] std::string to_json(const FaultPlan& plan, std::span<const JudgedRun> rows);
/// Text for people: outcomes by signal, and at most `max` of the unsafe runs.
[[nodiscard]] std::string to_table(const FaultPlan& plan, std::span<const JudgedRun> rows, std::size_t max);
/// One line of text: the run's fault and conditions, or its result.
[[nodiscard]] std::string describe(const FaultPlan& plan, const Case& run);
[[nodiscard]] std::string describe(const Result& result);

/// Picture of signals and kinds over parts and surfaces; each cell shows the worst outcome of its runs. Throws as pictures::run_gnuplot.
void draw_matrix(const FaultPlan& plan, std::span<const JudgedRun> rows, const std::filesystem::path& png);

}  // namespace faults
