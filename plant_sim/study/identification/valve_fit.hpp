/// The valve from its own experiments, Section III.B: slow ramps, steps and sweeps of the current while the flywheel is at rest. All are fitted
/// together by their output error, so that the lag of eq. (6) is not mistaken for hysteresis on a ramp, nor the map's curvature for dynamics on a
/// step:
///
///     current -> play -> static map -> delay -> second order, eq. (6)
///
/// The map is linear between points. The first is at the estimated dead zone, where pressure begins; the pressures of the others are estimated at
/// given currents. Gauge readings near zero are not used: a gauge cannot read less, so that their noise is not symmetric.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "plant_sim/model/valve.hpp"
#include "plant_sim/study/identification/estimate.hpp"
#include "plant_sim/study/identification/recording.hpp"

namespace identification {

struct ValveResiduals {
    std::string recording;
    double rms_Pa = 0.0;
    std::vector<double> time_s;
    std::vector<double> current_mA;
    std::vector<double> measured_Pa;
    std::vector<double> modelled_Pa;
    std::vector<std::uint8_t> used;  ///< whether the sample was used
};

struct ValveFit {
    std::vector<double> current_mA;     ///< of the map's points except the first
    Estimate dead_zone_mA;              ///< the first point: no pressure up to here
    std::vector<Estimate> pressure_Pa;  ///< at current_mA; the intervals of these and of the dead zone hold jointly with 95 %: a band for the map
    Estimate hysteresis_mA;             ///< width between the branches; its interval contains zero if there is none
    Estimate hysteresis_Pa;             ///< the same as pressure, at the middle of the map
    Estimate natural_frequency_Hz, damping, delay_s;
    double rms_Pa = 0.0;
    double residual_correlation = 0.0;  ///< of neighbouring samples
    double lags_s = 0.0;                ///< range of the correlation in the covariance
    std::vector<ValveResiduals> residuals;

    [[nodiscard]] rig::PressureMap map() const;
};

/// Uses the samples of `recordings` with the flywheel at standstill. Throws NotIdentifiable.
[[nodiscard]] ValveFit fit_valve(std::span<const Recording> recordings, const KnownRig& rig);

}  // namespace identification
