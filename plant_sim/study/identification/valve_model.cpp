#include "plant_sim/study/identification/valve_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant_sim/study/identification/valve_response.hpp"

namespace identification {

using Eigen::Index;
using Eigen::VectorXd;

rig::PressureMap ValveShape::map(const VectorXd& theta) const {
    std::vector<rig::PressureMap::Point> points;
    points.reserve(current_mA.size() + 1);
    points.push_back({theta[0], 0.0});
    // A trial of the fit may fall from point to point; the map of a valve does not.
    for (Index i = 0; i < pressures(); ++i) {
        points.push_back({current_mA[static_cast<std::size_t>(i)], std::max(theta[1 + i] * 1e6, points.back().pressure_Pa)});
    }
    return rig::PressureMap(std::move(points));
}

rig::ValveParameters ValveShape::valve(const VectorXd& theta) const {
    return {.natural_frequency_radps = theta[natural_frequency()],
            .damping = theta[damping()],
            .delay_s = theta[delay()] * 1e-3,
            .hysteresis_mA = theta[hysteresis()]};
}

std::vector<std::string> ValveShape::names() const {
    std::vector<std::string> all{"the dead zone"};
    all.reserve(static_cast<std::size_t>(size()));
    for (const double current : current_mA) all.push_back(fmt::format("the pressure at {:g} mA", current));
    for (const char* name : {"hysteresis", "natural frequency", "damping", "delay"}) all.emplace_back(name);
    return all;
}

LeastSquares ValveShape::problem(double dead_zone_mA, const std::vector<double>& pressures_Pa) const {
    // Where dynamics start does not matter much: any valve that can hold a wheel lies within a factor of three of this.
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

ValveModel::ValveModel(const ValveShape& shape, std::span<const ValveExperiment> experiments, double range_Pa)
    : shape_(shape), experiments_(experiments), range_Pa_(range_Pa) {
    modelled_.reserve(experiments.size());
    used_.reserve(experiments.size());
    for (const ValveExperiment& e : experiments) {
        modelled_.emplace_back(e.current_mA.size());
        used_.emplace_back(e.current_mA.size());
    }
}

void ValveModel::run(const VectorXd& theta) {
    const rig::PressureMap map = shape_.map(theta);
    const rig::ValveParameters valve = shape_.valve(theta);
    for (std::size_t i = 0; i < experiments_.size(); ++i)
        valve_response(experiments_[i].current_mA, experiments_[i].period_s, map, valve, modelled_[i]);
}

void ValveModel::choose() {
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

void ValveModel::residuals(VectorXd& out) const {
    out.resize(static_cast<Index>(count_));
    Index row = 0;
    for (std::size_t i = 0; i < experiments_.size(); ++i) {
        for (std::size_t k = 0; k < used_[i].size(); ++k) {
            if (used_[i][k] != 0) out[row++] = (experiments_[i].pressure_Pa[k] - modelled_[i][k]) * 1e-6;
        }
    }
}

std::vector<ValveResiduals> ValveModel::report() const {
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

}  // namespace identification
