/// The paper's Fig. 9 through the plant: the maneuvers of a campaign again with their recorded braking torque fed in. Friction is the wear
/// model's; pressure is what gives the torque with that friction, and energy is eq. (9) from the plant's own motion.
#pragma once

#include <cstdint>
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
    /// Full pressure does not give the torque at some speed; it gives less there.
    bool short_of_pressure = false;
};

/// One stop from `braking.brake_on_mps` to rest, the wheel rolling freely before. The torque is held from brake-on; each millisecond pressure is
/// T / k_b(v), at most `rig.full_pressure_Pa`, the valve bypassed. The load is held, too. `rig.rig.mean_friction` is the brake's. A stop that lasts
/// longer than kLongestTorqueStop_s ends there. Throws std::invalid_argument for a speed, torque or load that is not positive.
[[nodiscard]] TorqueStop stop_by_torque(const rig::LoadedRig& rig, const wear::Braking& braking);
inline constexpr double kLongestTorqueStop_s = 600.0;

struct TorqueReplay {
    wear::Campaign simulated;           ///< c_e that the plant came to, and eq. (7); one point a maneuver
    std::size_t short_of_pressure = 0;  ///< maneuvers
    double energy_error = 0.0;          ///< simulated energy of all maneuvers less the recorded, over the recorded
};

/// `brake` is as it was before the first maneuver; it takes what the plant says. Its model's friction is what eq. (7) reads, as that of a
/// recorded campaign is: the curve within a stop is brought to the mean that reads so (model/measured_friction.hpp). Throws std::invalid_argument for
/// a campaign without recorded torques. `progress`, when given, is called after each maneuver with how many are done.
[[nodiscard]] TorqueReplay replay_torques(const wear::Campaign& recorded, const rig::LoadedRig& rig, wear::WearingBrake brake,
                                          const std::function<void(std::size_t)>& progress = {});

}  // namespace study
