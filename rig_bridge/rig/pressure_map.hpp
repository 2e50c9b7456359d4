/// Static map from valve current to brake pressure.
#pragma once

#include <vector>

namespace rig {

/// Monotone, linear between its points, constant beyond them.
class PressureMap {
  public:
    struct Point {
        double current_mA;
        double pressure_Pa;
    };
    /// At least two points, currents strictly increasing, pressures not falling; throws std::invalid_argument.
    explicit PressureMap(std::vector<Point> points);

    [[nodiscard]] double pressure_Pa(double current_mA) const;
    [[nodiscard]] const std::vector<Point>& points() const { return points_; }

  private:
    std::vector<Point> points_;
};

}  // namespace rig
