/// Peak friction of a wet runway, which decreases with ground speed and, on a flooded runway, vanishes above the hydroplaning speed.
///
/// Wet: 14 CFR 25.109(c)(1) for smooth runways and (d)(2) for grooved ones or porous friction courses (Amdt. 25-92), polynomials in true
/// ground speed at tyre pressures of 50, 100, 200 and 300 psi; between them linear, as the regulation allows. The
/// coefficients were not compared with a printed copy (docs/user/scenarios.md). Each curve decreases over all speeds of a landing, except the grooved
/// ones over the first knots.
///
/// Flooded: a rolling tyre floats from 9 sqrt(p) knots on, p in psi (W. B. Horne, R. C. Dreher, Phenomena of pneumatic tire hydroplaning,
/// NASA TN D-2056, 1963), one that does not turn from 7.7 sqrt(p) on (Horne's for touchdown). From 0.85 of that speed on, friction decreases smoothly
/// from the wet curve to the remaining value; the factor 0.85 is an assumption.
#pragma once

#include <array>
#include <optional>

namespace rig {

enum class Texture { smooth, grooved };

class WetGrip {
  public:
    static constexpr double kMinPressure_psi = 50.0, kMaxPressure_psi = 300.0;

    /// `flooded_mu`: friction left above the hydroplaning speed, 0 to 0.1; none: the runway is wet, not flooded. Throws
    /// std::invalid_argument beyond these ranges.
    WetGrip(double tyre_pressure_psi, Texture texture, std::optional<double> flooded_mu = std::nullopt);

    struct Peak {
        double mu;
        double mu_v;  ///< d mu / d v, s/m
    };
    /// At a ground speed, 0 to 120 m/s; `spun_up`: the wheel rolls.
    [[nodiscard]] Peak at(double v_mps, bool spun_up = true) const;

    /// Independent of the water; friction depends on it only on a flooded runway.
    [[nodiscard]] double hydroplaning_mps(bool spun_up = true) const;

  private:
    double tyre_pressure_psi_;
    std::array<double, 6> powers_{};  // of V / 100 knots
    std::optional<double> flooded_mu_;
};

}  // namespace rig
