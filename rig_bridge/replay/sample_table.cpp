#include "rig_bridge/replay/sample_table.hpp"

#include <array>
#include <limits>

namespace rig::replay {

namespace {

using antiskid::can::BusView;
using antiskid::can::Role;
using antiskid::control::kNever;
using antiskid::control::Time;

double said(float value, Time received) {
    return received == kNever ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(value);
}

double code(std::uint32_t value, Time received) {
    return received == kNever ? std::numeric_limits<double>::quiet_NaN() : value;
}

struct Column {
    const char* name;
    Role role;
    double (*value)(const BusView& view);
};

constexpr std::array<Column, 13> kSaid{{
    {"slip", Role::status, [](const BusView& v) { return said(v.controller.slip, v.controller.status_received); }},
    {"slip_reference", Role::status, [](const BusView& v) { return said(v.controller.slip_reference, v.controller.status_received); }},
    {"pressure_Pa", Role::pressure, [](const BusView& v) { return said(v.pressure.pressure_Pa, v.pressure.received); }},
    {"pressure_demand_Pa", Role::maneuver, [](const BusView& v) { return said(v.maneuver.demand_Pa, v.maneuver.received); }},
    {"valve_current_mA", Role::valve, [](const BusView& v) { return said(v.controller.current_mA, v.controller.command_received); }},
    {"vertical_load_N", Role::load_cells, [](const BusView& v) { return said(v.load_cells.vertical_N, v.load_cells_received); }},
    {"longitudinal_force_N", Role::load_cells, [](const BusView& v) { return said(v.load_cells.longitudinal_N, v.load_cells_received); }},
    {"brake_torque_Nm", Role::load_cells, [](const BusView& v) { return said(v.load_cells.brake_torque_Nm, v.load_cells_received); }},
    {"brake_temperature_C", Role::maneuver_state,
     [](const BusView& v) { return said(v.maneuver_state.brake_temperature_C, v.maneuver_state_received); }},
    {"phase", Role::maneuver_state, [](const BusView& v) { return code(v.maneuver_state.phase, v.maneuver_state_received); }},
    {"maneuver", Role::maneuver_state, [](const BusView& v) { return code(v.maneuver_state.number, v.maneuver_state_received); }},
    {"state", Role::status, [](const BusView& v) { return code(static_cast<std::uint32_t>(v.controller.state), v.controller.status_received); }},
    {"faults", Role::faults, [](const BusView& v) { return code(v.controller.faults.bits(), v.controller.faults_received); }},
}};

}  // namespace

SampleTable::SampleTable(MeasuredSignals& signals, const antiskid::can::Layout& layout, const record::MeterParameters& rig)
    : signals_(signals),
      layout_(layout),
      flywheel_radius_m_(rig.flywheel_radius_m),
      wheel_radius_m_(rig.wheel_radius_m),
      wheel_(rig.wheel_teeth),
      flywheel_(rig.flywheel_teeth),
      columns_{"time_s", "speed_mps", "wheel_rim_speed_mps", "wheel_speed_radps"} {
    for (const Column& column : kSaid)
        if (layout[column.role].bound) columns_.emplace_back(column.name);
}

bool SampleTable::next(std::vector<double>& row) {
    if (!signals_.next()) return false;
    const BusView& view = signals_.view();
    const double now_s = signals_.time_s();
    const double wheel_radps = wheel_.at(view.wheel, now_s);
    row.assign({now_s, flywheel_.at(view.flywheel, now_s) * flywheel_radius_m_, wheel_radps * wheel_radius_m_, wheel_radps});
    for (const Column& column : kSaid)
        if (layout_[column.role].bound) row.push_back(column.value(view));
    return true;
}

}  // namespace rig::replay
