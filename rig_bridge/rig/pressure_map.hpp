/// From valve current to brake pressure at rest.
#pragma once

#include <vector>

namespace rig {

/// The static map: monotone, linear between its points, held beyond them.
class PressureMap {
  public:
    struct Point {
        double current_mA;
        double pressure_Pa;
    };
    /// Needs two points at least, currents strictly increasing, pressures not falling; throws
    /// std::invalid_argument.
    explicit PressureMap(std::vector<Point> points);

    [[nodiscard]] double pressure_Pa(double current_mA) const;
    [[nodiscard]] const std::vector<Point>& points() const { return points_; }

  private:
    std::vector<Point> points_;
};

}  // namespace rig
