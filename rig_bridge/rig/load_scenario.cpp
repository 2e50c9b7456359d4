#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "firmware/host/settings/settings.hpp"
#include "rig_bridge/rig/check_plan.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace rig {

namespace {

using rig::BrakeLaw;
using rig::Plan;
using settings::Document;
using settings::Range;
using settings::Table;

constexpr std::array<settings::Choice<BrakeLaw>, 6> kLaws{{{"slip", BrakeLaw::slip},
                                                           {"deceleration", BrakeLaw::deceleration},
                                                           {"open_loop", BrakeLaw::open_loop},
                                                           {"threshold", BrakeLaw::threshold},
                                                           {"pressure_bias", BrakeLaw::pressure_bias},
                                                           {"peak_slip", BrakeLaw::peak_slip}}};

/// Numbers that sequencer.toml has for all scenarios and a scenario may replace.
class Layered {
  public:
    Layered(Table base, std::optional<Table> own) : base_(std::move(base)), own_(std::move(own)) {}

    /// Reads both, so that a mistake in either is reported.
    [[nodiscard]] double number(std::string_view key, const Range& range) const {
        const double base = base_.number(key, range);
        const std::optional<double> own = own_ ? own_->find_number(key, range) : std::nullopt;
        return own.value_or(base);
    }
    /// The table that has the key, for further checks by the caller.
    [[nodiscard]] const Table& where(std::string_view key) const { return own_ && own_->has(key) ? *own_ : base_; }

  private:
    Table base_;
    std::optional<Table> own_;
};

void read_sequence(const Layered& t, Scenario& scenario) {
    Plan& plan = scenario.mean;
    constexpr Range kTime_s{.min = 0.0, .max = 60.0};
    plan.speed_tolerance_mps = t.number("speed_tolerance_mps", {.min = 0.001, .max = 5.0});
    plan.speed_band_mps = t.number("speed_band_mps", {.min = 0.01, .max = 50.0});
    plan.mismatch_s = t.number("mismatch_s", {.min = 0.05, .max = 10.0});
    plan.coasting_mps = t.number("coasting_mps", {.min = 0.0, .max = 5.0});
    scenario.energy_band = t.number("energy_band", {.min = 0.005, .max = 1.0});
    plan.settle_s = t.number("settle_s", kTime_s);
    plan.settle_slip = t.number("settle_slip", {.min = 1e-4, .max = 0.5});
    plan.settle_hold_s = t.number("settle_hold_s", kTime_s);
    plan.load_band = t.number("load_band", {.min = 0.01, .max = 1.0});
    plan.standstill_mps = t.number("standstill_mps", {.min = 0.001, .max = 1.0});
    plan.hold_s = t.number("hold_s", {.min = 0.0, .max = 600.0});
    plan.sledge_back_m = t.number("sledge_back_m", {.min = 1e-4, .max = 1.0});
    plan.pressure_gone_Pa = t.number("pressure_gone_Pa", {.min = 1e4, .max = 5e6});
    constexpr Range kTemperature_C{.min = -50.0, .max = 2000.0};
    plan.brake_on_limit_C = t.number("brake_on_limit_C", kTemperature_C);
    plan.cool_to_C = t.number("cool_to_C", kTemperature_C);
    if (plan.cool_to_C > plan.brake_on_limit_C) {
        t.where("cool_to_C")
            .fail("cool_to_C",
                  "is above brake_on_limit_C: the next maneuver would not start; expected at most " + std::to_string(plan.brake_on_limit_C));
    }
}

void read_limits(const Layered& t, Plan& plan) {
    constexpr Range kLimit_s{.min = 0.1, .max = 1e5};
    plan.idle_limit_s = t.number("idle_s", kLimit_s);
    plan.spin_up_limit_s = t.number("spin_up_s", kLimit_s);
    plan.touchdown_limit_s = t.number("touchdown_s", kLimit_s);
    plan.settling_limit_s = t.number("settling_s", kLimit_s);
    plan.braking_limit_s = t.number("braking_s", kLimit_s);
    plan.standstill_limit_s = t.number("standstill_s", kLimit_s);
    plan.retract_limit_s = t.number("retract_s", kLimit_s);
    plan.cool_down_limit_s = t.number("cool_down_s", kLimit_s);
    plan.abort_limit_s = t.number("abort_s", kLimit_s);
}

constexpr Range kDeceleration_mps2{.min = 0.0, .max = 15.0};

/// Adds a sine with continuously rising frequency, at intervals of the sequencer's step.
void add_sweep(const Table& t, std::vector<rig::CurrentPoint>& points) {
    constexpr double kStep_s = 0.01;
    const double begin_s = t.number("begin_s", {.min = 0.0, .max = 3600.0});
    const double duration_s = t.number("duration_s", {.min = 1.0, .max = 600.0});
    // Above half the rate of the command's frames (20 ms) the samples would be aliased.
    constexpr Range kFrequency_Hz{.min = 0.01, .max = 25.0};
    const double from_Hz = t.number("from_Hz", kFrequency_Hz);
    const double to_Hz = t.number("to_Hz", kFrequency_Hz);
    const double mean_mA = t.number("mean_mA", {.min = 0.0, .max = 1000.0});
    const double amplitude_mA = t.number("amplitude_mA", {.min = 0.0, .max = mean_mA});
    if (begin_s <= points.back().time_s) {
        t.fail("begin_s", "must lie behind the last of current_time_s, " + std::to_string(points.back().time_s) + " s");
    }
    const auto steps = static_cast<std::size_t>(std::llround(duration_s / kStep_s));
    points.reserve(points.size() + steps + 1);
    for (std::size_t i = 0; i <= steps; ++i) {
        const double since_s = static_cast<double>(i) * kStep_s;
        const double turns = from_Hz * since_s + 0.5 * (to_Hz - from_Hz) / duration_s * since_s * since_s;
        points.push_back({.time_s = begin_s + since_s, .current_mA = mean_mA + amplitude_mA * std::sin(2.0 * std::numbers::pi * turns)});
    }
}

std::vector<rig::CurrentPoint> current(const Table& t) {
    const auto time_s = t.numbers("current_time_s", {.range = {.min = 0.0, .max = 3600.0}, .strictly_increasing = true});
    const auto current_mA = t.numbers("current_mA", {.range = {.min = 0.0, .max = 1000.0}});
    if (current_mA.size() != time_s.size()) t.fail("current_mA", "needs as many points as current_time_s");
    std::vector<rig::CurrentPoint> points;
    points.reserve(time_s.size());
    for (std::size_t i = 0; i < time_s.size(); ++i) points.push_back({time_s[i], current_mA[i]});
    if (const auto sweep = t.find_table("sweep")) add_sweep(*sweep, points);
    return points;
}

void read_law(const Table& t, const rig::LoadedRig& rig, Plan& plan) {
    plan.law = t.choice<BrakeLaw>("law", kLaws);
    plan.demand_Pa = t.find_number("demand_Pa", {.min = 1e5, .max = rig.full_pressure_Pa}).value_or(rig.full_pressure_Pa);
    plan.deceleration_mps2 = t.find_number("deceleration_mps2", kDeceleration_mps2).value_or(rig.deceleration_mps2);
    if (plan.law == BrakeLaw::slip) plan.slip_reference = t.number("slip_reference", {.min = 0.01, .max = 0.5});
    if (plan.law == BrakeLaw::open_loop) plan.current = current(t);
    if (plan.law == BrakeLaw::deceleration && plan.deceleration_mps2 <= 0.0)
        t.fail("deceleration_mps2", "is missing; this maneuver prescribes none, expected 0.1 to 15");
}

Scatter scatter(const Table& t) {
    return {.speed_mps = t.find_number("speed_deviation_mps", {.min = 0.0, .max = 5.0}).value_or(0.0),
            .load_N = t.find_number("load_deviation_N", {.min = 0.0, .max = 5000.0}).value_or(0.0),
            .deceleration_mps2 = t.find_number("deceleration_deviation_mps2", {.min = 0.0, .max = 2.0}).value_or(0.0)};
}

std::vector<Band> declared_bands(const Table& t) {
    std::vector<Band> bands;
    for (const record::FigureField& field : record::kFigureFields) {
        const auto ends = t.find_numbers(field.key, {.count = {.min = 2, .max = 2}, .strictly_increasing = true});
        if (ends) bands.push_back({.figure = &field, .min = ends->front(), .max = ends->back()});
    }
    return bands;
}

rig::ManeuverChoice choice(const Table& t, const std::filesystem::path& config) {
    rig::ManeuverChoice choice;
    choice.maneuver = t.text("name");
    const bool one_surface = t.has("surface"), runway = t.has("runway");
    if (one_surface && runway) t.fail("runway", "stands beside 'surface'; expected one of them");
    if (runway)
        choice.runway = config / t.text("runway");
    else
        choice.surface = t.text("surface");
    choice.carrier = rig::Carrier::flywheel;
    choice.speed_mps = t.find_number("speed_mps", {.min = 1.0, .max = 120.0});
    choice.mass_kg = t.find_number("mass_kg", {.min = 100.0, .max = 1e5});
    return choice;
}

}  // namespace

Scenario load_scenario(const std::filesystem::path& file, const std::filesystem::path& config) {
    const auto base_file = config / "sequencer.toml";
    const Document doc = Document::load(file);
    const Document base = Document::load(base_file);
    const Table root = doc.root();
    const rig::ManeuverChoice chosen = choice(root.table("maneuver"), config);
    Scenario s{.name = file.stem().string(),
               .title = root.text("title"),
               .choice = chosen,
               .rig = rig::load_rig(config, chosen),
               .controller = config / root.text("controller"),
               .mean = {},
               .scatter = {},
               .acceptance = {},
               .files = {file, base_file}};
    s.mean.speed_mps = s.rig.rig.brake_on_mps;
    const rig::EncoderParameters& encoder = s.rig.rig.flywheel_encoder;
    s.mean.encoder_blind_mps = 2.0 * std::numbers::pi * s.rig.rig.flywheel_radius_m * encoder.slowest_edges_hz / encoder.teeth;
    s.mean.load_base_N = s.rig.rig.load.base_N;
    s.mean.load_lift_Ns2pm2 = s.rig.rig.load.lift_Ns2pm2;
    read_law(root.table("law"), s.rig, s.mean);
    read_sequence({base.root().table("sequence"), root.find_table("sequence")}, s);
    read_limits({base.root().table("limits"), root.find_table("limits")}, s.mean);
    s.files.insert(s.files.end(), s.rig.files.begin(), s.rig.files.end());
    s.mean = plan(s, 0, 0);
    if (const auto t = root.find_table("scatter")) s.scatter = scatter(*t);
    if (const auto t = root.find_table("acceptance")) s.acceptance = declared_bands(*t);
    doc.finish();
    base.finish();
    rig::check(s.mean);
    return s;
}

}  // namespace rig
