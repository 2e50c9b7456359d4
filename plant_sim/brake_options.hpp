/// Which brake a program runs with, and how it wears: the same options wherever one does.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "rig_bridge/wear/wearing_brake.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's
class App;       // its header takes seconds
}

namespace plant_sim {

/// `--variance` and `--component`.
void add_rule_options(CLI::App& app, wear::ConditionalRule& rule);

struct BrakeOptions {
    std::string brake;            ///< new, worn, or the energy taken so far in MJ; empty: not said
    std::filesystem::path state;  ///< empty: none is kept
    wear::ConditionalRule rule;
    bool by_model = false;  ///< --variance or --component: friction is drawn from the model, eq. (14), whatever law the rig's brake has

    void add_to(CLI::App& app);
    /// Whether a wearing brake was asked for.
    [[nodiscard]] bool given() const { return !brake.empty() || !state.empty(); }
    /// The rig's, without its law where eq. (14) was asked for.
    [[nodiscard]] wear::BrakeWear asked_of(wear::BrakeWear rig) const;
    /// What --brake says, new where it says nothing.
    [[nodiscard]] double taken_J(const wear::BrakeWear& wear) const;
    /// The brake of the state file where there is one (its seed with it), else of --brake and `seed`. Throws std::invalid_argument where both
    /// say something, settings::Error for a file that is none of this brake.
    [[nodiscard]] wear::WearingBrake brake_of(const wear::BrakeWear& rig, std::uint64_t seed) const;
};

/// For people: that the brake is beyond the model's data, and how the model goes on there. Empty where it is not.
[[nodiscard]] std::string extrapolation_notice(const wear::WearingBrake& brake);

}  // namespace plant_sim
