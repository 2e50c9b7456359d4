/// The valve as the fit sees it: parameters in one vector, and the pressure that they give in every experiment.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "plant_sim/model/valve.hpp"
#include "plant_sim/study/identification/estimate.hpp"
#include "plant_sim/study/identification/valve_experiment.hpp"
#include "plant_sim/study/identification/valve_fit.hpp"

namespace identification {

/// theta: dead zone (mA), pressures (MPa), hysteresis (mA), natural frequency (rad/s), damping, delay (ms).
struct ValveShape {
    std::vector<double> current_mA;  ///< of the pressures: rising

    [[nodiscard]] Eigen::Index pressures() const { return static_cast<Eigen::Index>(current_mA.size()); }
    [[nodiscard]] Eigen::Index hysteresis() const { return 1 + pressures(); }
    [[nodiscard]] Eigen::Index natural_frequency() const { return hysteresis() + 1; }
    [[nodiscard]] Eigen::Index damping() const { return hysteresis() + 2; }
    [[nodiscard]] Eigen::Index delay() const { return hysteresis() + 3; }
    [[nodiscard]] Eigen::Index size() const { return hysteresis() + 4; }

    [[nodiscard]] rig::PressureMap map(const Eigen::VectorXd& theta) const;
    [[nodiscard]] rig::ValveParameters valve(const Eigen::VectorXd& theta) const;
    [[nodiscard]] std::vector<std::string> names() const;
    /// With bounds and scales, started at this map.
    [[nodiscard]] LeastSquares problem(double dead_zone_mA, const std::vector<double>& pressures_Pa) const;
};

/// The modelled pressure of every experiment, and which samples count. Shape and experiments must outlive it.
class ValveModel {
  public:
    /// `range_Pa`: of the gauge.
    ValveModel(const ValveShape& shape, std::span<const ValveExperiment> experiments, double range_Pa);

    void run(const Eigen::VectorXd& theta);
    /// By what the model says, not by the reading: a choice by the reading would be a choice by its noise.
    void choose();
    /// MPa, of the samples that were chosen.
    void residuals(Eigen::VectorXd& out) const;
    [[nodiscard]] std::vector<ValveResiduals> report() const;

  private:
    const ValveShape& shape_;
    std::span<const ValveExperiment> experiments_;
    double range_Pa_;
    std::vector<std::vector<double>> modelled_;
    std::vector<std::vector<std::uint8_t>> used_;
    std::size_t count_ = 0;
};

}  // namespace identification
