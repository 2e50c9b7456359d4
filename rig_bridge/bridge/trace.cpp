#include "rig_bridge/bridge/trace.hpp"

#include "firmware/host/settings/text_table.hpp"

namespace rig::bridge {

using rig::Phase;

void Trace::record(const Moment& m) {
    const Phase phase = m.outputs.phase;
    if (phase < Phase::touchdown || phase > Phase::retract) return;
    if (rows_.empty()) began_s_ = m.rig_s;
    const double time_s = m.rig_s - began_s_;
    if (phase == Phase::braking && !brake_on_s_) brake_on_s_ = time_s;
    rows_.push_back({{time_s, m.bus.rim_mps, m.inputs.wheel_rim_mps, m.bus.slip, static_cast<double>(m.bus.view.controller.slip_reference),
                      m.outputs.demand_Pa, m.inputs.pressure_Pa},
                     m.inputs.load_N,
                     m.plc.value(Measured::brake_torque_Nm)});
}

std::vector<pictures::StopRow> Trace::rows() const {
    std::vector<pictures::StopRow> out;
    for (const Row& r : rows_) out.push_back(r.stop);
    return out;
}

std::string Trace::csv() const {
    auto csv = settings::TextTable::csv(
        "time_s:.3f|speed_mps:.4f|wheel_rim_speed_mps:.4f|slip:.5f|slip_reference:.5f|pressure_demand_Pa:.0f|pressure_Pa:.0f|vertical_load_N:.1f|"
        "brake_torque_Nm:.1f");
    for (const auto& [r, load_N, torque_Nm] : rows_)
        csv.add(r.time_s, r.speed_mps, r.wheel_rim_speed_mps, r.slip, r.slip_reference, r.demand_Pa, r.pressure_Pa, load_N, torque_Nm);
    return csv.text();
}

}  // namespace rig::bridge
