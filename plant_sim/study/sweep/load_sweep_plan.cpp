#include "plant_sim/study/sweep/load_sweep_plan.hpp"

#include "firmware/can/load_layout.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/settings/hash.hpp"
#include "rig_bridge/rig/load_rig.hpp"

namespace sweep {

SweepPlan load_plan(const SweepPlanOptions& options) {
    const auto controller = options.config / "controller.toml";
    const auto dbc = options.config / "antiskid.dbc";
    const auto binding = options.config / "antiskid_binding.toml";
    SweepPlan plan;
    plan.references = options.references;
    plan.threshold = options.threshold;
    plan.seed = options.seed;
    plan.controller = antiskid::load_controller_config(controller);
    plan.layout = antiskid::can::load_layout(dbc, binding);
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
    files.insert(files.end(), {controller, dbc, binding});
    plan.config_hash = settings::hash(files);
    const BrakeLife brake{.life_J = wear.life_J, .friction = [&wear](double c_e_J, wear::Generator& generator) {
                              return wear::friction_at(*wear.model, wear.scale, {}, c_e_J, generator);
                          }};
    plan.landings = draw_landings(options.seed, options.landings, plan.scenarios.size(), brake);
    return plan;
}

}  // namespace sweep
