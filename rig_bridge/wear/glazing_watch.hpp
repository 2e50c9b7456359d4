/// Searches for a glaze that has begun: log of the likelihood of a brake with the fault over that of the healthy one.
///
/// A supposed glaze has taken a share of friction that grows evenly over kGrowth maneuvers. Each is a LifeFilter that goes on from the healthy one at
/// the maneuver where the glaze is supposed to have begun, from readings divided by the share that it has left. A brake that wears out early, or
/// whose level is not known yet, explains falling friction in both, and is evidence for neither.
#pragma once

#include <deque>

#include "rig_bridge/wear/life_filter.hpp"

namespace wear {

class GlazingWatch {
  public:
    static constexpr std::array kSizes{0.05, 0.10};  ///< shares of friction that a full-grown glaze takes
    static constexpr int kGrowth = 40;               ///< maneuvers [A]
    static constexpr int kEvery = 8;                 ///< maneuvers between supposed begins

    /// `curves` must outlive this.
    explicit GlazingWatch(const LifeCurves& curves);
    explicit GlazingWatch(LifeCurves&&) = delete;

    /// Call after each maneuver, in order: the greatest log likelihood ratio of a glaze that began within the newest kGrowth maneuvers, at least 0.
    [[nodiscard]] double after(const Point& maneuver);

  private:
    struct Supposed {
        LifeFilter brake;
        double size = 0.0;
        int age = 0;
        double log_ratio = 0.0;
    };
    LifeFilter healthy_;
    std::deque<Supposed> supposed_;
    int maneuvers_ = 0;
};

}  // namespace wear
