#include "plant_sim/python/regulator.hpp"

#include "rig_bridge/rig/load_rig.hpp"
#include "rig_bridge/wear/regulation_config.hpp"

namespace plant_sim::python {

wear::Regulator regulator_of(const RegulatorRequest& request) {
    wear::RegulationConfig config = wear::load_regulation_config(request.config / "regulation.toml");
    if (request.landings) config.plan.landings = *request.landings;
    if (request.brake_taken_J) config.plan.brake_taken_J = *request.brake_taken_J;
    if (request.tyre_life_J) config.plan.tyre_life_J = *request.tyre_life_J;
    const double life_J = request.brake_life_J ? *request.brake_life_J : rig::load_rig(request.config, {}).wear.life_J;
    return {wear::plan_of(config, life_J, request.landing_J, request.landing_deviation_J), config.rules, config.range()};
}

}  // namespace plant_sim::python
