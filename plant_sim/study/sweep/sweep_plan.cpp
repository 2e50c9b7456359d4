#include "plant_sim/study/sweep/sweep_plan.hpp"

#include <cmath>

#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/settings/hash.hpp"
#include "rig_bridge/rig/load_rig.hpp"

namespace sweep {

std::vector<double> paper_references() {
    std::vector<double> references;
    for (int hundredths = 6; hundredths <= 50; ++hundredths) references.push_back(hundredths / 100.0);
    return references;
}

std::optional<std::vector<double>> in_whole_steps(std::vector<double> references) {
    double before = 0.0;
    for (double& reference : references) {
        reference = std::round(reference * 1e6) / 1e6;
        if (!(reference >= 0.01 && reference <= 0.5 && reference > before)) return std::nullopt;
        before = reference;
    }
    return references;
}

Stop SweepPlan::stop(std::size_t number) const {
    const std::size_t row = number / landings.size();
    const std::size_t column = number % landings.size();
    const DrawnLanding& landing = landings[column];
    const StopConditions& scenario = scenarios[landing.scenario];
    const bool by_threshold = row == references.size();
    return {.number = number,
            .threshold = by_threshold,
            .slip_reference = by_threshold ? 0.0 : references[row],
            .landing = column,
            .surface = scenario.surface,
            .maneuver = scenario.maneuver,
            .c_e_J = landing.c_e_J,
            .mean_friction = landing.mean_friction,
            .sensor_seed = landing.sensor_seed};
}

rig::RigParameters SweepPlan::rig(std::size_t number) const {
    const DrawnLanding& landing = landings[number % landings.size()];
    rig::RigParameters rig = scenarios[landing.scenario].rig;
    rig.mean_friction = landing.mean_friction;
    return rig;
}

study::SessionOptions SweepPlan::session(std::size_t number) const {
    const std::size_t row = number / landings.size();
    const bool by_threshold = row == references.size();
    study::SessionOptions session;
    session.plan.law = by_threshold ? antiskid::control::Law::threshold : antiskid::control::Law::wheel_slip;
    // The threshold law does not use it, but the frame must have a valid one.
    session.plan.slip_reference = by_threshold ? kPaperReference : references[row];
    session.plan.demand_Pa = demand_Pa;
    session.period_s = static_cast<double>(controller.period_s);
    session.drop_out_mps = drop_out_mps;
    session.seed = landings[number % landings.size()].sensor_seed;
    return session;
}

std::vector<DrawnLanding> draw_landings(std::uint64_t seed, std::size_t count, std::size_t scenarios, const BrakeLife& brake) {
    std::vector<DrawnLanding> landings;
    landings.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        wear::Generator generator = wear::generator_of(seed, i);
        DrawnLanding landing;
        landing.scenario = static_cast<std::size_t>(wear::uniform(generator) * static_cast<double>(scenarios));
        landing.sensor_seed = generator() >> 32U;
        landing.c_e_J = wear::uniform(generator) * brake.life_J;
        landing.mean_friction = brake.friction(landing.c_e_J, generator);
        landings.push_back(landing);
    }
    return landings;
}

SweepPlan load_plan(const SweepPlanOptions& options) {
    const auto controller = options.config / "controller.toml";
    const antiskid::LayoutFiles layout(options.config);
    SweepPlan plan;
    plan.references = options.references;
    plan.threshold = options.threshold;
    plan.seed = options.seed;
    plan.controller = antiskid::load_controller_config(controller);
    plan.layout = layout.load(antiskid::required_range(plan.controller));
    plan.version = ANTISKID_VERSION;
    std::vector<std::filesystem::path> files;
    wear::BrakeWear wear;
    for (const std::string& surface : rig::surface_names(options.config)) {
        for (const std::string& maneuver : rig::maneuver_names(options.config)) {
            rig::ManeuverChoice choice;
            choice.maneuver = maneuver;
            choice.surface = surface;
            const rig::LoadedRig loaded = rig::load_rig(options.config, choice);
            plan.demand_Pa = loaded.full_pressure_Pa;
            plan.drop_out_mps = loaded.drop_out_mps;
            wear = loaded.wear;
            files = loaded.files;
            plan.scenarios.push_back({surface, maneuver, loaded.rig});
        }
    }
    files.insert(files.end(), {controller, layout.dbc, layout.binding});
    plan.config_hash = settings::hash(files);
    const BrakeLife brake{.life_J = wear.life_J, .friction = [&wear](double c_e_J, wear::Generator& generator) {
                              return wear::friction_at(*wear.model, wear.scale, {}, c_e_J, generator);
                          }};
    plan.landings = draw_landings(options.seed, options.landings, plan.scenarios.size(), brake);
    return plan;
}

}  // namespace sweep
