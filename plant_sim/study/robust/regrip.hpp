/// How soon a wheel has the friction of another surface, and keeps it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/rig/tyre.hpp"

namespace robust {

/// What came of a change of surface.
struct Regrip {
    double speed_mps = 0.0;  ///< at the change
    double judged_s = 0.0;   ///< looked at for so long
    /// From the change to the first period with 95 % of the friction that is available, from which on every 0.1 s have that in the mean
    /// as far as it is looked at; none: there was no such period.
    std::optional<double> regained_s;

    /// Shorter than the 0.4 s that are asked for and 0.1 s of keeping cannot be judged.
    static constexpr double kRequired_s = 0.4;
    static constexpr double kMin_s = 0.5;
    [[nodiscard]] bool measured() const { return judged_s >= kMin_s; }
};

/// Looks at the first change of surface: for 2 s, so that slippery surfaces, with their long stops, are judged as others are; not beyond the
/// next change, nor below 18 m/s, where the fall of the reference at low speed takes friction on purpose. The mean over 0.1 s is what counts
/// because a law may swing its reference to find the peak; a wheel that passes the peak on its way to a lock has friction for a moment only.
class RegripMeter {
  public:
    static constexpr double kShare = 0.95;
    static constexpr double kWindow_s = 0.1;
    static constexpr double kLongest_s = 2.0;
    static constexpr double kEnds_mps = 18.0;

    explicit RegripMeter(double period_s) : period_s_(period_s) {}

    /// After every period of braking: the surface that was under the wheel in it, speed and friction at its end.
    void update(const rig::Surface& under, double v_mps, double mu);

    /// None: the surface did not change, or too late.
    [[nodiscard]] std::optional<Regrip> regrip() const;

  private:
    double period_s_;
    std::string surface_;  // by name; empty: before the first period
    bool changed_ = false;
    bool over_ = false;
    double speed_mps_ = 0.0;
    std::vector<double> shares_;  // of the available friction, since the change
};

}  // namespace robust
