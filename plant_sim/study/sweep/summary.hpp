/// What the sweep says: means over the landings for each reference, and whether they show what Section VI says.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant_sim/study/sweep/stops_table.hpp"

namespace sweep {

/// Over the landings of one reference, or of the threshold law.
struct Means {
    double slip_reference = 0.0;  ///< 0 for the threshold law
    std::size_t landings = 0;
    double j_mu = 0.0;
    double j_mu_error = 0.0;  ///< standard error of the mean over the landings drawn
    double min_j_mu = 0.0;
    double stop_distance_m = 0.0;
    double energy_brake_J = 0.0;
    double energy_tyre_J = 0.0;
    double tyre_share = 0.0;  ///< of the energy that brake and tyre took in all these stops
    double slip_efficiency = 0.0;
    /// Landings in which the slip stayed within 0.05 of the reference over 95 % of the distance from 0.5 s after brake-on down to 20 m/s.
    /// A worn brake that cannot skid its wheel on a dry runway is not one of them.
    std::size_t tracked_landings = 0;
    double tracked_tyre_share = 0.0;  ///< the tyre's share of the energy over that distance, mean of those landings
    double longest_lock_s = 0.0;      ///< the longest of all
    double lock_s = 0.0;              ///< mean of each stop's longest
    std::size_t faults = 0;           ///< stops with any
    std::size_t not_at_rest = 0;
};

/// Something that must hold, as one line of a report.
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
    std::size_t best = 0;                  ///< of `references`: the greatest mean J_mu
    std::vector<Check> checks{};           ///< those that the references and landings of this sweep allow
    std::vector<std::string> unchecked{};  ///< demands that need more than this sweep has

    [[nodiscard]] bool passed() const;
};

/// What Section VI and Fig. 13 and 14 say, as demands on the means: fills `checks` and `unchecked`.
void check(Summary& summary);

/// `rows`: every stop of the sweep, by number.
[[nodiscard]] Summary summarised(const Identity& identity, std::span<const Row> rows);

[[nodiscard]] std::string to_json(const Summary& summary);
/// For the screen: a line for every fifth reference, the best, the paper's and the threshold law; then the checks.
[[nodiscard]] std::string to_table(const Summary& summary);

/// Fig. 13: mean J_mu and distance over the mean energy of the brake (top) and of the tyre (bottom). Throws std::runtime_error as run_gnuplot.
void draw_fig13(const Summary& summary, const std::filesystem::path& png);
/// Fig. 14: the two energies against each other, and both over the reference.
void draw_fig14(const Summary& summary, const std::filesystem::path& png);

}  // namespace sweep
