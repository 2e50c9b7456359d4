#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/command_line.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/margins/margins_input.hpp"
#include "plant_sim/study/margins/margins_report.hpp"
#include "rig_bridge/rig/compliance.hpp"

namespace study::margins {

namespace {

/// Of all cells on one tyre, full linearisation.
struct TyreRow {
    rig::Compliance tyre;
    std::size_t cells = 0;
    std::size_t stable = 0;          ///< the law's loop
    std::size_t phase = 0;           ///< of these with the phase margin that is asked for
    std::size_t half_gain = 0;       ///< with half the gain margin, in dB, both ways
    std::size_t gain = 0;            ///< with all of it, both ways
    std::size_t excited = 0;         ///< cells in which the wheel's own swing grows, excites_itself()
    std::size_t excited_stable = 0;  ///< of these, those in which the law's loop is stable all the same
    std::optional<Complex> swing;    ///< the fastest of Cell::swing
    Complex law_slowest;             ///< the fastest of Cell::law_slowest
};

using settings::Json;

constexpr double kPerHz = 2.0 * std::numbers::pi;

Json pole_json(Complex pole) {
    return {{"growth_per_s", pole.real()}, {"frequency_Hz", std::abs(pole.imag()) / kPerHz}};
}

std::string pole_text(Complex pole) {
    return fmt::format("{:.0f} 1/s, {:.0f} Hz", pole.real(), std::abs(pole.imag()) / kPerHz);
}

/// Eq. (6) without its delay, and the line, at j w.
Complex valve_answer(const rig::ValveParameters& valve, double w) {
    const double n = valve.natural_frequency_radps;
    return n * n / (n * n - w * w + Complex(0.0, 2.0 * valve.damping * n * w)) / Complex(1.0, w * valve.line_s);
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

/// Markdown.
std::string to_table(const std::vector<TyreRow>& rows, const ReportHead& head) {
    const Requirement& r = head.options.requirement;
    auto table =
        settings::TextTable::markdown(fmt::format("tyre|cells|stable|{:.0f} deg|{:g} dB both ways|{:g} dB both ways|wheel swings up by itself|of "
                                                  "these stable in the loop|wheel's fastest swing|loop's slowest pole",
                                                  r.phase_deg, 0.5 * r.gain_dB, r.gain_dB));
    for (const TyreRow& row : rows)
        table.add(tyre_name(row.tyre), row.cells, row.stable, row.phase, row.half_gain, row.gain, row.excited, row.excited_stable,
                  row.swing ? pole_text(*row.swing) : "-", pole_text(row.law_slowest));
    return fmt::format("Cells of the shipped law by tyre, slip reference {:.2f}{}\n\n{}", head.options.slip_reference,
                       head.options.low_speed_fall ? ", falling at low speed" : " at every speed", table.text());
}

std::string to_json(const std::vector<TyreRow>& rows, const ReportHead& head) {
    Json tyres = Json::array();
    for (const TyreRow& row : rows)
        tyres.push_back({{"tyre", tyre_name(row.tyre)},
                         {"cells", row.cells},
                         {"stable", row.stable},
                         {"phase_margin", row.phase},
                         {"half_gain_margin", row.half_gain},
                         {"gain_margin", row.gain},
                         {"wheel_swings_up", row.excited},
                         {"wheel_swings_up_but_stable", row.excited_stable},
                         {"fastest_swing", row.swing ? pole_json(*row.swing) : Json()},
                         {"slowest_of_law", pole_json(row.law_slowest)}});
    const Json json{{"study", "margins by tyre"},
                    {"config_hash", head.config_hash},
                    {"version", head.version},
                    {"seed", nullptr},  // nothing is drawn
                    {"slip_reference", head.options.slip_reference},
                    {"low_speed_fall", head.options.low_speed_fall},
                    {"required_phase_margin_deg", head.options.requirement.phase_deg},
                    {"required_gain_margin_dB", head.options.requirement.gain_dB},
                    {"tyres", std::move(tyres)}};
    return settings::json_page(json);
}

/// The cells of one tyre that excite themselves, a row a scenario, in Markdown; empty where there are none. With it what
/// the valve leaves of a command at that frequency.
std::string excited_table(const std::vector<StopConditions>& scenarios, const std::vector<Cell>& cells) {
    auto table = settings::TextTable::markdown(
        "surface|maneuver|cells, speeds (m/s)|stable in the loop|wheel by itself|loop's slowest pole|valve (dB):.0f|valve and delay (deg):.0f");
    bool any = false;
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
        table.add(scenarios[i].surface, scenarios[i].maneuver, fmt::format("{} from {:.1f} to {:.1f}", count, from_mps, to_mps), stable,
                  pole_text(*fastest->swing), pole_text(fastest->law_slowest), 20.0 * std::log10(std::abs(answer)),
                  (std::arg(answer) - w * valve.delay_s) * 180.0 / std::numbers::pi);
        any = true;
    }
    if (!any) return {};
    return "\nWhere the wheel swings up by itself, and in the cell where it does so fastest what the loop makes of it and what the valve leaves of a "
           "command\n\n" +
           table.text();
}

}  // namespace

}  // namespace study::margins

namespace plant_sim::lab {

namespace {

namespace margins = study::margins;

const CLI::Option* list(CLI::App& app, const std::string& name, std::vector<double>& numbers, double min, double max, const std::string& what) {
    return app.add_option(name, numbers, what)
        ->delimiter(',')
        ->check([min, max](const std::string& text) {
            // CLI::Range lets a value pass that is no number.
            double number = 0.0;
            const bool good = CLI::detail::lexical_cast(text, number) && number >= min && number <= max;
            return good ? std::string() : fmt::format("{} is not from {:g} to {:g}", text, min, max);
        })
        ->capture_default_str();
}

void reject(const std::vector<const CLI::Option*>& options, const std::string& model) {
    for (const CLI::Option* o : options)
        if (o->count() > 0) throw std::invalid_argument(o->get_name() + " needs --tyre " + model);
}

/// The keys of [tyre] in the rig's file, in whose place they are. Numbers may be lists: then every combination of them is a tyre.
struct TyreOptions {
    std::string model;  ///< empty: as the rig's file has it
    std::vector<double> belt_share{0.35}, frequency_Hz{80.0}, damping{0.06};
    std::vector<double> length_m{0.20}, floor_m{0.02};

    void add_to(CLI::App& app) {
        settings::one_of(app.add_option("--tyre", model, "static (the paper's), ring or relaxation, in the place of the rig file's [tyre]"),
                         {"static", "ring", "relaxation"});
        of_ring_ = {list(app, "--belt-share", belt_share, 0.01, 0.9, "ring: of J_w that is belt; a list makes a table"),
                    list(app, "--frequency", frequency_Hz, 5.0, 1000.0, "ring: rim against belt, Hz; or a list"),
                    list(app, "--damping", damping, 0.0, 1.0, "ring: of that mode, of critical; or a list")};
        of_relaxation_ = {list(app, "--length", length_m, 0.001, 2.0, "relaxation: length at no slip, m; or a list"),
                          list(app, "--floor", floor_m, 0.001, 2.0, "relaxation: it is nowhere shorter, m; or a list")};
    }

    /// One at least; `own` where none is named. Throws std::invalid_argument where a number belongs to another model.
    [[nodiscard]] std::vector<rig::Compliance> tyres(const rig::Compliance& own) const {
        if (model != "ring") reject(of_ring_, "ring");
        if (model != "relaxation") reject(of_relaxation_, "relaxation");
        rig::Compliance one = own;
        if (model.empty()) return {one};
        one.ring = {};
        one.relaxation = {};
        std::vector<rig::Compliance> all;
        if (model == "static") all.push_back(one);
        if (model == "ring") {
            for (const double frequency : frequency_Hz)
                for (const double zeta : damping)
                    for (const double share : belt_share) {
                        one.ring = {.belt_share = share, .frequency_Hz = frequency, .damping = zeta};
                        all.push_back(one);
                    }
        }
        if (model == "relaxation") {
            for (const double length : length_m)
                for (const double floor : floor_m) {
                    one.relaxation = {.length_m = length, .floor_m = floor};
                    all.push_back(one);
                }
        }
        return all;
    }

  private:
    std::vector<const CLI::Option*> of_ring_, of_relaxation_;
};

struct MarginsCommand {
    StopOptions scenario;
    TyreOptions tyre;
    margins::StudyOptions options;
    bool constant_slip = false;
    std::optional<double> picture_mps;
    std::filesystem::path out = "out/margins";
    std::string json_file;  ///< "-": standard output

    int run() {
        margins::MarginsInput input = margins::load_margins_input(scenario);
        const auto tyres = tyre.tyres(input.cases.front().rig.wheel.compliance);
        const double picture_speed = picture_speed_of(input.cases);
        settings::create_directories(out);  // refused now, not when the study is over
        options.slip_reference = scenario.slip;
        options.low_speed_fall = !constant_slip;
        options.requirement = input.settings.requirement;

        std::vector<margins::TyreRow> rows;
        margins::ReportHead head{.config_hash = input.config_hash, .version = ANTISKID_VERSION, .options = options, .pid = input.settings.pid};
        for (std::size_t i = 0; i < tyres.size(); ++i) {
            for (margins::StopConditions& s : input.cases) s.rig.wheel.compliance = tyres[i];
            const auto cells =
                margins::study_cells(input.cases, input.scenarios.front().controller, input.settings.pid, options, progress(i, tyres.size()));
            if (tyres.size() > 1) {
                rows.push_back(margins::tyre_row(tyres[i], cells, options.requirement));
                continue;
            }
            head.tyre = margins::tyre_name(tyres[i]);
            write_json(out / "results.json", json_file, margins::to_json(input.cases, cells, head));
            margins::draw_plant(input.cases, options.slip_reference, picture_speed, out / "margins.png");
            margins::draw_margins(input.cases, cells, head, out / "margins_speed.png");
            print_table(json_file, "{}{}", margins::to_table(input.cases, cells, head), margins::excited_table(input.cases, cells));
            print_table(json_file, "Written to {}: results.json margins.png margins_speed.png\n", out.string());
        }
        if (rows.empty()) return 0;
        write_json(out / "results.json", json_file, to_json(rows, head));
        print_table(json_file, "{}Written to {}: results.json\n", to_table(rows, head), out.string());
        return 0;
    }

    /// All scenarios must have it between brake-on and drop-out.
    [[nodiscard]] double picture_speed_of(const std::vector<margins::StopConditions>& cases) const {
        constexpr double kUsual_mps = 30.0;
        double low_mps = 0.0, high_mps = std::numeric_limits<double>::infinity();
        for (const margins::StopConditions& c : cases) {
            low_mps = std::max(low_mps, c.drop_out_mps);
            high_mps = std::min(high_mps, c.rig.brake_on_mps);
        }
        const double speed_mps = picture_mps.value_or(std::clamp(kUsual_mps, low_mps, std::max(low_mps, high_mps)));
        if (!(speed_mps >= low_mps && speed_mps <= high_mps))
            throw std::invalid_argument(
                fmt::format("--picture-speed: {:g} is not from {:g} to {:g} m/s, where all maneuvers brake", speed_mps, low_mps, high_mps));
        return speed_mps;
    }
    [[nodiscard]] static margins::Progress progress(std::size_t before, std::size_t tyres) {
        return [=, show = settings::step_progress("scenarios")](std::size_t done, std::size_t all) { show(before * all + done, tyres * all); };
    }
};

}  // namespace

LabVerb margins_verb(CLI::App& lab) {
    const auto command = std::make_shared<MarginsCommand>();
    CLI::App* verb = lab.add_subcommand("margins", "Phase and gain margins of the slip loop, all surfaces and maneuvers over the speed range.");
    verb->add_option("--slip", command->scenario.slip, "slip reference")->check(CLI::Range(0.01, 0.5))->capture_default_str();
    verb->add_option("--speeds", command->options.speeds, "speeds from brake-on to drop-out")->check(CLI::Range(2, 200))->capture_default_str();
    verb->add_flag("--constant-slip", command->constant_slip, "the reference does not fall at low speed: the paper's exact law");
    command->tyre.add_to(*verb);
    verb->add_option("--mu-b", command->scenario.choice.friction, "mean brake friction instead of a new brake's");
    verb->add_option("--picture-speed", command->picture_mps,
                     "speed of margins.png, m/s, from drop-out to the slowest maneuver's (default: 30, or the nearest of these)");
    settings::add_config_directory(*verb, command->scenario.config);
    settings::existing_file(
        verb->add_option("--controller", command->scenario.controller, "controller configuration (default: CONFIG/controller.toml)"));
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory of results.json, margins.png (Fig. 11) and margins_speed.png");
    verb->footer(
        "Two loops: the shipped law with its observer and predictor, and the paper's PID on measured slip with the gains of "
        "CONFIG/margins.toml.\nExamples:\n  rig-lab margins\n  rig-lab margins --constant-slip --speeds 20 --out out/exact\n  rig-lab margins --tyre "
        "ring --frequency 50,80,120 --damping 0.03,0.10 --belt-share 0.25,0.45");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
