#include "rig_bridge/bridge/bridge_setup.hpp"

#include <stdexcept>

#include "firmware/can/roles.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/settings.hpp"
#include "rig_bridge/bridge/abort_hook.hpp"
#include "rig_bridge/rig/check_plan.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"
#include "rig_bridge/rig/same_rig.hpp"

namespace rig::bridge {

using antiskid::can::Role;

namespace {

/// Figures are counted from the load cells on the bus, which come from the registers.
antiskid::can::RequiredRange required_range(const antiskid::control::Config& controller, const RegisterMap& map) {
    antiskid::can::RequiredRange required = antiskid::required_range(controller);
    const Field& longitudinal = map.field(Measured::longitudinal_force_N);
    required.vertical_N.max = map.field(Measured::vertical_load_N).max;
    required.longitudinal_N = {.min = longitudinal.min, .max = longitudinal.max};
    required.brake_torque_Nm.max = map.field(Measured::brake_torque_Nm).max;
    return required;
}

Freshness load_freshness(const std::filesystem::path& file, const RegisterMap& map) {
    const settings::Document doc = settings::Document::load(file);
    const settings::Table t = doc.root().table("silent");
    constexpr settings::Range kLimit_ms{.min = 20.0, .max = 60e3};
    const auto seconds = [&](const char* key) { return 1e-3 * t.number(key, kLimit_ms); };
    Freshness limits;
    limits.sensors_s = seconds("sensors_ms");
    limits.controller_s = seconds("controller_ms");
    limits.registers_s = seconds("registers_ms");
    limits.recorder_s = seconds("recorder_ms");
    limits.commit_s = seconds("commit_ms");
    limits.watchdog_s = std::chrono::duration<double>(map.plc_timeout).count();
    limits.load_cells_late_s = std::chrono::duration<double>(map.load_cells_late).count();
    doc.finish();
    return limits;
}

}  // namespace

BridgeSetup load_setup(const RigOptions& o, const std::vector<std::filesystem::path>& also) {
    const antiskid::LayoutFiles layout(o.config, o.dbc, o.binding);
    const auto registers = o.registers.empty() ? o.config / "registers.toml" : o.registers;
    record::check_texts(o.specimen);
    if (!o.on_abort.empty()) check_hook(o.on_abort);
    const Scenario scenario = load_scenario(o.scenario, o.config);
    const RegisterMap map = load_register_map(registers);
    check(scenario.mean, map, registers);
    const antiskid::control::Config controller = antiskid::load_controller_config(scenario.controller);
    check_same_rig(scenario.rig, controller, scenario.controller);
    BridgeSetup s{.options = o,
                  .scenario = scenario,
                  .layout = layout.load(required_range(controller, map)),
                  .map = map,
                  .meter = {},
                  .limits = {},
                  .config_hash = {}};
    if (!s.layout.maneuver.has(static_cast<antiskid::control::Law>(s.scenario.mean.law)))
        throw std::invalid_argument(layout.dbc.string() + ": the law's field is too narrow for the scenario's law");
    s.meter = meter_parameters(s.scenario, controller);
    if (!s.layout[Role::maneuver_state].bound)
        throw std::invalid_argument(layout.binding.string() + ": [maneuver_state] is missing: figures are counted from it, the bridge needs it");
    if (o.lockstep && !s.layout.sync_counter.bound())
        throw std::invalid_argument(layout.binding.string() + ": [sync] has no number: --clock sync steps by it");
    if (o.lockstep && !s.map.bridge_turn)
        throw std::invalid_argument(registers.string() +
                                    ": [virtual.bridge_turn] is missing: --clock sync needs a virtual PLC that waits for the bridge");
    const auto bridge = o.config / "bridge.toml";
    s.limits = load_freshness(bridge, s.map);
    std::vector<std::filesystem::path> files = s.scenario.files;
    files.insert(files.end(), {layout.dbc, layout.binding, registers, bridge});
    files.insert(files.end(), also.begin(), also.end());
    s.config_hash = settings::hash(files);
    return s;
}

}  // namespace rig::bridge
