/// Policies of a fleet, tuned on some fleets and judged on others.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "plant_sim/study/regulation/fleet_config.hpp"

namespace regulation {

/// A policy with the numbers that are tried for it.
struct Entrant {
    std::string name;
    std::vector<FleetPolicy> variants;  ///< at least one
};

struct FleetStudy {
    AircraftKind kind;  ///< the law and `past` are those of each set
    Choices choices;
    Costs costs;  ///< its visit includes the days on the ground; brake_per_J and planned.brake_J are those of each law
    FleetConfig config;
    std::uint64_t training_seed = 0;  ///< of past brakes
    unsigned threads = 1;             ///< the result does not depend on it
    const std::atomic<bool>* stop = nullptr;
    std::function<void(std::size_t fleets)> on_fleets{};  ///< called by one thread at a time, with the number of fleets so far
};

/// Plain policies first. `references`: of one slip reference for all surfaces, the default one first. Choices are those of `study` and `references`,
/// which must outlive the result.
[[nodiscard]] std::vector<Entrant> entrants(const FleetStudy& study, const std::vector<Choice>& references);

struct Judged {
    std::string name;
    FleetPolicy policy;                 ///< the variant that was cheapest on the tuning set
    std::vector<FleetResult> fleets{};  ///< of the held-out set, law by law
};
/// In the order of `entrants`. Empty if it was stopped.
[[nodiscard]] std::vector<Judged> judge(const FleetStudy& study, const std::vector<Entrant>& entrants);

/// Money per landing, all fleets together.
[[nodiscard]] double per_landing(const Judged& policy);

/// How much cheaper a policy is than another one on the same fleets.
struct Saving {
    double per_landing = 0.0;     ///< mean over the fleets
    double standard_error = 0.0;  ///< by the scatter between fleets; the laws are as they are
};
[[nodiscard]] Saving saving(const Judged& policy, const Judged& other);

}  // namespace regulation
