/// Time until a wheel has, and keeps, the friction of another surface.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/rig/tyre.hpp"

namespace robust {

/// Result of one change of surface.
struct Regrip {
    double speed_mps = 0.0;  ///< at the change
    double judged_s = 0.0;   ///< length of the judged time
    /// Time from the change to the first period with 95 % of the available friction after which every 0.1 s of the judged time has that in the mean;
    /// none: there was no such period.
    std::optional<double> regained_s;

    /// A judged time shorter than kMin_s, the required 0.4 s and 0.1 s of keeping, gives no result.
    static constexpr double kRequired_s = 0.4;
    static constexpr double kMin_s = 0.5;
    [[nodiscard]] bool measured() const { return judged_s >= kMin_s; }
};

/// Judges the first change of surface for 2 s, so that slippery surfaces, with their long stops, are judged like the others; at most to the next
/// change, or down to 18 m/s, where the reference falls on purpose. The mean over 0.1 s counts, because a law may vary its reference to find the
/// peak, while a wheel that passes the peak on its way to a lock has friction for a moment only.
class RegripMeter {
  public:
    static constexpr double kShare = 0.95;
    static constexpr double kWindow_s = 0.1;
    static constexpr double kLongest_s = 2.0;
    static constexpr double kEnds_mps = 18.0;

    explicit RegripMeter(double period_s) : period_s_(period_s) {}

    /// Call after every period of braking. `under`: the surface in that period; speed and friction at its end.
    void update(const rig::Surface& under, double v_mps, double mu);

    /// None: the surface did not change, or changed too late.
    [[nodiscard]] std::optional<Regrip> regrip() const;

  private:
    double period_s_;
    std::string surface_;  // its name; empty: before the first period
    bool changed_ = false;
    bool over_ = false;
    double speed_mps_ = 0.0;
    std::vector<double> shares_;  // of the available friction, since the change
};

}  // namespace robust
