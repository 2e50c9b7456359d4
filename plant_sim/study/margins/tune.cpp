#include "plant_sim/study/margins/tune.hpp"

#include <algorithm>

namespace study::margins {

namespace {

template <typename LoopAt>
WorstScore worst(const std::vector<TuningCell>& cells, const Requirement& requirement, const LoopAt& loop_at) {
    WorstScore w;
    double min = 1e3;
    for (const TuningCell& c : cells) {
        const double s = score(margins(loop_at(c), kCoarseWalk), requirement);
        ++w.counted;
        if (s < 0.0) ++w.unstable;
        if (s >= 1.0) ++w.met;
        min = std::min(min, s);
    }
    w.value = w.unstable > 0 ? -static_cast<double>(w.unstable) / w.counted : min;
    return w;
}

Parameter around(const char* name, double start, double low, double high) {
    return {name, low, high, std::clamp(start, low, high)};
}

}  // namespace

double score(const Margins& m, const Requirement& r) {
    if (!m.stable) return -1.0;
    return std::min({m.phase_deg / r.phase_deg, m.gain_up_dB / r.gain_dB, m.gain_down_dB / r.gain_dB});
}

std::vector<TuningCell> tuning_cells(const std::vector<StopConditions>& scenarios, const antiskid::control::Config& controller,
                                     const StudyOptions& options) {
    std::vector<TuningCell> cells;
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
        const StopConditions& s = scenarios[i];
        for (const double v : speed_grid(s.rig.brake_on_mps, s.drop_out_mps, options.speeds)) {
            const OperatingPoint at = options.equilibrium(s.rig, controller.slip, v);
            const Limits l = limits(at.wheel_pole_radps(Linearisation::full), s.rig.valve.delay_s, static_cast<double>(controller.period_s));
            if (l.allow(options.requirement)) cells.push_back({i, at});
        }
    }
    return cells;
}

WorstScore pid_score(const Pid& pid, const std::vector<StopConditions>& scenarios, const std::vector<TuningCell>& cells,
                     const Requirement& requirement) {
    return worst(cells, requirement, [&](const TuningCell& c) { return pid_loop(pid, scenarios[c.scenario].rig.valve, c.at, Linearisation::full); });
}

std::vector<Parameter> pid_parameters(const Pid& start) {
    return {around("k_p_per_s", start.k_p_per_s, 5.0, 200.0), around("k_i_per_s2", start.k_i_per_s2, 5.0, 500.0), around("k_d", start.k_d, 0.01, 5.0),
            around("schedule", start.schedule, 0.25, 2.0)};
}

Pid with(Pid pid, const std::vector<double>& values) {
    pid.k_p_per_s = values.at(0);
    pid.k_i_per_s2 = values.at(1);
    pid.k_d = values.at(2);
    pid.schedule = values.at(3);
    return pid;
}

}  // namespace study::margins
