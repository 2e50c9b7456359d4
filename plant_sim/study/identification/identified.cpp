#include "plant_sim/study/identification/identified.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"

namespace identification {

namespace {

using settings::Json;

Json json(const Estimate& e) {
    return {{"value", e.value}, {"low", e.low}, {"high", e.high}, {"deviation", e.deviation}};
}

Json json(const ValveFit& v) {
    Json points = Json::array();
    for (std::size_t i = 0; i < v.current_mA.size(); ++i) {
        Json point = json(v.pressure_Pa[i]);
        point["current_mA"] = v.current_mA[i];
        points.push_back(std::move(point));
    }
    Json residuals = Json::array();
    for (const ValveResiduals& r : v.residuals) residuals.push_back({{"recording", r.recording}, {"rms_Pa", r.rms_Pa}});
    return {{"dead_zone_mA", json(v.dead_zone_mA)},
            {"pressure_Pa", points},
            {"hysteresis_mA", json(v.hysteresis_mA)},
            {"hysteresis_Pa", json(v.hysteresis_Pa)},
            {"natural_frequency_Hz", json(v.natural_frequency_Hz)},
            {"damping", json(v.damping)},
            {"delay_s", json(v.delay_s)},
            {"rms_Pa", v.rms_Pa},
            {"residual_correlation", v.residual_correlation},
            {"lags_s", v.lags_s},
            {"residuals", residuals}};
}

Json json(const WheelFit& w) {
    Json relative = Json::array();
    for (const Estimate& e : w.relative_friction) relative.push_back(json(e));
    Json all{{"inertia_kgm2", json(w.inertia_kgm2)}, {"gain_m3", json(w.gain_m3)},    {"friction", json(w.friction)},
             {"friction_class", w.friction_class},   {"relative_friction", relative}, {"lags_s", w.lags_s}};
    all["misfit"] = w.misfit;
    if (w.contact_Pa) all["contact_Pa"] = json(*w.contact_Pa);
    if (w.piston_friction) all["piston_friction"] = json(*w.piston_friction);
    return all;
}

Json json(const FrictionFit& f) {
    Json all{{"surface", f.surface},
             {"curve", f.curve.magic ? "magic formula" : "eq. (4)"},
             {"misfit", f.misfit},
             {"rms", f.rms},
             {"readings", f.slip.size()},
             {"lags_s", f.lags_s},
             {"largest_slip", f.largest_slip}};
    for (const Coefficient& c : f.coefficients) all[c.name] = json(c.estimate);
    return all;
}

}  // namespace

std::vector<Quantity> quantities(const Identified& found) {
    const ValveFit& v = found.valve;
    std::vector<Quantity> all{{"dead zone", "mA", v.dead_zone_mA}};
    all.reserve(v.current_mA.size() + 16);
    for (std::size_t i = 0; i < v.current_mA.size(); ++i)
        all.push_back({fmt::format("pressure at {:g} mA", v.current_mA[i]), "MPa", scaled(v.pressure_Pa[i], 1e-6)});
    all.push_back({"hysteresis", "mA", v.hysteresis_mA});
    all.push_back({"hysteresis", "kPa", scaled(v.hysteresis_Pa, 1e-3)});
    all.push_back({"omega_n / 2 pi", "Hz", v.natural_frequency_Hz});
    all.push_back({"xi", "", v.damping});
    all.push_back({"tau", "ms", scaled(v.delay_s, 1e3)});
    if (found.wheel) {
        const WheelFit& w = *found.wheel;
        all.push_back({"J_w", "kg m2", w.inertia_kgm2});
        all.push_back({"k_b", "1e-3 m3", scaled(w.gain_m3, 1e3)});
        all.push_back({"mean mu_b", "", w.friction});
        if (w.contact_Pa) all.push_back({"contact pressure", "MPa", scaled(*w.contact_Pa, 1e-6)});
        if (w.piston_friction) all.push_back({"piston friction", "%", scaled(*w.piston_friction, 100.0)});
        for (std::size_t k = 0; k < w.relative_friction.size(); ++k)
            all.push_back({fmt::format("mu_b({}), power {}", w.friction_class, k), "", w.relative_friction[k]});
    }
    for (const FrictionFit& f : found.surfaces)
        for (const Coefficient& c : f.coefficients) all.push_back({f.surface + " " + c.name, "", c.estimate});
    return all;
}

std::string to_table(const Identified& found) {
    auto table = settings::TextTable::screen(":<27|estimate:>12.6g|:<10|95 % interval");
    for (const Quantity& q : quantities(found))
        table.add(q.name, q.estimate.value, fmt::format(" {}", q.unit), fmt::format("{:.6g} to {:.6g}", q.estimate.low, q.estimate.high));
    if (found.wheel && found.wheel->misfit > kMaxMisfit)
        table.line(fmt::format(
            "warning: brake: the wheel's balance is off {:.1f} times as far as errors of the sensors explain, in the mean: pressure and speed "
            "alone do not explain the torque (discs that are not true, heat), or stops differ; see wheel.png",
            found.wheel->misfit));
    for (const FrictionFit& f : found.surfaces) {
        if (f.curve.magic) table.line(fmt::format("{}: a magic formula fits better than eq. (4)", f.surface));
        if (f.misfit > kMaxMisfit)
            table.line(
                fmt::format("warning: {}: readings are {:.1f} times as far from the curve as their errors explain, in the mean: the intervals of its "
                            "coefficients are too narrow; see friction_{}.png",
                            f.surface, f.misfit, f.surface));
    }
    return table.text();
}

std::string to_json(const Identified& found, const std::string& head) {
    Json all = settings::parse_json(head);
    all["valve"] = json(found.valve);
    if (found.wheel) all["wheel"] = json(*found.wheel);
    Json surfaces = Json::array();
    for (const FrictionFit& f : found.surfaces) surfaces.push_back(json(f));
    all["surfaces"] = surfaces;
    return settings::json_page(all);
}

}  // namespace identification
