/// What gains must show in closed-loop stops before their margins count.
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
    double mean_j_mu = 0.0;       ///< of all stops on surfaces whose friction counts, at least
    double longest_lock_s = 0.0;  ///< of any of those on surfaces, at most
    double tracked_share = 0.0;   ///< of each of them, at least: StopFigures::tracked_share
};

struct TrialStop {
    std::size_t group = 0;  ///< index of TrialStops::groups
    rig::RigParameters rig;
    SessionOptions session;
    bool friction_counts = true;  ///< its J_mu is one of those that are asked for; otherwise locks, tracking and faults alone count
};

struct TrialStops {
    const antiskid::can::Layout* layout = nullptr;
    std::vector<std::string> groups;  ///< surfaces first, then families of drawn plants
    std::size_t surfaces = 0;         ///< so many of them
    std::vector<TrialStop> stops;
    std::size_t first = 0;         ///< so many of them, from the front, decide whether the others are made at all
    std::vector<double> min_j_mu;  ///< of each group, its mean
    StopsRequirement requirement;
};

struct StopsShown {
    double mean_j_mu = 0.0;
    std::vector<double> group_j_mu;  ///< means
    double longest_lock_s = 0.0;
    std::optional<double> min_tracked;  ///< of the stops whose tracking was measured
    bool faults = false;
    bool whole = false;  ///< all stops were made
    /// How far it is from what is asked: what is missing of friction (mean, and each group's share of it) and tracking, locks in s beyond
    /// those that are allowed, and 1 for faults. 0: nothing is missing. Of stops not made, the least that can come out. With
    /// tracking asked for and none measured, all of it is missing.
    double violation = 0.0;
};

/// Makes the stops until `violation` is above `max_violation`, or all of them.
[[nodiscard]] StopsShown make_stops(const TrialStops& trial, const antiskid::control::Config& controller, double max_violation);

}  // namespace study::margins
