/// The valve from its own experiments, Section III.B: slow ramps, steps and sweeps of the current while the flywheel stands. One output-error
/// fit over all of them, so that the lag of eq. (6) is not taken for hysteresis on a ramp, nor the map's curvature for dynamics on a step:
///
///     current -> play -> static map -> delay -> second order, eq. (6)
///
/// The map is linear between points: the first where pressure begins (the dead zone, found), the rest at given currents (pressures found).
/// Gauge readings near zero are left out: a gauge cannot read less, so their noise is not about the pressure.
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
    std::vector<std::uint8_t> used;  ///< whether the sample counted
};

struct ValveFit {
    std::vector<double> current_mA;     ///< of the map's points but the first
    Estimate dead_zone_mA;              ///< the first point: no pressure up to here
    std::vector<Estimate> pressure_Pa;  ///< at current_mA. 95 % for the dead zone and all of these together: a band for the map
    Estimate hysteresis_mA;             ///< width between the branches; its interval holds zero where there is none
    Estimate hysteresis_Pa;             ///< the same as pressure, at the middle of the map
    Estimate natural_frequency_Hz, damping, delay_s;
    double rms_Pa = 0.0;
    double residual_correlation = 0.0;  ///< of neighbouring samples
    double lags_s = 0.0;                ///< over which the covariance counts correlation
    std::vector<ValveResiduals> residuals;

    [[nodiscard]] rig::PressureMap map() const;
};

/// From the samples at standstill of the flywheel in all of `recordings`; those without count for nothing. Throws NotIdentifiable.
[[nodiscard]] ValveFit fit_valve(std::span<const Recording> recordings, const KnownRig& rig);

}  // namespace identification
