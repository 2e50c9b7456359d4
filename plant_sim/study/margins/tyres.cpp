#include "plant_sim/study/margins/tyres.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>

namespace study::margins {

namespace {

using nlohmann::ordered_json;

constexpr double kPerHz = 2.0 * std::numbers::pi;

ordered_json pole_json(Complex pole) {
    return {{"growth_per_s", pole.real()}, {"frequency_Hz", std::abs(pole.imag()) / kPerHz}};
}

std::string pole_text(Complex pole) {
    return fmt::format("{:.0f} 1/s, {:.0f} Hz", pole.real(), std::abs(pole.imag()) / kPerHz);
}

/// Eq. (6) without its delay, at j w.
Complex valve_answer(const rig::ValveParameters& valve, double w) {
    const double n = valve.natural_frequency_radps;
    return n * n / (n * n - w * w + Complex(0.0, 2.0 * valve.damping * n * w));
}

}  // namespace

std::string tyre_name(const rig::Compliance& tyre) {
    std::string name;
    const auto add = [&name](const std::string& part) { name += (name.empty() ? "" : ", ") + part; };
    if (tyre.ring.belt_share > 0.0)
        add(fmt::format("ring {:g} Hz, damping {:g}, belt {:g}", tyre.ring.frequency_Hz, tyre.ring.damping, tyre.ring.belt_share));
    if (tyre.relaxation.length_m > 0.0) add(fmt::format("relaxation {:g} m, floor {:g} m", tyre.relaxation.length_m, tyre.relaxation.floor_m));
    return name.empty() ? "static" : name;
}

TyreRow tyre_row(const rig::Compliance& tyre, const std::vector<Cell>& cells, const Requirement& requirement) {
    TyreRow row{.tyre = tyre, .cells = cells.size(), .swing = {}, .law_slowest = cells.at(0).law_slowest};
    for (const Cell& c : cells) {
        const Margins& m = c.law.full;
        const double gain_dB = std::min(m.gain_up_dB, m.gain_down_dB);
        row.stable += m.stable ? 1 : 0;
        row.phase += m.stable && m.phase_deg >= requirement.phase_deg ? 1 : 0;
        row.half_gain += m.stable && gain_dB >= 0.5 * requirement.gain_dB ? 1 : 0;
        row.gain += m.stable && gain_dB >= requirement.gain_dB ? 1 : 0;
        row.excited += excites_itself(c) ? 1 : 0;
        row.excited_stable += excites_itself(c) && m.stable ? 1 : 0;
        if (c.swing && (!row.swing || c.swing->real() > row.swing->real())) row.swing = c.swing;
        if (c.law_slowest.real() > row.law_slowest.real()) row.law_slowest = c.law_slowest;
    }
    return row;
}

std::string to_table(const std::vector<TyreRow>& rows, const ReportHead& head) {
    const Requirement& r = head.options.requirement;
    std::string t = fmt::format(
        "Cells of the shipped law by tyre, slip reference {:.2f}{}\n\n| tyre | cells | stable | {:.0f} deg | "
        "{:g} dB "
        "both ways | {:g} dB both ways | wheel swings up by itself | of these stable in the loop | wheel's "
        "fastest swing | "
        "loop's slowest pole |\n|---|---|---|---|---|---|---|---|---|---|\n",
        head.options.slip_reference, head.options.low_speed_fall ? ", falling at low speed" : " at every speed", r.phase_deg, 0.5 * r.gain_dB,
        r.gain_dB);
    for (const TyreRow& row : rows)
        fmt::format_to(std::back_inserter(t), "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", tyre_name(row.tyre), row.cells, row.stable,
                       row.phase, row.half_gain, row.gain, row.excited, row.excited_stable, row.swing ? pole_text(*row.swing) : "-",
                       pole_text(row.law_slowest));
    return t;
}

std::string to_json(const std::vector<TyreRow>& rows, const ReportHead& head) {
    ordered_json tyres = ordered_json::array();
    for (const TyreRow& row : rows)
        tyres.push_back({{"tyre", tyre_name(row.tyre)},
                         {"cells", row.cells},
                         {"stable", row.stable},
                         {"phase_margin", row.phase},
                         {"half_gain_margin", row.half_gain},
                         {"gain_margin", row.gain},
                         {"wheel_swings_up", row.excited},
                         {"wheel_swings_up_but_stable", row.excited_stable},
                         {"fastest_swing", row.swing ? pole_json(*row.swing) : ordered_json()},
                         {"slowest_of_law", pole_json(row.law_slowest)}});
    const ordered_json json{{"study", "margins by tyre"},
                            {"config_hash", head.config_hash},
                            {"version", head.version},
                            {"seed", nullptr},  // nothing is drawn
                            {"slip_reference", head.options.slip_reference},
                            {"low_speed_fall", head.options.low_speed_fall},
                            {"required_phase_margin_deg", head.options.requirement.phase_deg},
                            {"required_gain_margin_dB", head.options.requirement.gain_dB},
                            {"tyres", std::move(tyres)}};
    return json.dump(2) + "\n";
}

std::string excited_table(const std::vector<StopConditions>& scenarios, const std::vector<Cell>& cells) {
    std::string rows;
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
        const Cell* fastest = nullptr;
        std::size_t count = 0, stable = 0;
        double from_mps = 0.0, to_mps = 0.0;
        for (const Cell& c : cells) {
            if (c.scenario != i || !excites_itself(c)) continue;
            from_mps = count == 0 ? c.at.speed_mps : from_mps;
            to_mps = c.at.speed_mps;
            ++count;
            stable += c.law.full.stable ? 1 : 0;
            if (fastest == nullptr || c.swing->real() > fastest->swing->real()) fastest = &c;
        }
        if (fastest == nullptr) continue;
        const rig::ValveParameters& valve = scenarios[i].rig.valve;
        const double w = fastest->swing->imag();
        const Complex answer = valve_answer(valve, w);
        fmt::format_to(std::back_inserter(rows), "| {} | {} | {} from {:.1f} to {:.1f} | {} | {} | {} | {:.0f} | {:.0f} |\n", scenarios[i].surface,
                       scenarios[i].maneuver, count, from_mps, to_mps, stable, pole_text(*fastest->swing), pole_text(fastest->law_slowest),
                       20.0 * std::log10(std::abs(answer)), (std::arg(answer) - w * valve.delay_s) * 180.0 / std::numbers::pi);
    }
    if (rows.empty()) return {};
    return "\nWhere the wheel swings up by itself, and in the cell where it does so fastest what the loop "
           "makes of it "
           "and what the valve leaves of a command\n\n"
           "| surface | maneuver | cells, speeds (m/s) | stable in the loop | wheel by itself | loop's "
           "slowest pole | valve (dB) | "
           "valve and delay (deg) |\n|---|---|---|---|---|---|---|---|\n" +
           rows;
}

}  // namespace study::margins
