/// Margins as a table, as JSON and as pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plant_sim/study/margins/cells.hpp"
#include "rig_bridge/rig/compliance.hpp"

namespace study::margins {

/// Head of a result file.
struct ReportHead {
    std::string config_hash;
    std::string version;
    StudyOptions options;
    Pid pid;
    std::string tyre = "static";  ///< or the ring tyre of the comparison
};

/// Name as in compliance.hpp; "static" for a tyre without compliance.
[[nodiscard]] std::string tyre_name(const rig::Compliance& tyre);

/// Markdown with one row per scenario: the worst margins over its speeds and their speed, full linearisation; then the infeasible cells.
[[nodiscard]] std::string to_table(const std::vector<StopConditions>& scenarios, const std::vector<Cell>& cells, const ReportHead& head);
/// Every cell. Margins of an unstable loop, and unlimited margins, are null.
[[nodiscard]] std::string to_json(const std::vector<StopConditions>& scenarios, const std::vector<Cell>& cells, const ReportHead& head);

/// Fig. 11: L(s) = G(s) A(s) of all scenarios at `speed_mps`, magnitude and phase, overview and enlargement.
void draw_plant(const std::vector<StopConditions>& scenarios, double slip_reference, double speed_mps, const std::filesystem::path& png);
/// Margins of the shipped law over speed, all scenarios.
void draw_margins(const std::vector<StopConditions>& scenarios, const std::vector<Cell>& cells, const ReportHead& head,
                  const std::filesystem::path& png);

}  // namespace study::margins
