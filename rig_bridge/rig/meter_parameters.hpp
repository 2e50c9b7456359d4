/// Makes the meter's parameters from a rig's configuration.
#pragma once

#include "firmware/control/config.hpp"
#include "rig_bridge/record/meter.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace rig {

/// `period_s`: the controller's.
[[nodiscard]] inline record::MeterParameters meter_parameters(const rig::LoadedRig& loaded, double period_s) {
    const rig::RigParameters& r = loaded.rig;
    return {.wheel_teeth = r.wheel_encoder.teeth,
            .flywheel_teeth = r.flywheel_encoder.teeth,
            .flywheel_radius_m = r.flywheel_radius_m,
            .wheel_radius_m = r.wheel.free_radius_m,
            .wheel_stiffness_Npm = r.wheel.stiffness_Npm,
            .brake_gain_m3 = r.brake.gain_m3(),
            .contact_pressure_Pa = r.clamping.contact_Pa,
            .wheel_inertia_kgm2 = r.wheel.inertia_kgm2,
            .flywheel_mass_kg = r.wheel.mass_kg,
            .peak_friction = r.runway.patches.empty() ? rig::peak(r.surface).mu : 0.0,
            .drop_out_mps = loaded.drop_out_mps,
            .period_s = period_s};
}

/// The same with limits of plausible sensor values, from the controller's configuration.
[[nodiscard]] inline record::MeterParameters meter_parameters(const Scenario& scenario, const antiskid::control::Config& controller) {
    record::MeterParameters p = meter_parameters(scenario.rig, static_cast<double>(controller.period_s));
    p.wheel_max_radps = static_cast<double>(controller.wheel.encoder.max_speed_radps);
    p.flywheel_max_radps = static_cast<double>(controller.flywheel.encoder.max_speed_radps);
    p.sensor_late_s = static_cast<double>(controller.monitor.sensor_max_age_s);
    p.energy_band = scenario.energy_band;
    p.friction = scenario.rig.rig.mean_friction;
    return p;
}

}  // namespace rig
