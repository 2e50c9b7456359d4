/// Requirements that closed-loop stops must meet before margins count.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "firmware/control/config.hpp"
#include "plant_sim/model/rig.hpp"
#include "plant_sim/study/rig_session.hpp"

namespace study::margins {

struct StopsRequirement {
    double mean_j_mu = 0.0;       ///< smallest mean of all stops on surfaces whose friction counts
    double longest_lock_s = 0.0;  ///< longest lock in any stop on surfaces
    double tracked_share = 0.0;   ///< smallest StopFigures::tracked_share of any of these stops
};

struct TrialStop {
    std::size_t group = 0;  ///< index of TrialStops::groups
    rig::RigParameters rig;
    SessionOptions session;
    bool friction_counts = true;  ///< whether its J_mu counts; otherwise only locks, tracking and faults do
};

struct TrialStops {
    const antiskid::can::Layout* layout = nullptr;
    std::vector<std::string> groups;  ///< surfaces first, then families of drawn plants
    std::size_t surfaces = 0;         ///< number of surfaces in `groups`
    std::vector<TrialStop> stops;
    std::size_t first = 0;         ///< number of stops, from the front, that are made first; the others are made only if these suffice
    std::vector<double> min_j_mu;  ///< required mean of each group
    StopsRequirement requirement;
};

struct StopsShown {
    double mean_j_mu = 0.0;
    std::vector<double> group_j_mu;  ///< means
    double longest_lock_s = 0.0;
    std::optional<double> min_tracked;  ///< of the stops with measured tracking
    bool faults = false;
    bool whole = false;  ///< whether all stops were made
    /// Distance from the requirement: missing friction (of the mean, and of each group relative to its requirement), missing tracking, locks in s
    /// beyond the allowed, and 1 for faults; 0: the requirement is met. Stops that were not made count with their best possible result. If tracking
    /// is required but was not measured, all of it is missing.
    double violation = 0.0;
};

/// Makes the stops until `violation` exceeds `max_violation`, or all of them.
[[nodiscard]] StopsShown make_stops(const TrialStops& trial, const antiskid::control::Config& controller, double max_violation);

}  // namespace study::margins
