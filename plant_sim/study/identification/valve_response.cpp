#include "plant_sim/study/identification/valve_response.hpp"

#include <cmath>
#include <vector>

namespace identification {

namespace {

/// One period with two successive constant inputs.
struct Period {
    double pp, pr, p_old, p_new;
    double rp, rr, r_old, r_new;
};

/// The static input is constant between commands; a delay of n periods and a rest divides each period in two.
Period period(const rig::ValveParameters& valve, double rest_s, double period_s) {
    using Transition = plant::ValveDynamics::Transition;
    const Transition b = plant::ValveDynamics::transition(valve, period_s - rest_s);
    const double b_pu = b.pu0 + b.pu1;
    const double b_ru = b.ru0 + b.ru1;
    constexpr double kNothing_s = 1e-12;
    if (rest_s < kNothing_s) return {.pp = b.pp, .pr = b.pr, .p_old = 0.0, .p_new = b_pu, .rp = b.rp, .rr = b.rr, .r_old = 0.0, .r_new = b_ru};
    const Transition a = plant::ValveDynamics::transition(valve, rest_s);
    const double a_pu = a.pu0 + a.pu1;
    const double a_ru = a.ru0 + a.ru1;
    return {.pp = b.pp * a.pp + b.pr * a.rp,
            .pr = b.pp * a.pr + b.pr * a.rr,
            .p_old = b.pp * a_pu + b.pr * a_ru,
            .p_new = b_pu,
            .rp = b.rp * a.pp + b.rr * a.rp,
            .rr = b.rp * a.pr + b.rr * a.rr,
            .r_old = b.rp * a_pu + b.rr * a_ru,
            .r_new = b_ru};
}

}  // namespace

void valve_response(std::span<const double> current_mA, double period_s, const rig::PressureMap& map, const rig::ValveParameters& valve,
                    std::span<double> pressure_Pa) {
    const double whole = std::floor(valve.delay_s / period_s);
    const Period step = period(valve, valve.delay_s - whole * period_s, period_s);
    const auto delay = static_cast<std::size_t>(whole);
    plant::Play play(std::abs(valve.hysteresis_mA));
    const double sign = valve.hysteresis_mA < 0.0 ? -1.0 : 1.0;
    std::vector<double> static_Pa(current_mA.size());
    double last_mA = NAN;
    for (std::size_t k = 0; k < current_mA.size(); ++k) {
        if (current_mA[k] == last_mA) {
            static_Pa[k] = static_Pa[k - 1];
            continue;
        }
        last_mA = current_mA[k];
        static_Pa[k] = map.pressure_Pa(last_mA + sign * (play.follow(last_mA) - last_mA));
    }
    double p = 0.0;
    double r = 0.0;
    double older = 0.0;
    for (std::size_t k = 0; k < current_mA.size(); ++k) {
        pressure_Pa[k] = p > 0.0 ? p : 0.0;
        const double newer = k >= delay ? static_Pa[k - delay] : 0.0;
        const double next = step.pp * p + step.pr * r + step.p_old * older + step.p_new * newer;
        r = step.rp * p + step.rr * r + step.r_old * older + step.r_new * newer;
        p = next;
        older = newer;
    }
}

}  // namespace identification
