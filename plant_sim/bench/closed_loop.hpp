/// One stop in closed loop down to drop-out, with either plant: sensors, rounding by the codec, the real controller at 1 kHz.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware/can/rounded_link.hpp"
#include "firmware/control/controller.hpp"
#include "plant_sim/bench/odeint_plant.hpp"
#include "plant_sim/plc/speed_sample.hpp"
#include "plant_sim/study/pilot.hpp"

namespace bench {

inline constexpr antiskid::control::Time kPeriod{1'000'000};

struct Loop {
    const antiskid::control::Config& controller;
    const antiskid::can::Layout& layout;
    const study::ManeuverPlan& plan;
    double drop_out_mps;
};

struct Stop {
    std::int64_t steps = 0;
    double distance_m = 0.0;
    std::vector<antiskid::control::Sensors> seen;  // only on request
};

inline double speed_of(const plant::Rig& rig) {
    return rig.wheel().v_mps;
}
inline double speed_of(const OdeintRig& rig) {
    return rig.v_mps();
}
inline double distance_of(const plant::Rig& rig) {
    return rig.wheel().distance_m;
}
inline double distance_of(const OdeintRig& rig) {
    return rig.distance_m();
}

template <typename Plant>
Stop stop(Plant& rig, const Loop& loop, bool keep = false) {
    constexpr double kLongest_s = 600.0;
    study::Pilot pilot(loop.plan);
    antiskid::can::RoundedLink link(loop.layout, kPeriod);
    antiskid::control::Controller controller(loop.controller);
    antiskid::can::RigSample sample;
    Stop out;
    bool touched = false;
    while (speed_of(rig) > loop.drop_out_mps && rig.time_s() < kLongest_s) {
        sample.wheel = plc::speed_sample(rig.wheel_encoder(), rig.time_s());
        sample.flywheel = plc::speed_sample(rig.flywheel_encoder(), rig.time_s());
        sample.pressure_Pa = static_cast<float>(rig.measured_pressure_Pa());
        sample.maneuver = pilot.command();
        const antiskid::control::Time now = kPeriod * out.steps;
        const antiskid::control::Sensors& sensors = link.sense(sample, now);
        if (keep) out.seen.push_back(sensors);
        const antiskid::control::Command command = controller.step(sensors, now);
        rig.advance_current(static_cast<double>(link.current_mA(command)));
        pilot.update(rig.time_s(), false);
        if (!touched && pilot.phase() != study::StopPhase::approach) {
            rig.touch_down();
            touched = true;
        }
        ++out.steps;
    }
    out.distance_m = distance_of(rig);
    return out;
}

}  // namespace bench
