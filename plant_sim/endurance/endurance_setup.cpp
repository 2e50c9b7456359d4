#include "plant_sim/endurance/endurance_setup.hpp"

#include <vector>

#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/settings/hash.hpp"
#include "plant_sim/plc/load_served_rig.hpp"
#include "rig_bridge/rig/same_rig.hpp"

namespace endurance {

EnduranceSetup load_setup(const std::filesystem::path& scenario, const std::filesystem::path& config) {
    const rig::Scenario loaded = rig::load_scenario(scenario, config);
    const antiskid::LayoutFiles layout(config);
    std::vector<std::filesystem::path> files = loaded.files;
    plc::ServedRigOptions machinery = plc::load_served_rig(config, loaded.endurance() ? plc::Bench::endurance : plc::Bench::landing);
    machinery.brake.emplace(loaded.rig.wear, wear::ConditionalRule{}, wear::BrakeState{});
    const antiskid::control::Config controller = antiskid::load_controller_config(loaded.controller);
    rig::check_same_rig(loaded.rig, controller, loaded.controller);
    antiskid::can::RequiredRange required = antiskid::required_range(controller);
    const rig::RigParameters& r = loaded.rig.rig;
    required.vertical_N.max = machinery.machinery.loading.force_max_N;
    required.brake_torque_Nm.max = r.brake.gain_m3() * r.mean_friction * loaded.rig.full_pressure_Pa;
    files.insert(files.end(), {loaded.controller, plc::machinery_file(config), layout.dbc, layout.binding});
    return {
        .scenario = loaded, .controller = controller, .layout = layout.load(required), .machinery = machinery, .config_hash = settings::hash(files)};
}

}  // namespace endurance
