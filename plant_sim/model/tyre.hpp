/// Tyre-runway friction after Burckhardt, eq. (4), continued as an odd function to negative slip (overspeed).
#pragma once

#include <cmath>
#include <string>

namespace plant {

/// One runway surface: mu(lambda) = c1 (1 - exp(-c2 lambda)) - c3 lambda for lambda >= 0, eq. (4).
/// c1, c2 > 0, c3 >= 0, all dimensionless.
struct Surface {
    std::string name;
    double c1 = 0.0;
    double c2 = 0.0;
    double c3 = 0.0;
};

/// Friction coefficient and its slope mu_1 = d mu / d lambda.
struct Friction {
    double mu;
    double mu_1;
};

/// mu and mu_1 at slip lambda; odd in lambda: C1 at zero, the second derivative jumps there.
inline Friction friction(const Surface& s, double lambda) {
    const double e = std::exp(-s.c2 * std::abs(lambda));
    const double magnitude = s.c1 * (1.0 - e) - s.c3 * std::abs(lambda);
    return {std::copysign(magnitude, lambda), s.c1 * s.c2 * e - s.c3};
}

/// The slip in (0, 1] with the largest friction, and that friction. With c3 = 0 the curve has no interior
/// peak: slip 1.
struct Peak {
    double slip;
    double mu;
};
Peak peak(const Surface& surface);

}  // namespace plant
