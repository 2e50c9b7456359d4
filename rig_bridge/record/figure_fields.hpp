/// List of all figures with their names in files, tables and the ledger.
#pragma once

#include <array>

#include "rig_bridge/record/summary.hpp"

namespace rig::record {

struct FigureField {
    const char* key;    ///< in summary.json and the ledger, with the unit
    const char* label;  ///< for people
    const char* unit;
    double scale;  ///< size of the label's unit in the key's unit
    double Figures::*value;
};

inline constexpr std::array kFigureFields{
    FigureField{"brake_on_mps", "speed at brake-on", "m/s", 1.0, &Figures::brake_on_mps},
    FigureField{"duration_s", "duration", "s", 1.0, &Figures::duration_s},
    FigureField{"length_m", "length", "m", 1.0, &Figures::length_m},
    FigureField{"mean_torque_Nm", "mean torque", "N m", 1.0, &Figures::mean_torque_Nm},
    FigureField{"mean_load_N", "mean load", "N", 1.0, &Figures::mean_load_N},
    FigureField{"mean_pressure_Pa", "mean pressure", "MPa", 1e-6, &Figures::mean_pressure_Pa},
    FigureField{"mean_friction", "mean friction mu_b", "", 1.0, &Figures::mean_friction},
    FigureField{"energy_brake_J", "brake energy", "kJ", 1e-3, &Figures::energy_brake_J},
    FigureField{"energy_tyre_J", "tyre energy", "kJ", 1e-3, &Figures::energy_tyre_J},
    FigureField{"kinetic_energy_J", "kinetic energy", "kJ", 1e-3, &Figures::kinetic_energy_J},
    FigureField{"j_mu", "J_mu", "", 1.0, &Figures::j_mu},
    FigureField{"peak_temperature_C", "peak brake temperature", "degC", 1.0, &Figures::peak_temperature_C},
};

}  // namespace rig::record
