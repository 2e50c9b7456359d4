#include "plant_sim/study/robust/held_reference.hpp"

#include "firmware/control/slip_law.hpp"

namespace robust {

double held_j_mu(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference, double drop_out_mps) {
    constexpr int kParts = 4000;  // of the speed: 1.4 cm/s of 61 m/s, errors below 1e-6
    const double part_mps = (rig.brake_on_mps - drop_out_mps) / kParts;
    double friction_m = 0.0, max_m = 0.0;  // both times the friction of an instant over the mass
    for (int i = 0; i < kParts; ++i) {
        const double v_mps = drop_out_mps + (i + 0.5) * part_mps;
        const float held = antiskid::control::falling_reference(config, static_cast<float>(slip_reference), static_cast<float>(v_mps));
        const double share = rig::friction(rig.surface, static_cast<double>(held)).mu / rig::peak(rig.surface).mu;
        // m v dv = -mu F_z ds
        const double mu_max = rig::peak(rig.surface, v_mps).mu;
        const double F_z = rig.load.base_N - rig.load.lift_Ns2pm2 * v_mps * v_mps;
        const double metres = v_mps / (share * mu_max * F_z);
        friction_m += share * mu_max * metres;
        max_m += mu_max * metres;
    }
    return friction_m / max_m;
}

}  // namespace robust
