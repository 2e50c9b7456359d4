#include "rig_bridge/bridge/wear_regulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/json.hpp"
#include "rig_bridge/rig/friction_curve.hpp"
#include "rig_bridge/wear/limit_forecast.hpp"

namespace rig::bridge {

namespace {

using settings::Json;

double kinetic_J(const Scenario& scenario) {
    const rig::Plan& plan = scenario.mean;
    const rig::WheelParameters& wheel = scenario.rig.rig.wheel;
    const double v = plan.speed_mps;
    const double omega = v / scenario.rolling_radius_m(plan.load_base_N - plan.load_lift_Ns2pm2 * v * v);
    return 0.5 * (wheel.mass_kg * v * v + wheel.inertia_kgm2 * omega * omega);
}

/// Whether its energy counts as measured: no warning prevents that, and no person has amended it.
bool sound(const record::LedgerRow& row) {
    return row.counted_J == row.summary.figures.energy_brake_J;
}

wear::Landing landing(const record::LedgerRow& row, double reference, double wear_J) {
    wear::Landing landing{.reference = reference};
    if (row.summary.frames_dropped > 0 || !sound(row)) return landing;
    const record::Figures& figures = row.summary.figures;
    landing.kinetic_J = figures.kinetic_energy_J;
    landing.brake_J = figures.energy_brake_J;
    landing.tyre_J = figures.energy_tyre_J;
    landing.j_mu = figures.j_mu;
    landing.brake_wear_J = wear_J;
    return landing;
}

wear::WearPlan plan_of(const wear::RegulationConfig& config, const Scenario& scenario) {
    if (scenario.mean.law != rig::BrakeLaw::slip)
        throw settings::Error(scenario.files.front().string(), 0, "law.law",
                              "--regulate moves the slip reference, which this law has not; expected \"slip\"");
    const double energy_J = kinetic_J(scenario);
    const double deviation_J = 2.0 * scenario.scatter.speed_mps / scenario.mean.speed_mps * energy_J;
    return wear::plan_of(config, scenario.rig.wear.life_J, energy_J, deviation_J);
}

}  // namespace

WearRegulation::WearRegulation(const wear::RegulationConfig& config, const Scenario& scenario)
    : plan_(plan_of(config, scenario)),
      rules_(config.rules),
      lining_(plan_.brake_life_J, config.deviations.brake, config.deviations.inspection),
      tread_(plan_.tyre_life_J, config.deviations.tyre, config.deviations.inspection),
      friction_curve_(scenario.rig.rig.friction_curve),
      drop_out_mps_(scenario.rig.drop_out_mps) {
    try {
        range_ = config.range(scenario.choice.road());
        static_cast<void>(wear::Regulator(plan_, rules_, range_));
    } catch (const std::invalid_argument& e) {
        throw settings::Error(config.files.front().string(), 0, "", e.what());
    }
    if (config.forecast_widest > 0.0)
        life_forecast_.emplace(wear::forecast_model(scenario.rig.wear), scenario.rig.wear, config.forecast_widest * plan_.brake_budget_J());
}

wear::Regulator WearRegulation::after(const std::vector<record::LedgerRow>& rows) const {
    wear::Regulator regulator(plan_, rules_, range_);
    wear::LifeReadings lining = lining_, tread = tread_;
    std::optional<wear::LifeForecast> life_forecast = life_forecast_;
    auto finished = static_cast<std::size_t>(
        std::count_if(rows.begin(), rows.end(), [](const record::LedgerRow& row) { return row.state == record::RowState::finished; }));
    bool counted = true;  // the ledger's cumulative energy has every maneuver so far
    for (const record::LedgerRow& row : rows) {
        const record::Figures& figures = row.summary.figures;
        const bool known = std::isfinite(row.counted_J) && (sound(row) || !row.amendments.empty());
        counted = counted && (known || !row.has_figures);
        if (row.has_figures && row.state != record::RowState::finished) {
            if (known) regulator.spent(row.counted_J, figures.energy_tyre_J);
        } else if (row.state == record::RowState::finished) {
            counted = counted && row.summary.frames_dropped == 0 && std::isfinite(row.summary.cumulative_energy_J);
            regulator.after(landing(row, row.slip_reference, counted ? plan_.brake_taken_J + row.summary.cumulative_energy_J : wear::kUnknown));
            --finished;
            if (life_forecast && regulator.last_reading() == wear::Reading::measured) {
                life_forecast->learn(regulator.brake_used_J(),
                                     rig::mean_of_measured(friction_curve_, figures.mean_friction, drop_out_mps_ / figures.brake_on_mps));
                if (const auto life_J = finished < kForecasts ? life_forecast->life_J() : std::nullopt) regulator.revise_brake_life(*life_J);
            }
        }
        if (std::isfinite(row.worn.lining)) {
            lining.read(regulator.brake_used_J(), row.worn.lining);
            regulator.revise_brake_life(lining.life_J());
            life_forecast.reset();  // an inspection is worth many times as much
        }
        if (std::isfinite(row.worn.tread) && row.summary.specimen.tyre == rows.front().summary.specimen.tyre) {
            tread.read(regulator.tyre_used_J(), row.worn.tread);
            regulator.revise_tyre_life(tread.life_J());
        }
    }
    return regulator;
}

std::string line(const wear::Regulator& r) {
    const wear::LimitForecast o = wear::limit_forecast(r);
    const std::string measured = std::isfinite(r.measured_share()) ? fmt::format("{:.3f} measured", r.measured_share()) : "none measured";
    std::string text = fmt::format("slip reference {:.3f}; tyre share {}, {:.3f} wanted; limits at landing {:.0f} (brake), {:.0f} (tyre) of {}",
                                   r.reference(), measured, o.required_share, o.brake.landing, o.tyre.landing, r.plan().landings);
    if (o.verdict != wear::Feasibility::together) text += fmt::format("; {}", wear::name(o.verdict));
    if (r.missed() > 0) text += fmt::format("; {} without measurement ({})", r.missed(), wear::name(r.last_reading()));
    return text;
}

void write_regulation(const std::filesystem::path& file, const wear::Regulator& r) {
    const wear::LimitForecast o = wear::limit_forecast(r);
    const Json json{{"line", line(r)},
                    {"prediction", wear::sentence(o, r.plan())},
                    {"verdict", wear::name(o.verdict)},
                    {"slip_reference", r.reference()},
                    {"lowest_reference", r.range().lowest},
                    {"highest_reference", r.range().highest},
                    {"required_share", o.required_share},
                    {"measured_share", r.measured_share()},
                    {"brake_life_J", r.plan().brake_life_J},
                    {"brake_left_J", r.brake_left_J()},
                    {"tyre_left_J", r.tyre_left_J()},
                    {"landings", r.landings()},
                    {"planned_landing", r.plan().landings},
                    {"brake_limit_landing", o.brake.landing},
                    {"brake_limit_deviation", o.brake.deviation},
                    {"tyre_limit_landing", o.tyre.landing},
                    {"tyre_limit_deviation", o.tyre.deviation},
                    {"missed", r.missed()}};
    settings::write_file(file, settings::json_page(json));
}

}  // namespace rig::bridge
