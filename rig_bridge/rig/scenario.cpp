#include "rig_bridge/rig/scenario.hpp"

#include "rig_bridge/rig/random.hpp"

namespace rig {

double Scenario::rolling_radius_m(double load_N) const {
    return rig.rig.wheel.free_radius_m - load_N / rig.rig.wheel.stiffness_Npm;
}

rig::Plan plan(const Scenario& scenario, std::uint64_t seed, std::int64_t number) {
    rig::Random campaign(seed);
    rig::Random draw(campaign.bits() ^ static_cast<std::uint64_t>(number));
    rig::Plan plan = scenario.mean;
    plan.speed_mps += scenario.scatter.speed_mps * draw.noise();
    plan.load_base_N += scenario.scatter.load_N * draw.noise();
    plan.deceleration_mps2 += scenario.scatter.deceleration_mps2 * draw.noise();
    const double v = plan.speed_mps;
    const double r = scenario.rolling_radius_m(plan.load_base_N - plan.load_lift_Ns2pm2 * v * v);
    const rig::WheelParameters& wheel = scenario.rig.rig.wheel;
    plan.rolling_radius_m = r;
    plan.wheel_share = wheel.inertia_kgm2 / (wheel.mass_kg * r * r);
    return plan;
}

}  // namespace rig
