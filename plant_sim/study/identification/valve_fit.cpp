#include "plant_sim/study/identification/valve_fit.hpp"

#include <fmt/format.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "plant_sim/model/valve.hpp"
#include "plant_sim/study/identification/estimate.hpp"
#include "plant_sim/study/identification/valve_experiment.hpp"
#include "plant_sim/study/identification/valve_response.hpp"

namespace identification {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// theta: dead zone (mA), pressures (MPa), hysteresis (mA), natural frequency (rad/s), damping, delay (ms).
struct ValveShape {
    std::vector<double> current_mA;  ///< of the pressures: rising

    [[nodiscard]] Eigen::Index pressures() const { return static_cast<Eigen::Index>(current_mA.size()); }
    [[nodiscard]] Eigen::Index hysteresis() const { return 1 + pressures(); }
    [[nodiscard]] Eigen::Index natural_frequency() const { return hysteresis() + 1; }
    [[nodiscard]] Eigen::Index damping() const { return hysteresis() + 2; }
    [[nodiscard]] Eigen::Index delay() const { return hysteresis() + 3; }
    [[nodiscard]] Eigen::Index size() const { return hysteresis() + 4; }

    [[nodiscard]] rig::PressureMap map(const VectorXd& theta) const {
        std::vector<rig::PressureMap::Point> points;
        points.reserve(current_mA.size() + 1);
        points.push_back({theta[0], 0.0});
        // A trial point of the fit may decrease along the map; a valve's map does not.
        for (Index i = 0; i < pressures(); ++i) {
            points.push_back({current_mA[static_cast<std::size_t>(i)], std::max(theta[1 + i] * 1e6, points.back().pressure_Pa)});
        }
        return rig::PressureMap(std::move(points));
    }
    [[nodiscard]] rig::ValveParameters valve(const VectorXd& theta) const {
        return {.natural_frequency_radps = theta[natural_frequency()],
                .damping = theta[damping()],
                .delay_s = theta[delay()] * 1e-3,
                .hysteresis_mA = theta[hysteresis()]};
    }
    [[nodiscard]] std::vector<std::string> names() const {
        std::vector<std::string> all{"the dead zone"};
        all.reserve(static_cast<std::size_t>(size()));
        for (const double current : current_mA) all.push_back(fmt::format("the pressure at {:g} mA", current));
        for (const char* name : {"hysteresis", "natural frequency", "damping", "delay"}) all.emplace_back(name);
        return all;
    }
    /// Least-squares problem with bounds and scales, started at this map.
    [[nodiscard]] LeastSquares problem(double dead_zone_mA, const std::vector<double>& pressures_Pa) const {
        // The start of the dynamics is uncritical: every valve that can hold a wheel is within a factor of three.
        constexpr double kStart_radps = 2.0 * std::numbers::pi * 12.0;
        LeastSquares p;
        const Index n = size();
        p.start.resize(n);
        p.scale.resize(n);
        p.min.resize(n);
        p.max.resize(n);
        const auto set = [&p](Index i, double start, double scale, double min, double max) {
            p.start[i] = start;
            p.scale[i] = scale;
            p.min[i] = min;
            p.max[i] = max;
        };
        constexpr double kApart_mA = 0.05;
        set(0, dead_zone_mA, 0.1, 0.0, current_mA.front() - kApart_mA);
        for (Index i = 0; i < pressures(); ++i) set(1 + i, pressures_Pa[static_cast<std::size_t>(i) + 1] * 1e-6, 0.1, 0.0, 1e3);
        set(hysteresis(), 0.0, 0.1, -10.0, 10.0);
        set(natural_frequency(), kStart_radps, 10.0, 3.0, 1000.0);
        set(damping(), 0.7, 0.1, 0.06, 0.985);
        set(delay(), 4.0, 1.0, 0.0, 60.0);
        return p;
    }
};

/// Modelled pressure of each experiment, and the choice of samples. Shape and experiments must outlive it.
class ValveModel {
  public:
    /// `range_Pa`: of the gauge.
    ValveModel(const ValveShape& shape, std::span<const ValveExperiment> experiments, double range_Pa)
        : shape_(shape), experiments_(experiments), range_Pa_(range_Pa) {
        modelled_.reserve(experiments.size());
        used_.reserve(experiments.size());
        for (const ValveExperiment& e : experiments) {
            modelled_.emplace_back(e.current_mA.size());
            used_.emplace_back(e.current_mA.size());
        }
    }

    void run(const VectorXd& theta) {
        const rig::PressureMap map = shape_.map(theta);
        const rig::ValveParameters valve = shape_.valve(theta);
        for (std::size_t i = 0; i < experiments_.size(); ++i)
            valve_response(experiments_[i].current_mA, experiments_[i].period_s, map, valve, modelled_[i]);
    }
    /// Chooses samples by the model, not by the reading, since a choice by the reading would be biased by its noise.
    void choose() {
        constexpr double kNearZero_Pa = 0.15e6;  // below, a gauge's noise is cut off at zero
        count_ = 0;
        for (std::size_t i = 0; i < experiments_.size(); ++i) {
            for (std::size_t k = 0; k < used_[i].size(); ++k) {
                const double p = modelled_[i][k];
                used_[i][k] = experiments_[i].measured[k] != 0 && p > kNearZero_Pa && p < range_Pa_ - kNearZero_Pa ? 1 : 0;
                count_ += used_[i][k];
            }
        }
    }
    /// MPa, of the samples that were chosen.
    void residuals(VectorXd& out) const {
        out.resize(static_cast<Index>(count_));
        Index row = 0;
        for (std::size_t i = 0; i < experiments_.size(); ++i) {
            for (std::size_t k = 0; k < used_[i].size(); ++k) {
                if (used_[i][k] != 0) out[row++] = (experiments_[i].pressure_Pa[k] - modelled_[i][k]) * 1e-6;
            }
        }
    }
    [[nodiscard]] std::vector<ValveResiduals> report() const {
        std::vector<ValveResiduals> all;
        all.reserve(experiments_.size());
        for (std::size_t i = 0; i < experiments_.size(); ++i) {
            const ValveExperiment& e = experiments_[i];
            ValveResiduals r{.recording = e.name,
                             .rms_Pa = 0.0,
                             .time_s = {},
                             .current_mA = e.current_mA,
                             .measured_Pa = e.pressure_Pa,
                             .modelled_Pa = modelled_[i],
                             .used = used_[i]};
            r.time_s.reserve(e.current_mA.size());
            double sum = 0.0;
            double n = 0.0;
            for (std::size_t k = 0; k < e.current_mA.size(); ++k) {
                r.time_s.push_back(static_cast<double>(k) * e.period_s);
                if (used_[i][k] == 0) continue;
                const double error = e.pressure_Pa[k] - modelled_[i][k];
                sum += error * error;
                n += 1.0;
            }
            r.rms_Pa = n > 0.0 ? std::sqrt(sum / n) : 0.0;
            all.push_back(std::move(r));
        }
        return all;
    }

  private:
    const ValveShape& shape_;
    std::span<const ValveExperiment> experiments_;
    double range_Pa_;
    std::vector<std::vector<double>> modelled_;
    std::vector<std::vector<std::uint8_t>> used_;
    std::size_t count_ = 0;
};

using Eigen::Index;
using Eigen::VectorXd;

/// dP/dI of the map at half of the full pressure.
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
        fmt::format("too little excitation: {} is {:.3g} {} to {:.3g} {}, which says nothing; expected more or larger steps, or a sweep beyond the "
                    "valve's frequency (config/scenarios/step.toml, sweep.toml)",
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
            "no recording has the valve at work while the flywheel stands: the valve needs the experiments ramp, step and sweep (config/scenarios)");
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
    // The choice of samples depends on the model, so both are iterated.
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
