#include "tests/model/reference/profiles.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace {

/// The same double as the end of that many steps of 1 ms.
double at_ms(int ms) {
    return static_cast<double>(ms) * 1e-3;
}

}  // namespace

double min_peak_pressure_Pa(const rig::RigParameters& rig) {
    const double lambda = std::log(rig.surface.c1 * rig.surface.c2 / rig.surface.c3) / rig.surface.c2;
    const double mu = rig.surface.c1 * (1.0 - std::exp(-rig.surface.c2 * lambda)) - rig.surface.c3 * lambda;
    const double mean = rig.friction_curve[0] + rig.friction_curve[1] / 2.0 + rig.friction_curve[2] / 3.0 + rig.friction_curve[3] / 4.0;
    double min = 1e30;
    for (double x = std::min(5.0 / rig.brake_on_mps, 0.5); x <= 1.0; x += 1e-3) {
        const double v = x * rig.brake_on_mps;
        const double F_z = rig.load.base_N - rig.load.lift_Ns2pm2 * v * v;
        const double r = rig.wheel.free_radius_m - F_z / rig.wheel.stiffness_Npm;
        const double mu_b =
            rig.mean_friction - mean + rig.friction_curve[0] + x * (rig.friction_curve[1] + x * (rig.friction_curve[2] + x * rig.friction_curve[3]));
        const double per_pascal = mu_b * rig.brake.piston_area_m2 * rig.brake.pistons * rig.brake.surfaces * rig.brake.effective_radius_m;
        min = std::min(min, r * F_z * mu / per_pascal);
    }
    return min;
}

std::vector<NamedProfile> profiles(const rig::RigParameters& rig) {
    const double peak = min_peak_pressure_Pa(rig);
    std::vector<NamedProfile> all;
    all.push_back({"ramp and hold", {{0.0, 0.0}, {1.0, 0.7 * peak}}, 200.0});

    reference::Profile triangles{{0.0, 0.0}};
    for (int i = 0; i < 15; ++i) {
        triangles.push_back({at_ms(4000 * i + 2000), 0.9 * peak});
        triangles.push_back({at_ms(4000 * i + 4000), 0.0});
    }
    all.push_back({"triangles", triangles, 60.0});

    reference::Profile steps;
    for (int i = 0; i < 20; ++i) {
        const double on = at_ms(500 + 2500 * i);
        const double off = at_ms(1200 + 2500 * i);
        steps.insert(steps.end(), {{on, 0.0}, {on, 1.6 * peak}, {off, 1.6 * peak}, {off, 0.0}});
    }
    all.push_back({"steps past the peak", steps, 50.0});

    // The standard says what this generator gives, but not what its distributions give.
    std::mt19937_64 generator(20260101);
    const auto share = [&] { return static_cast<double>(generator() >> 11U) * 0x1p-53; };
    reference::Profile random{{0.0, 0.0}};
    for (int ms = 0; ms < 40000;) {
        ms += 10 * (5 + static_cast<int>(45.0 * share()));
        random.push_back({at_ms(ms), 1.2 * peak * share()});
    }
    all.push_back({"random knots", random, 40.0});
    return all;
}
