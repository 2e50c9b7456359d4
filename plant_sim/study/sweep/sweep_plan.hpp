/// The set-point study of Section VI as a list of stops: scenarios drawn at random, each driven with every slip reference.
///
/// All is drawn before anything runs, each landing from a generator of its own, so that neither the order of the stops nor how they are
/// spread over threads and machines can change one of them.
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

/// The references of the paper: 0.06 to 0.50 in steps of 0.01, and how many landings it drew.
[[nodiscard]] std::vector<double> paper_references();
inline constexpr std::size_t kPaperLandings = 100;
/// The paper's best fixed reference.
inline constexpr double kPaperReference = 0.24;
/// In whole steps of 1e-6: the same numbers whichever way they were given. None where they do not increase, or are not from 0.01 to 0.5.
[[nodiscard]] std::optional<std::vector<double>> in_whole_steps(std::vector<double> references);

/// One runway under one maneuver, with a new brake.
struct StopConditions {
    std::string surface;
    std::string maneuver;
    rig::RigParameters rig;
};

/// What the draw decides, the same for every reference.
struct Landing {
    std::size_t scenario = 0;  ///< of SweepPlan::scenarios
    double c_e_J = 0.0;        ///< energy that the brake has taken before
    double mean_friction = 0.0;
    std::uint64_t sensor_seed = 0;
};

/// The brake over its life: c_e is drawn uniformly from 0 to `life_J`, and then the landing's mean friction by `friction`, eq. (14).
struct BrakeLife {
    double life_J = 0.0;
    std::function<double(double c_e_J, wear::Generator& generator)> friction;
};

/// What one stop of the sweep is. Everything that a table of stops says beside figures.
struct Stop {
    std::size_t number = 0;       ///< 0 to SweepPlan::stops() - 1: reference by reference, the threshold law last; in each, landing by landing
    bool threshold = false;       ///< by the threshold law, which knows no reference
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
    std::vector<Landing> landings;
    std::vector<double> references;  ///< 0 to 0.5, increasing
    bool threshold = true;           ///< the same landings by the threshold law, after all references
    antiskid::control::Config controller;
    antiskid::can::Layout layout;
    double demand_Pa = 0.0;  ///< full pressure: the demand steps to it
    double drop_out_mps = 0.0;
    std::uint64_t seed = 0;
    std::string config_hash;  ///< of every file in force
    std::string version;

    [[nodiscard]] std::size_t stops() const { return (references.size() + (threshold ? 1 : 0)) * landings.size(); }
    /// `number` below stops().
    [[nodiscard]] Stop stop(std::size_t number) const;
    /// The plant and the pilot of that stop.
    [[nodiscard]] rig::RigParameters rig(std::size_t number) const;
    [[nodiscard]] study::SessionOptions session(std::size_t number) const;
};

/// `count` landings, every scenario as likely as any other.
[[nodiscard]] std::vector<Landing> draw_landings(std::uint64_t seed, std::size_t count, std::size_t scenarios, const BrakeLife& brake);

/// A sweep's plan from the files in config/.
struct SweepPlanOptions {
    std::filesystem::path config = settings::config_directory();
    std::vector<double> references = paper_references();
    std::size_t landings = kPaperLandings;
    bool threshold = true;
    std::uint64_t seed = 1;
};

/// All surfaces times all maneuvers of `config`. Throws settings::Error naming file, line and key.
[[nodiscard]] SweepPlan load_plan(const SweepPlanOptions& options);

}  // namespace sweep
