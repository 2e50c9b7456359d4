/// The greatest friction of a wet runway, which falls with ground speed and, on a flooded one, is gone above the hydroplaning speed.
///
/// Wet: 14 CFR 25.109(c)(1) for smooth runways and (d)(2) for grooved ones or porous friction courses (Amdt. 25-92), polynomials in true
/// ground speed at tyre pressures of 50, 100, 200 and 300 psi; between them linear, as the regulation allows. The
/// coefficients were not compared with a printed copy (docs/user/scenarios.md). Each curve falls over all speeds of a landing, but for the
/// grooved ones' first knots.
///
/// Flooded: a rolling tyre floats from 9 sqrt(p) knots on, p in psi (W. B. Horne, R. C. Dreher, Phenomena of pneumatic tire hydroplaning,
/// NASA TN D-2056, 1963), one that does not turn from 7.7 sqrt(p) on (Horne's for touchdown). From 0.85 of that speed on friction leaves
/// the wet curve and goes smoothly to what is left; where it leaves is an assumption.
#pragma once

#include <array>
#include <optional>

namespace plant {

enum class Texture { smooth, grooved };

class WetGrip {
  public:
    static constexpr double kLeastPressure_psi = 50.0, kMostPressure_psi = 300.0;

    /// `flooded_mu`: friction left above the hydroplaning speed, 0 to 0.1; none: the runway is wet, not flooded. Throws
    /// std::invalid_argument beyond these ranges.
    WetGrip(double tyre_pressure_psi, Texture texture, std::optional<double> flooded_mu = std::nullopt);

    struct Most {
        double mu;
        double mu_v;  ///< d mu / d v, s/m
    };
    /// At a ground speed, 0 to 120 m/s; `spun_up`: the wheel rolls.
    [[nodiscard]] Most at(double v_mps, bool spun_up = true) const;

    /// Whatever the water: only on a flooded runway friction depends on it.
    [[nodiscard]] double hydroplaning_mps(bool spun_up = true) const;

  private:
    double tyre_pressure_psi_;
    std::array<double, 6> powers_{};  // of V / 100 knots
    std::optional<double> flooded_mu_;
};

}  // namespace plant
