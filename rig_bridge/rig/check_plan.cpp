#include "rig_bridge/rig/check_plan.hpp"

#include <fmt/core.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "firmware/host/settings/error.hpp"

namespace rig {

namespace {

void reject(const char* member, double value, const std::string& expected) {
    throw std::invalid_argument("plan: " + std::string(member) + " is " + std::to_string(value) + "; expected " + expected);
}

void check_current(const Plan& plan) {
    if (plan.law != BrakeLaw::open_loop) return;
    if (plan.current.empty()) throw std::invalid_argument("plan: the open loop needs a current profile of one point or more");
    for (std::size_t i = 0; i < plan.current.size(); ++i) {
        const CurrentPoint& point = plan.current[i];
        if (!(point.current_mA >= 0.0) || !std::isfinite(point.current_mA)) reject("current_mA", point.current_mA, "0 or more");
        if (!(point.time_s >= 0.0) || !std::isfinite(point.time_s) || (i > 0 && !(point.time_s > plan.current[i - 1].time_s)))
            reject("time_s of the current", point.time_s, "rising times from 0");
    }
}

}  // namespace

void check(const Plan& plan) {
    struct Number {
        const char* name;
        double value;
    };
    const Number positive[] = {
        {"speed_mps", plan.speed_mps},
        {"load_base_N", plan.load_base_N},
        {"demand_Pa", plan.demand_Pa},
        {"speed_tolerance_mps", plan.speed_tolerance_mps},
        {"rolling_radius_m", plan.rolling_radius_m},
        {"mismatch_s", plan.mismatch_s},
        {"speed_band_mps", plan.speed_band_mps},
        {"settle_slip", plan.settle_slip},
        {"standstill_mps", plan.standstill_mps},
        {"sledge_back_m", plan.sledge_back_m},
        {"pressure_gone_Pa", plan.pressure_gone_Pa},
        {"load_band", plan.load_band},
        {"idle_limit_s", plan.idle_limit_s},
        {"spin_up_limit_s", plan.spin_up_limit_s},
        {"touchdown_limit_s", plan.touchdown_limit_s},
        {"settling_limit_s", plan.settling_limit_s},
        {"braking_limit_s", plan.braking_limit_s},
        {"standstill_limit_s", plan.standstill_limit_s},
        {"retract_limit_s", plan.retract_limit_s},
        {"cool_down_limit_s", plan.cool_down_limit_s},
        {"abort_limit_s", plan.abort_limit_s},
    };
    for (const Number& n : positive) {
        if (!(n.value > 0.0) || !std::isfinite(n.value)) reject(n.name, n.value, "a number above 0");
    }
    const Number not_negative[] = {
        {"load_lift_Ns2pm2", plan.load_lift_Ns2pm2},   {"slip_reference", plan.slip_reference},
        {"deceleration_mps2", plan.deceleration_mps2}, {"wheel_share", plan.wheel_share},
        {"coasting_mps", plan.coasting_mps},           {"settle_s", plan.settle_s},
        {"settle_hold_s", plan.settle_hold_s},         {"hold_s", plan.hold_s},
    };
    for (const Number& n : not_negative) {
        if (!(n.value >= 0.0) || !std::isfinite(n.value)) reject(n.name, n.value, "0 or more");
    }
    if (!std::isfinite(plan.cool_to_C)) reject("cool_to_C", plan.cool_to_C, "a temperature");
    if (!std::isfinite(plan.brake_on_limit_C)) reject("brake_on_limit_C", plan.brake_on_limit_C, "a temperature");
    const double fastest_mps = top_speed_mps(plan);
    if (plan.load_base_N - plan.load_lift_Ns2pm2 * fastest_mps * fastest_mps <= 0.0)
        reject("load_lift_Ns2pm2", plan.load_lift_Ns2pm2, "a load that stays above zero up to speed_band_mps above the set-point");
    check_current(plan);
}

void check(const Plan& plan, const RegisterMap& map, const std::filesystem::path& file) {
    const auto fits = [&](Commanded which, double value) {
        const Field& field = map.field(which);
        if (value >= field.min && value <= field.max) return;
        throw settings::Error(
            file.string(), 0, "holding." + field.name + ".range",
            fmt::format("ends at {:g} {}; expected room for the scenario's {:g}", value > field.max ? field.max : field.min, field.unit, value));
    };
    fits(Commanded::flywheel_speed_mps, plan.speed_mps * (1.0 + plan.wheel_share) + plan.coasting_mps);
    fits(Commanded::load_base_N, plan.load_base_N);
    fits(Commanded::load_lift_Ns2pm2, plan.load_lift_Ns2pm2);
}

}  // namespace rig
