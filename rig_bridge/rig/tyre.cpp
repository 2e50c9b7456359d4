#include "rig_bridge/rig/tyre.hpp"

#include <algorithm>
#include <numbers>

namespace rig {

Friction friction(const MagicFormula& law, double lambda) {
    // mu = D sin(C atan(w(u))) with u = B |lambda|; the chain rule, twice.
    const double u = law.B * std::abs(lambda);
    const double bent = 1.0 + u * u;
    const double w = u - law.E * (u - std::atan(u));
    const double w_1 = law.B * (1.0 - law.E * u * u / bent);
    const double w_2 = -2.0 * law.B * law.B * law.E * u / (bent * bent);
    const double flat = 1.0 + w * w;
    const double a_1 = w_1 / flat;
    const double a_2 = (w_2 - 2.0 * w * a_1 * w_1) / flat;
    const double angle = law.C * std::atan(w);
    const double sine = law.D * std::sin(angle), cosine = law.D * law.C * std::cos(angle);
    return {std::copysign(sine, lambda), cosine * a_1, std::copysign(1.0, lambda) * (cosine * a_2 - law.C * law.C * sine * a_1 * a_1)};
}

Peak peak(const FrictionLaw& law) {
    const double slope_ratio = law.c1 * law.c2 / law.c3;  // infinite for c3 = 0, and limited by the clamp
    const double slip = std::clamp(std::log(slope_ratio) / law.c2, 0.0, 1.0);
    return {slip, friction(law, slip).mu};
}

Peak peak(const MagicFormula& law) {
    // The argument of the sine is a right angle; w(u) increases, since E <= 1. Bisection, to the last bit.
    const double wanted = std::tan(0.5 * std::numbers::pi / law.C);
    const auto w = [&](double slip) { return law.B * slip - law.E * (law.B * slip - std::atan(law.B * slip)); };
    double low = 0.0, high = 1.0;
    if (w(high) > wanted) {
        for (double middle = 0.5; middle > low && middle < high; middle = 0.5 * (low + high)) (w(middle) < wanted ? low : high) = middle;
    }
    return {high, friction(law, high).mu};
}

MagicFormula magic_formula_with_peak(double slip, double mu, double C, double E) {
    constexpr double kSteep = 1e3;  // puts the peak at a slip far below 1
    MagicFormula law{.B = kSteep, .C = C, .D = mu, .E = E};
    law.B *= peak(law).slip / slip;
    return law;
}

Peak peak(const Surface& surface, double v_mps) {
    Peak at = peak(surface);
    if (surface.wet) at.mu = surface.wet->at(v_mps).mu;
    return at;
}

}  // namespace rig
