#include "plant_sim/study/faults/explain.hpp"

#include <algorithm>
#include <cmath>

#include "plant_sim/study/robust/uncertainty.hpp"

namespace faults {

namespace {

struct Measured {
    Result result;
    Symptoms symptoms{};
    double began_m = 0.0;  ///< position on the runway at which the fault began
};

Measured measure(const FaultPlan& plan, const Case& c, const FaultFree& fault_free) {
    Measured measured;
    SymptomMeter meter(plan.controller);
    bool begun = false;
    measured.result = run_one(plan, c, fault_free, [&](const Period& p) {
        if (p.begun && !begun) measured.began_m = p.session.rig().runway_m();
        begun = p.begun;
        if (p.given != nullptr) meter.take(*p.given, p.command, p.begun);
    });
    measured.symptoms = meter.symptoms();
    return measured;
}

/// The same stop on `rig` without a fault, with the runway's friction multiplied by `grip` from `from_m` on.
FaultPlan on_runway(const FaultPlan& plan, const Case& c, rig::RigParameters rig, double grip, double from_m) {
    FaultPlan other = plan;
    rig::Surface less = rig.surface;
    less.c1 *= grip;
    less.c3 *= grip;
    if (less.magic) less.magic->D *= grip;
    rig.runway = {.patches = {{from_m, less}}};
    other.surfaces[c.surface].rig = rig;
    return other;
}

Case without_fault(Case c) {
    c.fault.lasts_s = 0.0;
    return c;
}

void widen(std::array<Span, kSymptomNames.size()>& spans, const Symptoms& symptoms, bool first) {
    for (std::size_t i = 0; i < symptoms.size(); ++i) {
        spans[i].least = first ? symptoms[i] : std::min(spans[i].least, symptoms[i]);
        spans[i].most = first ? symptoms[i] : std::max(spans[i].most, symptoms[i]);
    }
}

}  // namespace

Explanation explain(const FaultPlan& plan, const Case& c, const robust::Basis& basis, const ExplainOptions& options) {
    const FaultFree fault_free = run_fault_free(plan, c);
    const Measured faulty = measure(plan, c, fault_free);
    Explanation e{.run = c, .result = faulty.result, .symptoms = faulty.symptoms};
    const rig::RigParameters& rig = plan.surfaces[c.surface].rig;
    const double wanted = faulty.result.verdict.distance_share;
    const Case twin = without_fault(c);
    // Less friction gives a longer stop: bisection in the logarithm.
    constexpr int kHalvings = 9;
    constexpr double kLeast = 0.05;
    const auto share_at = [&](double grip) {
        return run_one(on_runway(plan, c, rig, grip, faulty.began_m), twin, fault_free).verdict.distance_share;
    };
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
        widen(e.twins, measure(on_runway(plan, c, rig, e.grip, faulty.began_m), other, fault_free).symptoms, i == 0);
    }
    for (std::size_t i = 0; i < options.rigs; ++i) {
        rig::RigParameters drawn = robust::draw(basis, robust::Family::all, options.rig_seed, i).rig;
        drawn.surface = rig.surface;
        widen(e.drawn, measure(on_runway(plan, c, drawn, e.grip, faulty.began_m), twin, fault_free).symptoms, i == 0);
    }
    return e;
}

}  // namespace faults
