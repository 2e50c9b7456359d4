#include "rig_bridge/rig/pressure_map.hpp"

#include <cstddef>
#include <stdexcept>
#include <utility>

namespace rig {

PressureMap::PressureMap(std::vector<Point> points) : points_(std::move(points)) {
    if (points_.size() < 2) throw std::invalid_argument("a pressure map needs two points at least");
    for (std::size_t i = 1; i < points_.size(); ++i) {
        if (!(points_[i].current_mA > points_[i - 1].current_mA)) throw std::invalid_argument("currents of a pressure map must increase");
        if (!(points_[i].pressure_Pa >= points_[i - 1].pressure_Pa)) throw std::invalid_argument("pressures of a pressure map must not fall");
    }
}

double PressureMap::pressure_Pa(double current_mA) const {
    if (current_mA <= points_.front().current_mA) return points_.front().pressure_Pa;
    if (current_mA >= points_.back().current_mA) return points_.back().pressure_Pa;
    std::size_t i = 1;
    while (points_[i].current_mA < current_mA) ++i;
    const Point& a = points_[i - 1];
    const Point& b = points_[i];
    return a.pressure_Pa + (b.pressure_Pa - a.pressure_Pa) * (current_mA - a.current_mA) / (b.current_mA - a.current_mA);
}

}  // namespace rig
