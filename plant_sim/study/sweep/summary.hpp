/// Results of the sweep: means over the landings for each reference, compared with the statements of Section VI.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant_sim/study/sweep/stops_table.hpp"

namespace sweep {

/// Means over the landings of one reference, or of the threshold law.
struct Means {
    double slip_reference = 0.0;  ///< 0 for the threshold law
    std::size_t landings = 0;
    double j_mu = 0.0;
    double j_mu_error = 0.0;  ///< standard error of the mean over the drawn landings
    double min_j_mu = 0.0;
    double stop_distance_m = 0.0;
    double energy_brake_J = 0.0;
    double energy_tyre_J = 0.0;
    double tyre_share = 0.0;  ///< in the energy that brake and tyre took in all these stops
    double slip_efficiency = 0.0;
    /// Number of landings in which the slip stayed within 0.05 of the reference over 95 % of the distance from 0.5 s after brake-on down to 20 m/s.
    /// It does not in landings where a worn brake cannot reach that slip on a dry runway.
    std::size_t tracked_landings = 0;
    double tracked_tyre_share = 0.0;  ///< the tyre's share of the energy over that distance, mean of those landings
    double longest_lock_s = 0.0;      ///< of all stops
    double lock_s = 0.0;              ///< mean of each stop's longest
    std::size_t faults = 0;           ///< number of stops with faults
    std::size_t not_at_rest = 0;
};

/// A requirement, as one line of a report.
struct Check {
    std::string name;      ///< short, for JSON
    std::string demand;    ///< "mean J_mu at 0.24 at least 0.958"
    std::string measured;  ///< "0.9661"
    bool passed = false;
};

struct Summary {
    Identity identity;
    std::vector<Means> references{};
    std::optional<Means> threshold{};
    std::size_t best = 0;                  ///< index in `references` of the greatest mean J_mu
    std::vector<Check> checks{};           ///< those for which the references and landings of this sweep suffice
    std::vector<std::string> unchecked{};  ///< requirements for which they do not

    [[nodiscard]] bool passed() const;
};

/// Compares the means with the statements of Section VI, Fig. 13 and 14: fills `checks` and `unchecked`.
void check(Summary& summary);

/// `rows`: all stops of the sweep, by number.
[[nodiscard]] Summary summarised(const Identity& identity, std::span<const SweptStop> rows);

[[nodiscard]] std::string to_json(const Summary& summary);
/// Text for people: a line for each fifth reference, the best, the paper's and the threshold law; then the checks.
[[nodiscard]] std::string to_table(const Summary& summary);

/// Fig. 13: mean J_mu and distance over the mean energy of the brake (top) and of the tyre (bottom). Throws std::runtime_error as run_gnuplot.
void draw_fig13(const Summary& summary, const std::filesystem::path& png);
/// Fig. 14: the two energies against each other, and both over the reference.
void draw_fig14(const Summary& summary, const std::filesystem::path& png);

}  // namespace sweep
