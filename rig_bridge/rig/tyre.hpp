/// Tyre-runway friction after Burckhardt, eq. (4), continued as an odd function to negative slip (overspeed).
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "rig_bridge/rig/wet_grip.hpp"
#include "rig_bridge/wear/fast_exp.hpp"

namespace rig {

/// mu(lambda) = c1 (1 - exp(-c2 lambda)) - c3 lambda for lambda >= 0, eq. (4). c1, c2 > 0, c3 >= 0, all dimensionless.
struct FrictionLaw {
    double c1 = 0.0;
    double c2 = 0.0;
    double c3 = 0.0;
};

/// One runway surface. On a wet one the curve over slip is scaled at every speed, so that its peak is that of `wet`.
struct Surface {
    std::string name;
    double c1 = 0.0;
    double c2 = 0.0;
    double c3 = 0.0;
    std::optional<WetGrip> wet{};

    [[nodiscard]] FrictionLaw law() const { return {c1, c2, c3}; }
};

/// Friction coefficient and its slope mu_1 = d mu / d lambda.
struct Friction {
    double mu;
    double mu_1;
};

/// mu and mu_1 at slip lambda; odd in lambda, continuously differentiable at zero. Bit-identical on every machine, unlike libm's exp.
[[gnu::always_inline]] inline Friction friction(const FrictionLaw& law, double lambda) {
    const double e = wear::exp_not_positive(-law.c2 * std::abs(lambda));
    const double magnitude = law.c1 * (1.0 - e) - law.c3 * std::abs(lambda);
    return {std::copysign(magnitude, lambda), law.c1 * law.c2 * e - law.c3};
}
/// Of the curve itself, on a wet surface too.
inline Friction friction(const Surface& surface, double lambda) {
    return friction(surface.law(), lambda);
}

/// The slip in (0, 1] with the largest friction, and that friction. With c3 = 0 the curve has no interior
/// peak: slip 1.
struct Peak {
    double slip;
    double mu;
};
Peak peak(const FrictionLaw& law);
/// Of the curve itself, on a wet surface too.
inline Peak peak(const Surface& surface) {
    return peak(surface.law());
}
/// The friction available to a wheel rolling at this speed.
Peak peak(const Surface& surface, double v_mps);

}  // namespace rig
