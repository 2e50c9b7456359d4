#include "rig_bridge/bridge/trace.hpp"

#include <fmt/format.h>

namespace rig::bridge {

using rig::Phase;

void Trace::record(const Moment& m) {
    const Phase phase = m.outputs.phase;
    if (phase < Phase::touchdown || phase > Phase::retract) return;
    if (rows_.empty()) began_s_ = m.rig_s;
    const double time_s = m.rig_s - began_s_;
    if (phase == Phase::braking && !brake_on_s_) brake_on_s_ = time_s;
    rows_.push_back({time_s, m.bus.rim_mps, m.inputs.wheel_rim_mps, m.bus.slip, static_cast<double>(m.bus.view.controller.slip_reference),
                     m.outputs.demand_Pa, m.inputs.pressure_Pa, m.inputs.load_N, m.plc.value(Measured::brake_torque_Nm)});
}

std::string Trace::csv() const {
    std::string text =
        "time_s,speed_mps,wheel_rim_speed_mps,slip,slip_reference,pressure_demand_Pa,pressure_Pa,vertical_"
        "load_N,brake_torque_Nm\n";
    for (const Row& r : rows_)
        text += fmt::format("{:.3f},{:.4f},{:.4f},{:.5f},{:.5f},{:.0f},{:.0f},{:.1f},{:.1f}\n", r.time_s, r.rim_mps, r.wheel_mps, r.slip,
                            r.slip_reference, r.demand_Pa, r.pressure_Pa, r.load_N, r.torque_Nm);
    return text;
}

}  // namespace rig::bridge
