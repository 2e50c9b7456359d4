/// Repeats the maneuvers of a campaign in the plant with their recorded braking torque, as the paper's Fig. 9. Friction is that of the wear model,
/// pressure is computed from torque and friction, and energy is eq. (9) of the plant's own motion.
#pragma once

#include <functional>

#include "rig_bridge/rig/load_rig.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"

namespace study {

struct TorqueStop {
    double mean_friction = 0.0;  ///< eq. (7) down to `drop_out_mps`, from the plant's torque and pressure
    double energy_brake_J = 0.0;
    double duration_s = 0.0;
    double length_m = 0.0;
    /// Whether full pressure did not give the torque at some speed; the torque was less there.
    bool short_of_pressure = false;
};

/// One stop from `braking.brake_on_mps` to rest, with the wheel rolling freely before. Torque and load are constant from brake-on. Each millisecond
/// the pressure is T / k_b(v), at most `rig.full_pressure_Pa`; the valve is bypassed. `rig.rig.mean_friction` must be the brake's. The stop ends
/// after kLongestTorqueStop_s at the latest. Throws std::invalid_argument for a speed, torque or load that is not positive.
[[nodiscard]] TorqueStop stop_by_torque(const rig::LoadedRig& rig, const wear::Braking& braking);
inline constexpr double kLongestTorqueStop_s = 600.0;

struct TorqueReplay {
    wear::Campaign simulated;           ///< simulated c_e and friction by eq. (7), one point per maneuver
    std::size_t short_of_pressure = 0;  ///< number of maneuvers
    double energy_error = 0.0;          ///< simulated energy of all maneuvers minus the recorded, over the recorded
};

/// `brake`: state before the first maneuver; it takes the simulated energy. The model's friction is a reading of eq. (7), as in a recorded campaign:
/// the curve within a stop is adjusted so that eq. (7) gives that value (model/measured_friction.hpp). Throws std::invalid_argument for a campaign
/// without recorded torques. `progress`, if not empty, is called after each maneuver with the number done.
[[nodiscard]] TorqueReplay replay_torques(const wear::Campaign& recorded, const rig::LoadedRig& rig, wear::WearingBrake brake,
                                          const std::function<void(std::size_t)>& progress = {});

}  // namespace study
