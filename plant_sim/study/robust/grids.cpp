#include "plant_sim/study/robust/grids.hpp"

namespace robust {

namespace {

/// Landings of the same mass on the other surfaces.
std::vector<std::size_t> beside(const Basis& basis, std::size_t landing) {
    const NominalLanding& from = basis.landings[landing];
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < basis.landings.size(); ++i)
        if (basis.landings[i].maneuver == from.maneuver && basis.landings[i].surface != from.surface) others.push_back(i);
    return others;
}

Draw at_speed(const Basis& basis, std::size_t landing, double brake_on_mps) {
    Draw stop{.landing = landing, .rig = basis.landings[landing].rig};
    stop.rig.brake_on_mps = brake_on_mps;
    stop.rig.touchdown_mps = 0.0;
    return stop;
}

/// Computes backwards from the change: the speed from which braking at peak friction reaches the change in time, and its place.
Draw with_change(const Basis& basis, const SurfaceChange& change) {
    constexpr int kSteps = 1500;
    constexpr double kStep_s = 1e-3;
    const rig::RigParameters& rig = basis.landings[change.from].rig;
    const double max = rig::peak(rig.surface).mu;
    const study::ManeuverPlan plan;
    double v_mps = change.speed_mps, from_m = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        v_mps += max * (rig.load.base_N - rig.load.lift_Ns2pm2 * v_mps * v_mps) / rig.wheel.mass_kg * kStep_s;
        from_m += v_mps * kStep_s;
    }
    from_m += v_mps * (plan.touchdown_s + plan.settle_s);
    Draw stop = at_speed(basis, change.from, v_mps);
    stop.rig.runway.patches = {{from_m, basis.landings[change.to].rig.surface}};
    return stop;
}

}  // namespace

std::size_t grid_size(const Basis& basis, Family family) {
    const std::size_t landings = basis.landings.size();
    if (family == Family::brake_on) return landings * basis.uncertainty.brake_on_mps.size();
    if (family != Family::changes) return 0;
    return landings * beside(basis, 0).size() * basis.uncertainty.change_mps.size();
}

BrakeOn brake_on_at(const Basis& basis, std::size_t number) {
    const std::vector<double>& speeds = basis.uncertainty.brake_on_mps;
    const std::size_t landings = basis.landings.size(), landing = number % landings;
    // Any first few stops have all speeds, so that a tuner can use a part.
    return {.landing = landing, .speed_mps = speeds[(landing + number / landings) % speeds.size()]};
}

SurfaceChange change_at(const Basis& basis, std::size_t number) {
    const std::vector<double>& speeds = basis.uncertainty.change_mps;
    const std::size_t landings = basis.landings.size(), from = number % landings;
    const std::vector<std::size_t> others = beside(basis, from);
    const std::size_t rest = number / landings;
    return {.from = from, .to = others[rest % others.size()], .speed_mps = speeds[rest / others.size() % speeds.size()]};
}

Draw grid_stop(const Basis& basis, Family family, std::size_t number) {
    if (family == Family::changes) return with_change(basis, change_at(basis, number));
    const BrakeOn at = brake_on_at(basis, number);
    return at_speed(basis, at.landing, at.speed_mps);
}

}  // namespace robust
