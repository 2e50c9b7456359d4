#include "plant_sim/scenario/brake_options.hpp"

#include <fmt/core.h>

#include <stdexcept>

#include "firmware/host/settings/command_line.hpp"
#include "firmware/host/settings/number_in.hpp"
#include "plant_sim/wear/brake_state.hpp"

namespace plant_sim {

namespace {

constexpr double kMax_MJ = 1e9;

/// Nothing where `text` is no energy in MJ.
std::optional<double> energy_J(const std::string& text) {
    const auto value_MJ = settings::number_in<double>(text);
    if (!value_MJ || !(*value_MJ >= 0.0 && *value_MJ <= kMax_MJ)) return std::nullopt;
    return *value_MJ * 1e6;
}

std::string check_brake(const std::string& text) {
    if (text == "new" || text == "worn" || energy_J(text)) return {};
    return fmt::format("expected new, worn, or the energy taken so far, 0 to {:g} MJ; got '{}'", kMax_MJ, text);
}

}  // namespace

void add_rule_options(CLI::App& app, wear::ConditionalRule& rule) {
    settings::add_choice(app, "--variance", rule.variance, {{"exact", wear::Variance::exact}, {"printed", wear::Variance::printed}},
                         "exact: (1 - rho^2) sigma_b^2; printed: (1 - rho) sigma_b^2 as in the paper's eq. (14)");
    settings::add_choice(app, "--component", rule.choice, {{"nearest", wear::Choice::nearest}, {"mixture", wear::Choice::mixture}},
                         "mixture: all components by their weight at this energy; nearest: the one nearest in energy, as in the paper");
}

void BrakeOptions::add_to(CLI::App& app) {
    app.add_option("--brake", brake, "mean friction as [brake.wear] says: new, worn (at the end of its life), or what it has taken so far in MJ")
        ->check(CLI::Validator(check_brake, ""))
        ->type_name("new|worn|MJ");
    settings::result_file(app.add_option("--brake-state", state,
                                         "the brake from one run to the next: read at the start where it is there, written after each maneuver"));
    add_rule_options(app, rule);
    for (const char* option : {"--variance", "--component"})
        app.get_option(option)
            ->each([this](const std::string&) { by_model = true; })
            ->group("Friction drawn from the model of [brake.wear], eq. (14), and not by its law");
}

wear::BrakeWear BrakeOptions::requested_wear(wear::BrakeWear rig) const {
    if (by_model) rig.law.reset();
    return rig;
}

double BrakeOptions::initial_energy_J(const wear::BrakeWear& wear) const {
    if (brake.empty() || brake == "new") return 0.0;
    return brake == "worn" ? wear.life_J : energy_J(brake).value();
}

wear::WearingBrake BrakeOptions::brake_of(const wear::BrakeWear& rig, std::uint64_t seed) const {
    const wear::BrakeWear wear = requested_wear(rig);
    if (!state.empty()) {
        if (const auto kept = wear::find_brake_state(state, wear)) {
            if (!brake.empty())
                throw std::invalid_argument(fmt::format(
                    "--brake {}: {} holds a brake already; leave --brake out to go on with it, or name another file", brake, state.string()));
            return {wear, rule, *kept};
        }
    }
    return {wear, rule, {.seed = seed, .maneuvers = 0, .c_e_J = initial_energy_J(wear)}};
}

std::string extrapolation_notice(const wear::WearingBrake& brake) {
    if (!brake.extrapolates()) return {};
    const wear::BrakeWear& w = brake.wear();
    return fmt::format("the brake has taken {:.1f} MJ, which is beyond the wear model's data ({:.1f} to {:.1f} MJ of this brake): {}",
                       brake.state().c_e_J * 1e-6, w.model->data.first_c_e_J * w.scale.energy * 1e-6,
                       w.model->data.last_c_e_J * w.scale.energy * 1e-6, wear::kHowItExtrapolates);
}

}  // namespace plant_sim
