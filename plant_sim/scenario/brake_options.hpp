/// Command-line options for the brake of a simulated rig and its wear, the same in every program.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "rig_bridge/wear/wearing_brake.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's
class App;       // its header takes seconds
}

namespace plant_sim {

/// Adds `--variance` and `--component`.
void add_rule_options(CLI::App& app, wear::ConditionalRule& rule);

struct BrakeOptions {
    std::string brake;            ///< new, worn, or the energy taken so far in MJ; empty: not given
    std::filesystem::path state;  ///< file with the brake's state; empty: none
    wear::ConditionalRule rule;
    bool by_model = false;  ///< --variance or --component: friction is drawn from the model, eq. (14), also if the rig's brake has a law

    void add_to(CLI::App& app);
    /// Whether a wearing brake is requested.
    [[nodiscard]] bool given() const { return !brake.empty() || !state.empty(); }
    /// The rig's wear; without its law if eq. (14) was requested.
    [[nodiscard]] wear::BrakeWear requested_wear(wear::BrakeWear rig) const;
    /// Cumulative energy by `brake`; that of a new brake if it is not given.
    [[nodiscard]] double initial_energy_J(const wear::BrakeWear& wear) const;
    /// The brake in the state file, with the file's seed, if the file exists; otherwise the one of `brake` with `seed`. Throws std::invalid_argument
    /// if both give a brake, settings::Error if the file is of another brake.
    [[nodiscard]] wear::WearingBrake brake_of(const wear::BrakeWear& rig, std::uint64_t seed) const;
};

/// Text for people if the brake is beyond the model's data: how the model extrapolates. Empty otherwise.
[[nodiscard]] std::string extrapolation_notice(const wear::WearingBrake& brake);

}  // namespace plant_sim
