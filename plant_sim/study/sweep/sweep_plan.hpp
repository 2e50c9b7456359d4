/// The set-point study of Section VI as a list of stops: drawn scenarios, each with every slip reference.
///
/// All is drawn before the first stop, each landing with a generator of its own, so that neither the order of the stops nor their distribution over
/// threads and machines changes a result.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "firmware/control/config.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "plant_sim/model/rig.hpp"
#include "plant_sim/study/rig_session.hpp"
#include "rig_bridge/wear/draw.hpp"

namespace sweep {

/// The paper's references, 0.06 to 0.50 in steps of 0.01, and its number of landings.
[[nodiscard]] std::vector<double> paper_references();
inline constexpr std::size_t kPaperLandings = 100;
/// The paper's best fixed reference.
inline constexpr double kPaperReference = 0.24;
/// Rounds to multiples of 1e-6, so that the same references are the same numbers however they were given. None: they do not increase, or leave 0.01
/// to 0.5.
[[nodiscard]] std::optional<std::vector<double>> in_whole_steps(std::vector<double> references);

/// One maneuver on one runway, with a new brake.
struct StopConditions {
    std::string surface;
    std::string maneuver;
    rig::RigParameters rig;
};

/// Drawn values of a landing, the same for every reference.
struct DrawnLanding {
    std::size_t scenario = 0;  ///< index in SweepPlan::scenarios
    double c_e_J = 0.0;        ///< energy that the brake took before
    double mean_friction = 0.0;
    std::uint64_t sensor_seed = 0;
};

/// Wear of the brake: c_e is drawn uniformly from 0 to `life_J`, then the landing's mean friction with `friction`, eq. (14).
struct BrakeLife {
    double life_J = 0.0;
    std::function<double(double c_e_J, wear::Generator& generator)> friction;
};

/// Definition of one stop: everything in a table of stops but the figures.
struct Stop {
    std::size_t number = 0;       ///< 0 to SweepPlan::stops() - 1: by reference, the threshold law last; for each, by landing
    bool threshold = false;       ///< with the threshold law, which has no reference
    double slip_reference = 0.0;  ///< 0 for the threshold law
    std::size_t landing = 0;
    std::string surface;
    std::string maneuver;
    double c_e_J = 0.0;
    double mean_friction = 0.0;
    std::uint64_t sensor_seed = 0;
    bool operator==(const Stop&) const = default;
};

struct SweepPlan {
    std::vector<StopConditions> scenarios;
    std::vector<DrawnLanding> landings;
    std::vector<double> references;  ///< 0 to 0.5, increasing
    bool threshold = true;           ///< whether the threshold law follows the references, with the same landings
    antiskid::control::Config controller;
    antiskid::can::Layout layout;
    double demand_Pa = 0.0;  ///< full pressure, to which the demand steps
    double drop_out_mps = 0.0;
    std::uint64_t seed = 0;
    std::string config_hash;  ///< of every file used
    std::string version;

    [[nodiscard]] std::size_t stops() const { return (references.size() + (threshold ? 1 : 0)) * landings.size(); }
    /// `number` must be below stops().
    [[nodiscard]] Stop stop(std::size_t number) const;
    /// Plant and pilot of that stop.
    [[nodiscard]] rig::RigParameters rig(std::size_t number) const;
    [[nodiscard]] study::SessionOptions session(std::size_t number) const;
};

/// Draws `count` landings with equally probable scenarios.
[[nodiscard]] std::vector<DrawnLanding> draw_landings(std::uint64_t seed, std::size_t count, std::size_t scenarios, const BrakeLife& brake);

/// Options of a plan from the files in config/.
struct SweepPlanOptions {
    std::filesystem::path config = settings::config_directory();
    std::vector<double> references = paper_references();
    std::size_t landings = kPaperLandings;
    bool threshold = true;
    std::uint64_t seed = 1;
};

/// Plans all combinations of surfaces and maneuvers of `config`. Throws settings::Error naming file, line and key.
[[nodiscard]] SweepPlan load_plan(const SweepPlanOptions& options);

}  // namespace sweep
