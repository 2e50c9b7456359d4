#include "plant_sim/study/margins/sampled_plant.hpp"

#include <vector>

#include "plant_sim/study/margins/dense.hpp"

namespace study::margins {

namespace {

/// dP/di of a polyline at pressure `p`.
double slope(const std::vector<rig::PressureMap::Point>& points, double p) {
    std::size_t i = 1;
    while (i + 1 < points.size() && points[i].pressure_Pa < p) ++i;
    return (points[i].pressure_Pa - points[i - 1].pressure_Pa) / (points[i].current_mA - points[i - 1].current_mA);
}

}  // namespace

SampledPlant sampled_plant(const rig::ValveParameters& valve, const LinearWheel& wheel, double per_pressure, double per_command, double period_s,
                           double broken_s) {
    const Eigen::Index rim = 2, n = wheel.a.rows(), integral = rim + n, input = integral + 1;
    const double w = valve.natural_frequency_radps;
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(input + 1, input + 1);
    a(0, 1) = 1.0;
    a(1, 0) = -w * w;
    a(1, 1) = -2.0 * valve.damping * w;
    a(1, input) = w * w * per_command;
    a(rim, 0) = per_pressure * wheel.gain;
    a.block(rim, rim, n, n) = wheel.a;
    a(integral, rim) = 1.0;
    const Eigen::MatrixXd first = exponential(a * broken_s);
    const Eigen::MatrixXd second = exponential(a * (period_s - broken_s));
    return {second.topLeftCorner(input, input) * first.topLeftCorner(input, input),
            second.topLeftCorner(input, input) * first.topRightCorner(input, 1), second.topRightCorner(input, 1)};
}

double valve_gain(const antiskid::control::ValveConfig& believed, const rig::PressureMap& map, double pressure_Pa) {
    std::vector<rig::PressureMap::Point> points;
    points.reserve(believed.points);
    for (std::size_t i = 0; i < believed.points; ++i)
        points.push_back({static_cast<double>(believed.current_mA[i]), static_cast<double>(believed.pressure_Pa[i])});
    return slope(map.points(), pressure_Pa) / slope(points, pressure_Pa);
}

}  // namespace study::margins
