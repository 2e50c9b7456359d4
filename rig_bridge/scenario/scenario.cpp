#include "rig_bridge/scenario/scenario.hpp"

#include "plant_sim/model/random.hpp"

namespace rig {

double Scenario::rolling_radius_m(double load_N) const {
    return rig.rig.wheel.free_radius_m - load_N / rig.rig.wheel.stiffness_Npm;
}

namespace {

/// The flywheel gives the wheel its spin: m (v_before - v) = J_w v / r^2.
double spin_up_cost_mps(const Scenario& scenario, const sequencer::Plan& plan) {
    const double v = plan.speed_mps;
    const double r = scenario.rolling_radius_m(plan.load_base_N - plan.load_lift_Ns2pm2 * v * v);
    const plant::WheelParameters& wheel = scenario.rig.rig.wheel;
    return v * wheel.inertia_kgm2 / (wheel.mass_kg * r * r);
}

}  // namespace

sequencer::Plan plan(const Scenario& scenario, std::uint64_t seed, std::int64_t number) {
    plant::Random campaign(seed);
    plant::Random draw(campaign.bits() ^ static_cast<std::uint64_t>(number));
    sequencer::Plan plan = scenario.mean;
    plan.speed_mps += scenario.scatter.speed_mps * draw.noise();
    plan.load_base_N += scenario.scatter.load_N * draw.noise();
    plan.deceleration_mps2 += scenario.scatter.deceleration_mps2 * draw.noise();
    plan.overspeed_mps = spin_up_cost_mps(scenario, plan) + scenario.coasting_mps;
    return plan;
}

}  // namespace rig
