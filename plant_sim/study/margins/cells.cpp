#include "plant_sim/study/margins/cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "plant_sim/study/margins/law_loop.hpp"
#include "plant_sim/study/margins/linear_wheel.hpp"

namespace study::margins {

namespace {

constexpr double kUndecided_per_s = 1e-3;  // slower growth counts as the limit of stability

/// `slowest`: Cell::law_slowest.
Margins law_margins(const PeriodicSystem& system, const StopConditions& scenario, Complex& slowest) {
    const SampledLoop loop(system);
    const Margins m = margins(loop);
    slowest = loop.closed_poles().front();
    const double growth = slowest.real();
    if (std::abs(growth) > kUndecided_per_s && m.stable != (growth < 0.0))
        throw std::logic_error("Nyquist's count disagrees with the closed loop's eigenvalues on " + scenario.surface + ", " + scenario.maneuver);
    return m;
}

/// As OperatingPoint::wheel_pole_radps.
double fastest_real_pole_radps(const LinearWheel& wheel) {
    double fastest = -std::numeric_limits<double>::infinity();
    for (const Complex& p : wheel.poles())
        if (p.imag() == 0.0) fastest = std::max(fastest, p.real());
    return -fastest;
}

}  // namespace

OperatingPoint StudyOptions::equilibrium(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double speed_mps) const {
    return operating_point(rig, speed_mps, low_speed_fall ? scheduled_slip(config, slip_reference, speed_mps) : slip_reference);
}

bool meets(const Margins& m, const Requirement& r) {
    return m.stable && m.phase_deg >= r.phase_deg && m.gain_up_dB >= r.gain_dB && m.gain_down_dB >= r.gain_dB;
}

std::vector<Cell> study_cells(const std::vector<StopConditions>& scenarios, const antiskid::control::Config& controller, const Pid& pid,
                              const StudyOptions& options, const Progress& progress) {
    std::vector<Cell> cells;
    cells.reserve(scenarios.size() * static_cast<std::size_t>(options.speeds));
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
        const StopConditions& s = scenarios[i];
        for (const double v : speed_grid(s.rig.brake_on_mps, s.drop_out_mps, options.speeds)) {
            Cell c;
            c.scenario = i;
            c.at = options.equilibrium(s.rig, controller.slip, v);
            c.printed_pole_radps = c.at.wheel_pole_radps(Linearisation::printed);
            c.full_pole_radps = c.at.wheel_pole_radps(Linearisation::full);
            c.reachable = c.at.pressure_Pa <= s.full_pressure_Pa;
            const LinearWheel wheel = linear_wheel(c.at, Linearisation::full);
            c.swing = wheel.swing();
            c.limits = limits(fastest_real_pole_radps(wheel), s.rig.valve.delay_s, static_cast<double>(controller.period_s));
            c.pid = {margins(pid_loop(pid, s.rig.valve, c.at, Linearisation::printed)),
                     margins(pid_loop(pid, s.rig.valve, c.at, Linearisation::full))};
            const PeriodicSystem law = law_system(controller, s.rig, c.at, Linearisation::full);
            c.edge_periods = law.a.size();
            c.controller_growth_per_s = controller_growth_per_s(law);
            Complex printed_slowest;
            c.law.printed = law_margins(law_system(controller, s.rig, c.at, Linearisation::printed), s, printed_slowest);
            c.law.full = law_margins(law, s, c.law_slowest);
            cells.push_back(c);
        }
        if (progress) progress(i + 1, scenarios.size());
    }
    return cells;
}

}  // namespace study::margins
