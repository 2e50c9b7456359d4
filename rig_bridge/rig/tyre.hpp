/// Tyre-runway friction after Burckhardt, eq. (4), or after Pacejka, continued as an odd function to negative slip (overspeed).
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <variant>

#include "rig_bridge/rig/wet_grip.hpp"
#include "rig_bridge/wear/fast_exp.hpp"

namespace rig {

/// mu(lambda) = c1 (1 - exp(-c2 lambda)) - c3 lambda for lambda >= 0, eq. (4). c1, c2 > 0, c3 >= 0, all dimensionless.
struct FrictionLaw {
    double c1 = 0.0;
    double c2 = 0.0;
    double c3 = 0.0;
};

/// The magic formula without shifts: mu(lambda) = D sin(C atan(B lambda - E (B lambda - atan(B lambda)))) for lambda >= 0 (H. B. Pacejka, Tire and
/// Vehicle Dynamics, section 4.3). B > 0; C in [1, 2), so that friction stays positive; D > 0; E <= 1; all dimensionless.
struct MagicFormula {
    double B = 0.0;
    double C = 0.0;
    double D = 0.0;
    double E = 0.0;
};

/// The one with its peak `mu` at `slip`; C in (1, 2), E < 1.
MagicFormula magic_formula_with_peak(double slip, double mu, double C, double E);

using TyreCurve = std::variant<FrictionLaw, MagicFormula>;

/// One runway surface. On a wet one the curve over slip is scaled at every speed, so that its peak is that of `wet`.
struct Surface {
    std::string name;
    double c1 = 0.0;
    double c2 = 0.0;
    double c3 = 0.0;
    std::optional<MagicFormula> magic{};  ///< instead of eq. (4); c1 to c3 then mean nothing
    std::optional<WetGrip> wet{};

    /// Whether friction is eq. (4), the same at every speed.
    [[nodiscard]] bool plain() const { return !magic && !wet; }
    [[nodiscard]] FrictionLaw law() const { return {c1, c2, c3}; }
    [[nodiscard]] TyreCurve curve() const { return magic ? TyreCurve(*magic) : TyreCurve(law()); }
};

/// Friction coefficient with its derivatives mu_1 = d mu / d lambda and mu_2 = d mu_1 / d lambda.
struct Friction {
    double mu;
    double mu_1;
    double mu_2;
};

/// At slip lambda; mu is odd in lambda, continuously differentiable at zero. Bit-identical on every machine, unlike libm's exp.
[[gnu::always_inline]] inline Friction friction(const FrictionLaw& law, double lambda) {
    const double e = wear::exp_not_positive(-law.c2 * std::abs(lambda));
    const double magnitude = law.c1 * (1.0 - e) - law.c3 * std::abs(lambda);
    const double mu_1 = law.c1 * law.c2 * e - law.c3;
    return {std::copysign(magnitude, lambda), mu_1, std::copysign(law.c2 * (mu_1 + law.c3), -lambda)};
}
/// Its last bits depend on libm's atan, sin and cos.
Friction friction(const MagicFormula& law, double lambda);
inline Friction friction(const TyreCurve& curve, double lambda) {
    return std::visit([lambda](const auto& law) { return friction(law, lambda); }, curve);
}
/// Of the curve itself, on a wet surface too.
inline Friction friction(const Surface& surface, double lambda) {
    return surface.magic ? friction(*surface.magic, lambda) : friction(surface.law(), lambda);
}

/// The slip in (0, 1] with the largest friction, and that friction. With c3 = 0, or C = 1, the curve has no interior peak: slip 1.
struct Peak {
    double slip;
    double mu;
};
Peak peak(const FrictionLaw& law);
Peak peak(const MagicFormula& law);
/// Of the curve itself, on a wet surface too.
inline Peak peak(const Surface& surface) {
    return surface.magic ? peak(*surface.magic) : peak(surface.law());
}
/// The friction available to a wheel rolling at this speed.
Peak peak(const Surface& surface, double v_mps);

}  // namespace rig
