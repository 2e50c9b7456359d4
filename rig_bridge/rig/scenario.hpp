/// Maneuver and rig of a scenario: config/scenarios/NAME.toml and the files that it refers to. Read by rig-bridge, virtual-rig serve and rig-lab, so
/// that all use the same rig and maneuver.
///
///     const rig::Scenario scenario = rig::load_scenario("config/scenarios/heavy.toml");
///     rig::Sequencer sequencer(rig::plan(scenario, seed, number));
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig {

/// Standard deviations from maneuver to maneuver.
struct Scatter {
    double speed_mps = 0.0;
    double load_N = 0.0;
    double deceleration_mps2 = 0.0;
};

/// Allowed range of a figure of a finished maneuver, both ends included.
struct Band {
    const record::FigureField* figure = nullptr;  ///< of kFigureFields
    double min = 0.0;
    double max = 0.0;
};

struct Scenario {
    std::string name;   ///< the file's, without its ending
    std::string title;  ///< one line for people
    rig::ManeuverChoice choice;
    rig::LoadedRig rig;                ///< always on the flywheel
    std::filesystem::path controller;  ///< configuration of the controller that this rig needs
    rig::Plan mean;                    ///< without scatter
    Scatter scatter;
    std::vector<Band> acceptance;  ///< as declared in the file; see acceptance.hpp for the bands in force
    double energy_band = 0.0;      ///< of the meter, see MeterParameters
    /// Every file that was read, for the hash of results: scenario, sequencer.toml, those of the rig. Not `controller`, which is the
    /// controller's own.
    std::vector<std::filesystem::path> files;

    /// The rig of Table III; else that of Table II.
    [[nodiscard]] bool endurance() const { return choice.maneuver == rig::kEndurance; }
    /// r(F_z) = r_0 - F_z / k_r of the braked wheel: times its encoder's speed it is rig::Inputs::wheel_rim_mps.
    [[nodiscard]] double rolling_radius_m(double load_N) const;
};

/// Reads the scenario and, from `config`, sequencer.toml and the files of the rig. Throws settings::Error naming file, line and key, or
/// std::invalid_argument for a plan that cannot be run.
[[nodiscard]] Scenario load_scenario(const std::filesystem::path& file, const std::filesystem::path& config = "config");

/// The maneuver of this number, from 1, in a campaign of this seed. Scatter depends only on these two, so that a resumed campaign continues as
/// without interruption.
[[nodiscard]] rig::Plan plan(const Scenario& scenario, std::uint64_t seed, std::int64_t number);

}  // namespace rig
