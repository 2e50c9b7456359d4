/// A rig, its PLC and its controller as the sequencer meets them, as simple as can be: enough to run a maneuver through.
#pragma once

#include <algorithm>

#include "rig_bridge/rig/sequencer.hpp"
#include "tests/catch.hpp"

namespace sequencer_test {

using rig::Inputs;
using rig::Outputs;
using rig::Phase;
using rig::Plan;

inline constexpr double kWheelRadius_m = 0.32;

inline Plan landing() {
    Plan plan;
    plan.speed_mps = 50.0;
    plan.wheel_share = 0.003;
    plan.rolling_radius_m = kWheelRadius_m;
    plan.coasting_mps = 0.05;
    plan.load_base_N = 30e3;
    plan.load_lift_Ns2pm2 = 3.0;
    plan.law = rig::BrakeLaw::slip;
    plan.demand_Pa = 20e6;
    plan.slip_reference = 0.24;
    plan.brake_on_limit_C = 300.0;
    plan.cool_to_C = 100.0;
    return plan;
}

/// Everything good, at rest, sledge back.
inline Inputs healthy() {
    Inputs in;
    in.plc_fresh = in.plc_ready = true;
    in.emergency_stop_clear = in.guard_closed = in.hydraulics_ready = in.drive_healthy = true;
    in.brake_temperature_C = 20.0;
    in.bus_up = in.bus_read = in.sensors_fresh = in.controller_fresh = in.controller_standby = true;
    return in;
}

class RigModel {
  public:
    Inputs inputs = healthy();
    double rolling_loss_mps2 = 0.02;  ///< of the flywheel while it runs free; with the wheel on it, none
    double wheel_loss_radps2 = 3.0;   ///< of the wheel off the rim
    double wheel_share = 0.003;       ///< inertia of the wheel, at the rim, over the flywheel's

    void advance(const Outputs& out, double h) {
        const bool brakes = armed_ && out.demand_Pa > 0.0 && inputs.wheel_on_rim;
        if (out.drive_enable)
            inputs.flywheel_mps += std::clamp(out.flywheel_set_mps - inputs.flywheel_mps, 0.0, 10.0 * h);
        else
            inputs.flywheel_mps -= (brakes ? 8.0 : inputs.wheel_on_rim ? 0.0 : rolling_loss_mps2) * h;
        inputs.flywheel_mps = std::max(0.0, inputs.flywheel_mps);
        inputs.sledge_m = std::clamp(inputs.sledge_m + (out.sledge_advance ? 0.1 : -0.1) * h, 0.0, 0.25);
        const bool touches = inputs.sledge_m >= 0.25;
        if (touches && !inputs.wheel_on_rim)  // the momentum is shared out
            inputs.flywheel_mps = (inputs.flywheel_mps + wheel_share * kWheelRadius_m * inputs.wheel_radps) / (1.0 + wheel_share);
        inputs.wheel_on_rim = touches;
        const double v = inputs.rim_mps = inputs.flywheel_mps;
        inputs.wheel_radps = touches ? v / kWheelRadius_m : std::max(0.0, inputs.wheel_radps - wheel_loss_radps2 * h);
        const double law_N = out.load_enable ? out.load_base_N - out.load_lift_Ns2pm2 * v * v : 500.0;
        inputs.load_N = touches ? inputs.load_N + (law_N - inputs.load_N) * std::min(1.0, h / 0.1) : 0.0;
        inputs.wheel_rim_mps = kWheelRadius_m * inputs.wheel_radps;
        inputs.pressure_Pa = brakes ? 8e6 : 0.0;
        inputs.brake_temperature_C = brakes ? inputs.brake_temperature_C + 30.0 * h : std::max(20.0, inputs.brake_temperature_C - 5.0 * h);
        armed_ = out.arm && !out.emergency_stop && (armed_ || inputs.controller_standby);
        inputs.controller_armed = armed_;
        inputs.controller_standby = !armed_;
    }

  private:
    bool armed_ = false;
};

inline constexpr double kStep_s = 0.01;

/// Runs until `stop` says so or `limit_s` has passed; the outputs of the last step.
template <typename Stop>
Outputs run(rig::Sequencer& s, RigModel& rig, double& now_s, const Stop& stop, double limit_s = 600.0) {
    Outputs out;
    for (const double end = now_s + limit_s; now_s < end; now_s += kStep_s) {
        out = s.step(rig.inputs, now_s);
        if (stop(out)) break;
        rig.advance(out, kStep_s);
    }
    return out;
}

inline Outputs run_to(rig::Sequencer& s, RigModel& rig, double& now_s, Phase phase) {
    return run(s, rig, now_s, [phase](const Outputs& out) { return out.phase == phase; });
}

inline constexpr Phase kActive[] = {Phase::spin_up,    Phase::touchdown, Phase::settling, Phase::braking,
                                    Phase::standstill, Phase::retract,   Phase::cool_down};

/// A maneuver that has got into a phase without mishap.
struct Reached {
    rig::Sequencer sequencer;
    RigModel rig;
    double now_s = 0.0;

    explicit Reached(Phase phase, const rig::Plan& plan = landing()) : sequencer(plan) {
        run_to(sequencer, rig, now_s, phase);
        REQUIRE(sequencer.phase() == phase);
    }
    Outputs next(const Inputs& in) { return sequencer.step(in, now_s += kStep_s); }
};

/// What every output of a safe end must be.
inline bool safe(const Outputs& out) {
    return !out.drive_enable && out.flywheel_set_mps == 0.0 && !out.sledge_advance && !out.load_enable && !out.arm && out.demand_Pa == 0.0 &&
           out.current_mA == 0.0;
}

}  // namespace sequencer_test
