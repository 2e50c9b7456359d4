#include "plant_sim/study/faults/explain.hpp"

#include <algorithm>
#include <cmath>

#include "plant_sim/study/robust/uncertainty.hpp"

namespace faults {

namespace {

struct Seen {
    Result result;
    Signs signs{};
    double at_m = 0.0;  ///< along the runway, where the fault began
};

Seen look_at(const FaultPlan& plan, const Case& c, const FaultFree& sound) {
    Seen seen;
    Witness witness(plan.controller);
    bool begun = false;
    seen.result = run_one(plan, c, sound, [&](const Period& p) {
        if (p.begun && !begun) seen.at_m = p.session.rig().runway_m();
        begun = p.begun;
        if (p.given != nullptr) witness.take(*p.given, p.command, p.begun);
    });
    seen.signs = witness.signs();
    return seen;
}

/// The same stop on `rig` without a fault, with the runway's friction multiplied by `grip` from `from_m` on.
FaultPlan on_runway(const FaultPlan& plan, const Case& c, rig::RigParameters rig, double grip, double from_m) {
    FaultPlan other = plan;
    rig::Surface less = rig.surface;
    less.c1 *= grip;
    less.c3 *= grip;
    rig.runway = {.patches = {{from_m, less}}};
    other.surfaces[c.surface].rig = rig;
    return other;
}

Case without_fault(Case c) {
    c.fault.lasts_s = 0.0;
    return c;
}

void widen(std::array<Span, kSignNames.size()>& spans, const Signs& signs, bool first) {
    for (std::size_t i = 0; i < signs.size(); ++i) {
        spans[i].least = first ? signs[i] : std::min(spans[i].least, signs[i]);
        spans[i].most = first ? signs[i] : std::max(spans[i].most, signs[i]);
    }
}

}  // namespace

Explanation explain(const FaultPlan& plan, const Case& c, const robust::Basis& basis, const ExplainOptions& options) {
    const FaultFree sound = run_fault_free(plan, c);
    const Seen faulty = look_at(plan, c, sound);
    Explanation e{.run = c, .result = faulty.result, .seen = faulty.signs};
    const rig::RigParameters& rig = plan.surfaces[c.surface].rig;
    const double wanted = faulty.result.verdict.distance_share;
    const Case twin = without_fault(c);
    // Less friction gives a longer stop: bisection in the logarithm.
    constexpr int kHalvings = 9;
    constexpr double kLeast = 0.05;
    const auto share_at = [&](double grip) { return run_one(on_runway(plan, c, rig, grip, faulty.at_m), twin, sound).verdict.distance_share; };
    double low = kLeast, high = 1.0;
    if (wanted > 1.0) {
        for (int i = 0; i < kHalvings; ++i) {
            const double middle = std::sqrt(low * high);
            (share_at(middle) > wanted ? low : high) = middle;
        }
    }
    e.grip = high;
    e.twin_share = share_at(e.grip);
    for (std::size_t i = 0; i < options.twins; ++i) {
        Case other = twin;
        other.sensor_seed += i + 1;  // another seed than the run's: its own noise would not show the scatter
        const Seen seen = look_at(on_runway(plan, c, rig, e.grip, faulty.at_m), other, sound);
        widen(e.twins, seen.signs, i == 0);
    }
    for (std::size_t i = 0; i < options.rigs; ++i) {
        rig::RigParameters drawn = robust::draw(basis, robust::Family::all, options.rig_seed, i).rig;
        drawn.surface = rig.surface;
        const Seen seen = look_at(on_runway(plan, c, drawn, e.grip, faulty.at_m), twin, sound);
        widen(e.drawn, seen.signs, i == 0);
    }
    return e;
}

}  // namespace faults
