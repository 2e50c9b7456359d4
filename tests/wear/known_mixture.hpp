/// A mixture like the paper's: four components along a falling trend, two of them close to each other.
#pragma once

#include <algorithm>
#include <cstddef>

#include "rig_bridge/wear/mixture.hpp"

namespace known {

inline wear::Component component(double weight, double c_MJ, double sigma_c_MJ, double mu, double sigma_mu, double rho) {
    const double sc = sigma_c_MJ * 1e6;
    return {weight, c_MJ * 1e6, mu, sc * sc, rho * sc * sigma_mu, sigma_mu * sigma_mu};
}

inline wear::Mixture four() {
    return wear::Mixture({component(0.10, 20.0, 11.0, 0.300, 0.012, -0.85), component(0.35, 130.0, 40.0, 0.262, 0.006, -0.70),
                          component(0.40, 320.0, 60.0, 0.240, 0.005, -0.60), component(0.15, 465.0, 14.0, 0.205, 0.010, -0.80)});
}

/// `count` draws as a campaign: sorted by energy; where energy would be negative it is drawn again.
inline wear::Campaign drawn(const wear::Mixture& mixture, std::size_t count, wear::Generator& generator) {
    wear::Campaign out;
    out.source = "known mixture";
    while (out.points.size() < count) {
        const wear::Point p = mixture.sample(generator);
        if (p.c_e_J > 0.0) out.points.push_back(p);
    }
    std::sort(out.points.begin(), out.points.end(), [](const wear::Point& a, const wear::Point& b) { return a.c_e_J < b.c_e_J; });
    return out;
}

}  // namespace known
