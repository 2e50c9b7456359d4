/// Margins on several tyres beside one another: what a carcass leaves of them, a row a tyre.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plant_sim/study/margins/margins_report.hpp"

namespace study::margins {

/// As compliance.hpp has it, "static" where nothing gives way.
[[nodiscard]] std::string tyre_name(const rig::Compliance& tyre);

/// Of all cells on one tyre, full linearisation.
struct TyreRow {
    rig::Compliance tyre;
    std::size_t cells = 0;
    std::size_t stable = 0;          ///< the law's loop
    std::size_t phase = 0;           ///< of these with the phase margin that is asked for
    std::size_t half_gain = 0;       ///< with half the gain margin, in dB, both ways
    std::size_t gain = 0;            ///< with all of it, both ways
    std::size_t excited = 0;         ///< cells in which the wheel's own swing grows, excites_itself()
    std::size_t excited_stable = 0;  ///< of these, those in which the law's loop is stable all the same
    std::optional<Complex> swing;    ///< the fastest of Cell::swing
    Complex law_slowest;             ///< the fastest of Cell::law_slowest
};

[[nodiscard]] TyreRow tyre_row(const rig::Compliance& tyre, const std::vector<Cell>& cells, const Requirement& requirement);

/// Markdown.
[[nodiscard]] std::string to_table(const std::vector<TyreRow>& rows, const ReportHead& head);
[[nodiscard]] std::string to_json(const std::vector<TyreRow>& rows, const ReportHead& head);

/// The cells of one tyre that excite themselves, a row a scenario, in Markdown; empty where there are none. With it what
/// the valve leaves of a command at that frequency.
[[nodiscard]] std::string excited_table(const std::vector<StopConditions>& scenarios, const std::vector<Cell>& cells);

}  // namespace study::margins
