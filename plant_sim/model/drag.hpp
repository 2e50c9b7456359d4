/// Drag of a flywheel that is not braked: bearings and windage.
#pragma once

namespace plant {

struct Drag {
    double bearing_N = 0.0;       ///< at the rim, > 0
    double windage_Ns2pm2 = 0.0;  ///< times v^2, > 0

    [[nodiscard]] double force_N(double v_mps) const { return bearing_N + windage_Ns2pm2 * v_mps * v_mps; }
};

struct CoastDown {
    double v_mps;
    double distance_m;
};

/// Closed-form solution of m dv/dt = -bearing - windage v^2 after `seconds`, starting with `v_mps`; ends at rest.
[[nodiscard]] CoastDown coast_down(const Drag& drag, double mass_kg, double v_mps, double seconds);

}  // namespace plant
