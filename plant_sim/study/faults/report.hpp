/// A campaign as tables and as a picture.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "plant_sim/study/faults/fault_campaign.hpp"

namespace faults {

/// Every run; units in the header.
[[nodiscard]] std::string to_csv(const FaultPlan& plan, std::span<const Row> rows);
/// Totals, the bounds, and for each signal and kind how its runs ended, what named it and after which time.
[[nodiscard]] std::string to_json(const FaultPlan& plan, std::span<const Row> rows);
/// For people: outcomes by signal, and the unsafe runs, at most `most` of them.
[[nodiscard]] std::string to_table(const FaultPlan& plan, std::span<const Row> rows, std::size_t max);
/// One run in a line of words: what fault, where, and what became of it.
[[nodiscard]] std::string describe(const FaultPlan& plan, const Case& run);
[[nodiscard]] std::string describe(const Result& result);

/// Signals and kinds over phases and surfaces; each cell the worst outcome of its runs. Throws as pictures::run_gnuplot.
void draw_matrix(const FaultPlan& plan, std::span<const Row> rows, const std::filesystem::path& png);

}  // namespace faults
