#include "plant_sim/study/robust/held_reference.hpp"

#include "firmware/control/slip_law.hpp"

namespace robust {

FrictionDistance held_distance(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference, double from_mps,
                               double to_mps) {
    constexpr int kParts = 4000;  // of the speed: 1.4 cm/s of 61 m/s, errors below 1e-6
    const double part_mps = (from_mps - to_mps) / kParts;
    FrictionDistance sum;
    for (int i = 0; i < kParts; ++i) {
        const double v_mps = to_mps + (i + 0.5) * part_mps;
        const float held = antiskid::control::falling_reference(config, static_cast<float>(slip_reference), static_cast<float>(v_mps));
        const double share = rig::friction(rig.surface, static_cast<double>(held)).mu / rig::peak(rig.surface).mu;
        // m v dv = -mu F_z ds
        const double mu_max = rig::peak(rig.surface, v_mps).mu;
        const double F_z = rig.load.base_N - rig.load.lift_Ns2pm2 * v_mps * v_mps;
        const double metres = rig.wheel.mass_kg * v_mps * part_mps / (share * mu_max * F_z);
        sum.had_m += share * mu_max * metres;
        sum.max_m += mu_max * metres;
    }
    return sum;
}

double held_j_mu(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference, double drop_out_mps) {
    const FrictionDistance sum = held_distance(rig, config, slip_reference, rig.brake_on_mps, drop_out_mps);
    return sum.had_m / sum.max_m;
}

}  // namespace robust
