/// Monitor and estimator on a standing rig that reports in every period; and times whose sums are not rounded.
#pragma once

#include "firmware/control/monitor.hpp"
#include "tests/control/fixed_config.hpp"

namespace control_test {

namespace control = antiskid::control;

/// Periods and maximum age whose quotient and products are exact.
inline control::Config exact_config() {
    control::Config config = fixed_config(kExact_s);
    config.monitor.sensor_max_age_s = 20.0F * kExact_s;
    config.monitor.implausible_s = kExact_s;  // a single reading is named
    config.wheel.encoder.max_acceleration_radps2 = 32.0F * 1024.0F;
    config.monitor.pressure_rate_Paps = 1e6F * 1024.0F;
    config.monitor.stuck_s = kExact_s;
    config.wheel.nominal_radius_m = config.flywheel.radius_m = 0.5F;
    config.wheel.lift_Ns2pm2 = 0.0F;
    return config;
}

/// Estimator and monitor with a standing rig that reports in every period.
struct Watch {
    explicit Watch(const control::Config& with = fixed_config()) : config(with), estimator(with), monitor(with) {
        sensors.wheel.source = sensors.flywheel.source = control::SpeedSource::speed;
    }
    control::FaultSet step() {
        now += config.period_s == kExact_s ? control::Time{976'562} : kMillisecond;
        sensors.wheel.received = sensors.flywheel.received = sensors.pressure.received = now;
        sensors.maneuver.received = sensors.rig_heartbeat_received = now;
        return silent_step();
    }
    control::FaultSet silent_step() {
        estimator.update(sensors, control::valve_pressure_Pa(config.valve, current_mA));
        return monitor.check(sensors, estimator, previous, now);
    }

    control::Config config;
    control::Estimator estimator;
    control::Monitor monitor;
    control::Sensors sensors;
    control::Time now{};
    float current_mA = 0.0F;
    control::Monitor::PreviousStep previous{};
};

}  // namespace control_test
