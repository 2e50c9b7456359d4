#include "plant_sim/study/margins/margins_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/study/margins/law_loop.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace study::margins {

namespace {

using settings::Json;

Json to_json(const Margins& m) {
    // NaN and infinity become null.
    return {{"stable", m.stable},
            {"unstable_open_loop_poles", m.unstable_poles},
            {"encirclements", m.encirclements},
            {"phase_margin_deg", m.phase_deg},
            {"gain_margin_up_dB", m.gain_up_dB},
            {"gain_margin_down_dB", m.gain_down_dB},
            {"modulus_margin", m.modulus},
            {"crossover_radps", m.crossover_radps},
            {"upward_oscillation_radps", m.upward_radps},
            {"downward_oscillation_radps", m.downward_radps}};
}

Json to_json(const BothMargins& m) {
    return {{"printed", to_json(m.printed)}, {"full", to_json(m.full)}};
}

/// The worst margins of one loop over the speeds of a scenario.
class Worst {
  public:
    void add(const Margins& m, double speed_mps) {
        if (!m.stable) {
            unstable_below_ = std::max(unstable_below_, speed_mps);
            return;
        }
        take(phase_, m.phase_deg, speed_mps);
        take(up_, m.gain_up_dB, speed_mps);
        take(down_, m.gain_down_dB, speed_mps);
    }
    /// Adds three columns.
    void add_to(settings::TextTable& table) const {
        table.add(unstable_below_ > 0.0 ? fmt::format("unstable from {:.0f} m/s", unstable_below_) : one(phase_), one(up_), one(down_));
    }

  private:
    struct At {
        double value = std::numeric_limits<double>::infinity();
        double speed_mps = 0.0;
    };
    static void take(At& worst, double value, double speed_mps) {
        if (value < worst.value) worst = {value, speed_mps};
    }
    static std::string one(const At& a) { return std::isfinite(a.value) ? fmt::format("{:.1f} at {:.0f}", a.value, a.speed_mps) : "-"; }
    At phase_, up_, down_;
    double unstable_below_ = 0.0;
};

/// Fastest speed of a scenario at which `bad` holds, and the number of such speeds; "-" if there is none.
template <typename Bad>
std::string from_speed(const std::vector<Cell>& cells, std::size_t scenario, const Bad& bad) {
    double fastest = 0.0;
    int count = 0;
    for (const Cell& c : cells) {
        if (c.scenario != scenario || !bad(c)) continue;
        fastest = std::max(fastest, c.at.speed_mps);
        ++count;
    }
    return count == 0 ? "-" : fmt::format("{} from {:.1f}", count, fastest);
}

/// A series a scenario, in the colour of its surface; the legend names each surface once.
std::vector<pictures::Series> series_of(const std::vector<StopConditions>& scenarios) {
    std::vector<pictures::Series> all;
    std::vector<std::string> surfaces;
    for (const StopConditions& s : scenarios) {
        const auto found = std::find(surfaces.begin(), surfaces.end(), s.surface);
        const bool first = found == surfaces.end();
        const auto colour = static_cast<std::size_t>(found - surfaces.begin());
        if (first) surfaces.push_back(s.surface);
        all.push_back({.name = s.surface, .colour = colour, .width = 1.2, .in_legend = first});
    }
    return all;
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

std::string to_table(const std::vector<StopConditions>& scenarios, const std::vector<Cell>& cells, const ReportHead& head) {
    const Requirement& r = head.options.requirement;
    auto table =
        settings::TextTable::markdown(fmt::format("surface|maneuver|law: PM (deg):|up (dB)|down (dB)|PID: PM (deg):|up (dB)|down (dB)|cells below "
                                                  "{:.0f} deg or {:.0f} dB: law:|PID|infeasible for any controller",
                                                  r.phase_deg, r.gain_dB));
    const auto law_fails = [&](const Cell& c) { return !meets(c.law.full, r); };
    const auto pid_fails = [&](const Cell& c) { return !meets(c.pid.full, r); };
    const auto infeasible = [&](const Cell& c) { return !c.limits.allow(r); };
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
        Worst law, pid;
        for (const Cell& c : cells) {
            if (c.scenario != i) continue;
            law.add(c.law.full, c.at.speed_mps);
            pid.add(c.pid.full, c.at.speed_mps);
        }
        table.add(scenarios[i].surface, scenarios[i].maneuver);
        law.add_to(table);
        pid.add_to(table);
        table.add(from_speed(cells, i, law_fails), from_speed(cells, i, pid_fails), from_speed(cells, i, infeasible));
    }
    const auto count = [&](const auto& bad) { return std::count_if(cells.begin(), cells.end(), bad); };
    return fmt::format(
        "Worst margins over the speeds from brake-on to drop-out, full linearisation, tyre {}, slip reference {:.2f}{}: value at speed (m/s)\n\n"
        "{}\nOf {} cells: law stable in {}, by itself in {}, {:.0f} deg and {:.0f} dB both ways in {}; PID stable in {}, meets in {}; no controller "
        "can in {}.\n",
        head.tyre, head.options.slip_reference, head.options.low_speed_fall ? ", falling at low speed" : " at every speed", table.text(),
        cells.size(), count([](const Cell& c) { return c.law.full.stable; }),
        count([](const Cell& c) { return c.controller_growth_per_s <= kIntegrates_per_s; }), r.phase_deg, r.gain_dB,
        cells.size() - static_cast<std::size_t>(count(law_fails)), count([](const Cell& c) { return c.pid.full.stable; }),
        cells.size() - static_cast<std::size_t>(count(pid_fails)), count(infeasible));
}

std::string to_json(const std::vector<StopConditions>& scenarios, const std::vector<Cell>& cells, const ReportHead& head) {
    Json rows = Json::array();
    for (const Cell& c : cells) {
        const bool limited = c.limits.gamma > 1.0;
        rows.push_back({{"surface", scenarios[c.scenario].surface},
                        {"maneuver", scenarios[c.scenario].maneuver},
                        {"speed_mps", c.at.speed_mps},
                        {"slip", c.at.slip},
                        {"pressure_Pa", c.at.pressure_Pa},
                        {"reachable", c.reachable},
                        {"pole_printed_radps", -c.printed_pole_radps},
                        {"pole_full_radps", -c.full_pole_radps},
                        {"wheel_swing_growth_per_s", c.swing ? Json(c.swing->real()) : Json()},
                        {"wheel_swing_radps", c.swing ? Json(c.swing->imag()) : Json()},
                        {"wheel_edge_periods", c.edge_periods},
                        {"law_alone_growth_per_s", c.controller_growth_per_s},
                        {"law_slowest_growth_per_s", c.law_slowest.real()},
                        {"law_slowest_radps", std::abs(c.law_slowest.imag())},
                        {"limit_phase_margin_deg", limited ? Json(c.limits.phase_deg) : Json()},
                        {"limit_gain_range_dB", limited ? Json(c.limits.gain_range_dB) : Json()},
                        {"feasible", c.limits.allow(head.options.requirement)},
                        {"pid", to_json(c.pid)},
                        {"law", to_json(c.law)}});
    }
    const Requirement& r = head.options.requirement;
    const auto share = [&](const auto& good) {
        return 100.0 * static_cast<double>(std::count_if(cells.begin(), cells.end(), good)) / static_cast<double>(cells.size());
    };
    const Json json{
        {"study", "margins"},
        {"config_hash", head.config_hash},
        {"version", head.version},
        {"seed", nullptr},  // nothing is drawn
        {"tyre", head.tyre},
        {"slip_reference", head.options.slip_reference},
        {"low_speed_fall", head.options.low_speed_fall},
        {"required_phase_margin_deg", head.options.requirement.phase_deg},
        {"required_gain_margin_dB", head.options.requirement.gain_dB},
        {"share_of_cells",  // of the law, %
         {{"stable", share([](const Cell& c) { return c.law.full.stable; })},
          {"phase", share([&](const Cell& c) { return c.law.full.stable && c.law.full.phase_deg >= r.phase_deg; })},
          {"meets", share([&](const Cell& c) { return meets(c.law.full, r); })},
          {"feasible", share([&](const Cell& c) { return c.limits.allow(r); })}}},
        {"pid",
         {{"k_p_per_s", head.pid.k_p_per_s},
          {"k_i_per_s2", head.pid.k_i_per_s2},
          {"k_d", head.pid.k_d},
          {"filter_s", head.pid.filter_s},
          {"schedule", head.pid.schedule}}},
        {"cells", std::move(rows)},
    };
    return settings::json_page(json);
}

void draw_plant(const std::vector<StopConditions>& scenarios, double slip_reference, double speed_mps, const std::filesystem::path& png) {
    constexpr double kFrom_radps = 0.01, kTo_radps = 2000.0;
    constexpr int kPoints = 200;
    std::vector<pictures::Series> magnitude = series_of(scenarios);
    std::vector<pictures::Series> phases = magnitude;
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
        const StopConditions& s = scenarios[i];
        const OperatingPoint at = operating_point(s.rig, speed_mps, slip_reference);
        double phase = 0.0, before = 0.0;
        bool first = true;
        for (const LocusPoint& p : locus(plant_loop(s.rig.valve, at, Linearisation::full), kFrom_radps, kTo_radps, kPoints)) {
            const double arg = std::arg(p.value);
            if (first) {
                // A stable wheel starts at 0 degrees, an unstable one at -180.
                phase = at.wheel_pole_radps(Linearisation::full) < 0.0 ? -std::abs(arg) : arg;
                first = false;
            } else {
                phase += std::remainder(arg - before, 2.0 * std::numbers::pi);
            }
            before = arg;
            magnitude[i].add(p.frequency_radps, 20.0 * std::log10(std::abs(p.value)));
            phases[i].add(p.frequency_radps, phase * 180.0 / std::numbers::pi);
        }
    }
    const auto chart = [](const char* title, const char* label, const std::vector<pictures::Series>& series, pictures::Range x,
                          std::optional<pictures::Range> y) {
        return pictures::Chart{
            .title = title, .y_label = label, .x_label = "frequency (rad/s)", .series = series, .x_range = x, .y_range = y, .logarithmic_x = true};
    };
    constexpr pictures::Range kAll{kFrom_radps, kTo_radps}, kLoop{10.0, 400.0};
    constexpr pictures::Range kAllPhases{-720.0, 45.0}, kLoopPhases{-360.0, 0.0}, kLoopMagnitude{-60.0, 0.0};
    pictures::draw({.title = fmt::format("L(s) = G(s) A(s), eq. (15) and (6), slip per MPa: {} scenarios at slip {:.2f} and {:.0f} m/s",
                                         scenarios.size(), slip_reference, speed_mps),
                    .charts = {chart("(a) overview", "magnitude (dB)", magnitude, kAll, {}),
                               chart("(b) around the control loop's frequencies", "magnitude (dB)", magnitude, kLoop, kLoopMagnitude),
                               chart("", "phase (deg)", phases, kAll, kAllPhases), chart("", "phase (deg)", phases, kLoop, kLoopPhases)},
                    .columns = 2},
                   png);
}

void draw_margins(const std::vector<StopConditions>& scenarios, const std::vector<Cell>& cells, const ReportHead& head,
                  const std::filesystem::path& png) {
    const Requirement& requirement = head.options.requirement;
    double fastest = 0.0;
    for (const Cell& c : cells) fastest = std::max(fastest, c.at.speed_mps);
    const auto chart = [&](const char* title, const char* label, pictures::Range range, double wanted, const auto& value) {
        pictures::Chart one{
            .title = title, .y_label = label, .x_label = "speed (m/s)", .series = series_of(scenarios), .x_range = {}, .y_range = range};
        for (const Cell& c : cells) one.series[c.scenario].add(c.at.speed_mps, value(c));
        one.series.push_back(pictures::level("asked for", 0.0, fastest, wanted, pictures::black));
        return one;
    };
    pictures::draw(
        {.title = fmt::format("Margins of the shipped slip law over speed, tyre {}, all scenarios (one line each)", head.tyre),
         .charts = {chart("phase margin", "deg", {0.0, 100.0}, requirement.phase_deg, [](const Cell& c) { return c.law.full.phase_deg; }),
                    chart("largest phase margin of any controller", "deg", {0.0, 185.0}, requirement.phase_deg,
                          [](const Cell& c) { return c.limits.phase_deg; }),
                    chart("upward gain margin", "dB", {0.0, 10.0}, requirement.gain_dB, [](const Cell& c) { return c.law.full.gain_up_dB; }),
                    chart("downward gain margin; no line: none needed", "dB", {0.0, 40.0}, requirement.gain_dB,
                          [](const Cell& c) { return c.law.full.gain_down_dB; })},
         .columns = 2},
        png);
}

}  // namespace study::margins
