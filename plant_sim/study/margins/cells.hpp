/// The study of margins: each scenario at each speed, both loops, both linearisations, and the limits of any controller.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/control/config.hpp"
#include "plant_sim/study/margins/limits.hpp"
#include "plant_sim/study/margins/margins.hpp"
#include "plant_sim/study/margins/pid_loop.hpp"

namespace study::margins {

struct StopConditions {
    std::string surface;
    std::string maneuver;
    rig::RigParameters rig;
    double drop_out_mps = 0.0;
    double full_pressure_Pa = 0.0;
};

struct StudyOptions {
    double slip_reference = 0.24;
    int speeds = 8;              ///< from brake-on down to drop-out
    bool low_speed_fall = true;  ///< linearised at the reference in force; false: at `slip_reference` at every speed, the paper's exact law
    Requirement requirement;

    /// Equilibrium at which a cell is linearised.
    [[nodiscard]] OperatingPoint equilibrium(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double speed_mps) const;
};

/// Margins of both values of Linearisation, in its order.
struct BothMargins {
    Margins printed, full;
};

struct Cell {
    std::size_t scenario = 0;  ///< index
    OperatingPoint at;
    double printed_pole_radps = 0.0;
    double full_pole_radps = 0.0;
    bool reachable = true;         ///< whether the valve's full pressure can hold this slip
    Limits limits;                 ///< of any controller with this period, by the wheel's fastest real unstable pole
    std::optional<Complex> swing;  ///< of the wheel alone, full linearisation, see LinearWheel::swing()
    BothMargins pid;
    BothMargins law;
    Complex law_slowest;                   ///< the closed loop's pole with the largest real part, 1/s and rad/s
    double controller_growth_per_s = 0.0;  ///< of the law alone, see controller_growth_per_s()
    std::size_t edge_periods = 1;          ///< periods between two edges of the wheel's encoder, N of law_loop.hpp
};

/// Whether the wheel's own oscillation grows: beyond the peak a belt with too little damping is unstable.
[[nodiscard]] inline bool excites_itself(const Cell& cell) {
    return cell.swing && cell.swing->real() > 0.0;
}

[[nodiscard]] bool meets(const Margins& margins, const Requirement& requirement);

/// Called after each scenario with the number done.
using Progress = std::function<void(std::size_t done, std::size_t all)>;

/// Cells by scenario, fastest first. Throws std::logic_error if Nyquist's count and the closed loop's eigenvalues disagree.
[[nodiscard]] std::vector<Cell> study_cells(const std::vector<StopConditions>& scenarios, const antiskid::control::Config& controller, const Pid& pid,
                                            const StudyOptions& options, const Progress& progress = {});

}  // namespace study::margins
