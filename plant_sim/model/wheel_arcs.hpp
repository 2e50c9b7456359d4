/// Inputs of the wheel over one step, as functions of x = t/h in [0, 1]: brake pressure and vertical load.
#pragma once

namespace plant {

/// Brake pressure over one step of length h: a cubic in x, cut off at 0. Exact for a linear profile. For the valve of eq. (6) with steps of 1 ms, the
/// cubic through value and rate at both ends has an error within 1e-6.
struct PressureArc {
    double c0 = 0.0, c1 = 0.0, c2 = 0.0, c3 = 0.0;

    [[nodiscard]] static PressureArc linear(double p0, double p1) { return {p0, p1 - p0, 0.0, 0.0}; }
    /// Rates are per second, `h` in seconds.
    [[nodiscard]] static PressureArc hermite(double p0, double rate0, double p1, double rate1, double h) {
        const double m0 = rate0 * h;
        const double m1 = rate1 * h;
        return {p0, m0, 3.0 * (p1 - p0) - 2.0 * m0 - m1, 2.0 * (p0 - p1) + m0 + m1};
    }
    [[nodiscard]] double at(double x) const {
        const double p = c0 + x * (c1 + x * (c2 + x * c3));
        return p > 0.0 ? p : 0.0;
    }
    /// dp/dx; 0 where the pressure is cut off.
    [[nodiscard]] double slope(double x) const { return c0 + x * (c1 + x * (c2 + x * c3)) < 0.0 ? 0.0 : c1 + x * (2.0 * c2 + x * 3.0 * c3); }
    /// The part of the arc between x0 and x1, scaled to [0, 1].
    [[nodiscard]] PressureArc part(double x0, double x1) const;
};

/// Vertical load over one step: F_z = base + x * change - lift * v^2, x = t/h in [0, 1].
struct LoadArc {
    double base_N = 0.0;       ///< m g in a landing, the loading device's force on a rig, 0 in the air
    double change_N = 0.0;     ///< of the base over the whole step
    double lift_Ns2pm2 = 0.0;  ///< rho S C_l / 2 of eq. (2); 0 where the load does not depend on speed

    [[nodiscard]] double base_at(double x) const { return base_N + x * change_N; }
    [[nodiscard]] double force_N(double x, double v_mps) const { return base_at(x) - lift_Ns2pm2 * v_mps * v_mps; }
    [[nodiscard]] LoadArc part(double x0, double x1) const { return {base_at(x0), (x1 - x0) * change_N, lift_Ns2pm2}; }
};

}  // namespace plant
