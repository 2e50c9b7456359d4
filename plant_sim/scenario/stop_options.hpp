/// Command-line options of one maneuver, the same in every program that runs one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "firmware/can/layout.hpp"
#include "firmware/control/config.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "plant_sim/scenario/brake_options.hpp"
#include "plant_sim/study/in_process.hpp"
#include "plant_sim/study/report.hpp"
#include "plant_sim/study/rig_session.hpp"
#include "rig_bridge/rig/load_rig.hpp"

namespace plant_sim {

struct StopOptions {
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path controller;  ///< empty: controller.toml of `config`, or the endurance rig's
    std::filesystem::path dbc;         ///< empty: antiskid.dbc of `config`
    std::filesystem::path binding;     ///< empty: antiskid_binding.toml of `config`
    rig::ManeuverChoice choice;
    std::string law = "slip";
    double slip = 0.24;
    std::optional<double> deceleration_mps2;
    std::filesystem::path profile;  ///< valve current over time since brake-on, for the open-loop law
    std::uint64_t seed = 1;
    BrakeOptions brake;

    /// Adds all options but those of `brake`, whose add_to() is for programs that keep the brake's state.
    void add_to(CLI::App& app);
};

/// Inputs of a run, read and checked.
struct StopInputs {
    rig::LoadedRig plant;
    antiskid::control::Config controller;
    antiskid::can::Layout layout;
    study::SessionOptions session;
    std::string config_hash;
    std::optional<wear::WearingBrake> brake;  ///< before the maneuver; none: not requested

    /// Writes the brake's state after the maneuver, with `energy_J` added, to the file of the options, if there is one. Throws settings::Error.
    void save_brake(const StopOptions& options, double energy_J) const;
    /// Head of the report: the inputs of the run; with `result`, also what came of it.
    [[nodiscard]] study::StopReport report(const StopOptions& options) const;
    [[nodiscard]] study::StopReport report(const StopOptions& options, const study::RunResult& result) const;
    /// Title of a picture.
    [[nodiscard]] std::string title(const StopOptions& options) const;
};

/// Throws settings::Error or std::invalid_argument, with what is wrong and what would be right.
[[nodiscard]] StopInputs load_scenario(const StopOptions& options);

}  // namespace plant_sim
