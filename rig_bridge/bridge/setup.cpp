#include "rig_bridge/bridge/setup.hpp"

#include <stdexcept>

#include "config/reader/hash.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/can/roles.hpp"
#include "firmware/linux/controller_config.hpp"
#include "rig_bridge/scenario/meter_parameters.hpp"

namespace rig {

using antiskid::can::Role;

Setup load_setup(const RigOptions& o) {
    const auto dbc = o.dbc.empty() ? o.config / "antiskid.dbc" : o.dbc;
    const auto binding = o.binding.empty() ? o.config / "antiskid_binding.toml" : o.binding;
    const auto registers = o.registers.empty() ? o.config / "registers.toml" : o.registers;
    Setup s{.options = o,
            .scenario = load_scenario(o.scenario, o.config),
            .layout = antiskid::can::load_layout(dbc, binding),
            .map = load_register_map(registers),
            .meter = {},
            .config_hash = {}};
    const auto controller = antiskid::load_controller_config(s.scenario.controller);
    s.meter = meter_parameters(s.scenario, static_cast<double>(controller.period_s));
    if (!s.layout[Role::maneuver_state].bound)
        throw std::invalid_argument(
            binding.string() +
            ": [maneuver_state] is missing: figures are counted from it, the bridge needs it");
    std::vector<std::filesystem::path> files = s.scenario.files;
    files.insert(files.end(), {dbc, binding, registers});
    s.config_hash = settings::hash(files);
    return s;
}

}  // namespace rig
