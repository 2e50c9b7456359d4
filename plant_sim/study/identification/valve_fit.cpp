#include "plant_sim/study/identification/valve_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant_sim/study/identification/valve_model.hpp"

namespace identification {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// dP/dI of the map where half the full pressure is.
double middle_slope(const rig::PressureMap& map) {
    const auto& points = map.points();
    const double half_Pa = 0.5 * points.back().pressure_Pa;
    std::size_t i = 1;
    while (i + 1 < points.size() && points[i].pressure_Pa < half_Pa) ++i;
    return (points[i].pressure_Pa - points[i - 1].pressure_Pa) / (points[i].current_mA - points[i - 1].current_mA);
}

void check_known(const Estimate& e, const char* name, const char* unit) {
    constexpr double kWorst = 0.25;
    if (e.high - e.value <= kWorst * e.value) return;
    throw NotIdentifiable(
        fmt::format("too little excitation: {} is {:.3g} {} to {:.3g} {}, which says nothing; expected more "
                    "or larger steps, "
                    "or a sweep beyond the valve's frequency (config/scenarios/step.toml, sweep.toml)",
                    name, e.low, unit, e.high, unit));
}

}  // namespace

rig::PressureMap ValveFit::map() const {
    std::vector<rig::PressureMap::Point> points;
    points.reserve(current_mA.size() + 1);
    points.push_back({dead_zone_mA.value, 0.0});
    for (std::size_t i = 0; i < current_mA.size(); ++i) points.push_back({current_mA[i], pressure_Pa[i].value});
    return rig::PressureMap(std::move(points));
}

ValveFit fit_valve(std::span<const Recording> recordings, const KnownRig& rig) {
    std::vector<ValveExperiment> experiments;
    for (const Recording& recording : recordings) {
        check(recording);
        if (shows_valve(recording)) experiments.push_back(valve_experiment(recording));
    }
    if (experiments.empty()) {
        throw NotIdentifiable(
            "no recording has the valve at work while the flywheel stands: the valve needs the experiments "
            "ramp, step and sweep "
            "(config/scenarios)");
    }
    for (const ValveExperiment& e : experiments) check_range(e, rig);
    const std::vector<double> start_Pa = ramp_pressures_Pa(experiments, rig);
    check_dynamics(experiments, rig.map_currents.front());

    const ValveShape shape{{rig.map_currents.begin() + 1, rig.map_currents.end()}};
    const std::vector<std::string> names = shape.names();
    LeastSquares min = shape.problem(rig.map_currents.front(), start_Pa);
    constexpr double kBatch_s = 0.01;
    min.batch = std::max(1, static_cast<int>(std::lround(kBatch_s / experiments.front().period_s)));
    ValveModel model(shape, experiments, rig.gauge_range_Pa);
    const auto evaluate = [&model](const VectorXd& theta, VectorXd& residuals) {
        model.run(theta);
        model.residuals(residuals);
    };
    Fit found;
    // Which samples count follows from the model, so it settles with it.
    for (int round = 0; round < 2; ++round) {
        model.run(min.start);
        model.choose();
        found = fit(min, names, evaluate);
        min.start = found.theta;
    }
    model.run(found.theta);

    ValveFit out;
    out.current_mA = shape.current_mA;
    const int band = static_cast<int>(shape.current_mA.size()) + 1;
    out.dead_zone_mA = found.estimate(0, band);
    for (Index i = 0; i < shape.pressures(); ++i) out.pressure_Pa.push_back(scaled(found.estimate(1 + i, band), 1e6));
    out.hysteresis_mA = found.estimate(shape.hysteresis());
    out.natural_frequency_Hz = scaled(found.estimate(shape.natural_frequency()), 0.5 / std::numbers::pi);
    out.damping = found.estimate(shape.damping());
    out.delay_s = scaled(found.estimate(shape.delay()), 1e-3);
    check_known(out.natural_frequency_Hz, "the natural frequency", "Hz");
    check_known(out.damping, "the damping", "");
    out.rms_Pa = found.rms * 1e6;
    out.residual_correlation = found.first_correlation;
    out.lags_s = found.lags * min.batch * experiments.front().period_s;
    out.residuals = model.report();
    out.hysteresis_Pa = scaled(out.hysteresis_mA, middle_slope(out.map()));
    return out;
}

}  // namespace identification
