#include "rig_bridge/bridge/status.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <vector>

#include "firmware/host/settings/command_line.hpp"
#include "firmware/host/settings/json.hpp"
#include "rig_bridge/bridge/hold.hpp"
#include "rig_bridge/bridge/verbs.hpp"
#include "rig_bridge/bridge/view.hpp"
#include "rig_bridge/bridge/wear_regulation.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace rig::bridge {

namespace {

struct Spread {
    double mean = 0.0;
    double deviation = 0.0;  ///< of a sample: n - 1
};

Spread spread(const std::vector<record::LedgerRow>& rows, double record::Figures::*value) {
    Spread s;
    double n = 0.0;
    double squares = 0.0;  // Welford
    for (const record::LedgerRow& row : rows) {
        if (row.state != record::RowState::finished) continue;
        const double x = row.summary.figures.*value;
        n += 1.0;
        const double before = s.mean;
        s.mean += (x - before) / n;
        squares += (x - before) * (x - s.mean);
    }
    if (n > 1.0) s.deviation = std::sqrt(squares / (n - 1.0));
    return s;
}

std::int64_t count(const std::vector<record::LedgerRow>& rows, record::RowState state) {
    return std::count_if(rows.begin(), rows.end(), [state](const record::LedgerRow& row) { return row.state == state; });
}

/// Of a maneuver whose bridge is dead: the next one settles it.
constexpr const char* kLeft = "left";

/// A campaign as its ledger has it, and whether a bridge runs it.
struct LedgerState {
    std::vector<record::LedgerRow> rows;
    bool held = false;

    [[nodiscard]] const char* state(const record::LedgerRow& row) const {
        return row.state == record::RowState::running && !held ? kLeft : name(row.state);
    }
    [[nodiscard]] double cumulative_energy_J() const {
        const auto newest = std::find_if(rows.rbegin(), rows.rend(), [](const record::LedgerRow& row) { return row.has_figures; });
        return newest == rows.rend() ? 0.0 : newest->summary.cumulative_energy_J;
    }
};

LedgerState ledger_state_of(const std::filesystem::path& ledger, const std::string& campaign) {
    return {.rows = record::read_ledger(ledger, campaign), .held = record::is_held(ledger)};
}

/// What the bridge left beside the ledger; null where the campaign is not regulated.
settings::Json regulation_of(const std::filesystem::path& ledger, const std::string& campaign) {
    std::ifstream in(regulation_file(ledger.parent_path(), campaign), std::ios::binary);
    if (!in) return nullptr;
    auto json = settings::Json::parse(in, nullptr, false);
    return json.is_object() && json.contains("line") && json["line"].is_string() ? json : settings::Json();
}

std::string row_text(const record::LedgerRow& row, const char* state) {
    const record::Figures& f = row.summary.figures;
    std::string text = fmt::format("  {:>6} {:>7}  {:<10} {:<20}", row.attempt.number, row.attempt.attempt, state, row.summary.started);
    if (row.state == record::RowState::finished)
        text += fmt::format(" {:8.2f} {:8.2f} {:8.1f} {:9.1f} {:8.4f} {:10.3f} {:>6}  {}", f.brake_on_mps, f.duration_s, f.length_m, f.mean_torque_Nm,
                            f.mean_friction, row.summary.cumulative_energy_J * 1e-6,
                            std::isfinite(row.slip_reference) ? fmt::format("{:.3f}", row.slip_reference) : "-",
                            name(row.health.state) + std::string(record::off_conditions(row.summary) ? "  out_of_tolerance" : ""));
    else if (row.state == record::RowState::aborted)
        text += " " + row.summary.outcome;
    text += "\n";
    for (const std::string& warning : row.summary.warnings) text += "          " + warning + "\n";
    for (const record::Note& n : row.notes) text += fmt::format("          {}: {}, says {}, {}\n", n.field, n.text, n.who, n.made);
    for (const record::Amendment& a : row.amendments)
        text += fmt::format("          counts {:.3f} MJ, says {}, {}: {}\n", a.counted_J * 1e-6, a.who, a.made, a.why);
    return text;
}

std::string campaign_text(const record::Campaign& campaign, const LedgerState& ledger_state) {
    constexpr std::size_t kShown = 10;
    const std::vector<record::LedgerRow>& rows = ledger_state.rows;
    const std::int64_t finished = count(rows, record::RowState::finished);
    std::string text =
        fmt::format("campaign {}: scenario {}, seed {}, {} of {} maneuvers finished; {} aborted, {} unfinished, {} {}; {:.3f} MJ\n", campaign.name,
                    campaign.scenario, campaign.seed, finished, campaign.planned, count(rows, record::RowState::aborted),
                    count(rows, record::RowState::unfinished), count(rows, record::RowState::running),
                    ledger_state.held ? name(record::RowState::running) : "left by a dead bridge", ledger_state.cumulative_energy_J() * 1e-6);
    if (const std::string specimen = to_text(campaign.specimen); !specimen.empty()) text += "  " + specimen + "\n";
    if (finished > 0) {
        text += fmt::format("  {:<24} {:>14} {:>14}\n", "of those finished", "mean", "deviation");
        for (const record::FigureField& field : record::kFigureFields) {
            const Spread s = spread(rows, field.value);
            text += fmt::format("  {:<24} {:>14.4f} {:>14.4f} {}\n", field.label, s.mean * field.scale, s.deviation * field.scale, field.unit);
        }
    }
    if (rows.empty()) return text;
    const auto judged = std::find_if(rows.rbegin(), rows.rend(), [](const record::LedgerRow& row) { return !row.health.model.empty(); });
    if (judged != rows.rend()) text += fmt::format("  brake after maneuver {}: {}\n", judged->attempt.number, health_text(judged->health));
    text += fmt::format("  {:>6} {:>7}  {:<10} {:<20} {:>8} {:>8} {:>8} {:>9} {:>8} {:>10} {:>6}  {}\n", "number", "attempt", "state", "started",
                        "m/s", "s", "m", "N m", "mu_b", "MJ in all", "slip", "brake");
    for (std::size_t i = rows.size() - std::min(rows.size(), kShown); i < rows.size(); ++i) {
        const record::Specimen& is = rows[i].summary.specimen;
        if (i > 0 && is != rows[i - 1].summary.specimen) text += fmt::format("          from here on: {}\n", to_text(is));
        text += row_text(rows[i], ledger_state.state(rows[i]));
    }
    return text;
}

}  // namespace

std::string status_text(const std::filesystem::path& ledger) {
    std::string text;
    if (const auto hold = read_hold(ledger.parent_path())) text += to_text(*hold) + "\n";
    for (const record::Campaign& campaign : record::read_campaigns(ledger)) {
        text += campaign_text(campaign, ledger_state_of(ledger, campaign.name));
        if (const auto regulation = regulation_of(ledger, campaign.name); regulation.is_object())
            text += fmt::format("  regulation: {}\n", regulation["line"].get<std::string>());
    }
    return text;
}

std::string status_json(const std::filesystem::path& ledger) {
    settings::Json campaigns = settings::Json::array();
    for (const record::Campaign& campaign : record::read_campaigns(ledger)) {
        const LedgerState ledger_state = ledger_state_of(ledger, campaign.name);
        const std::vector<record::LedgerRow>& rows = ledger_state.rows;
        settings::Json one{{"name", campaign.name},       {"scenario", campaign.scenario},       {"seed", campaign.seed},
                           {"planned", campaign.planned}, {"config_hash", campaign.config_hash}, {"version", campaign.version}};
        for (const record::SpecimenField& field : record::kSpecimenFields) one[field.key] = campaign.specimen.*field.value;
        const auto hold = read_hold(ledger.parent_path());
        one["hold"] = hold ? settings::Json{{"who", hold->who}, {"since", hold->since}, {"why", hold->why}} : settings::Json(nullptr);
        for (const record::RowState state : {record::RowState::finished, record::RowState::aborted, record::RowState::unfinished})
            one[name(state)] = count(rows, state);
        const std::int64_t begun = count(rows, record::RowState::running);
        one[name(record::RowState::running)] = ledger_state.held ? begun : 0;
        one[kLeft] = ledger_state.held ? 0 : begun;
        one["cumulative_energy_J"] = ledger_state.cumulative_energy_J();
        auto list = settings::Json::array();
        for (const record::LedgerRow& row : rows) {
            settings::Json entry{{"number", row.attempt.number},     {"attempt", row.attempt.attempt},
                                 {"state", ledger_state.state(row)}, {"started", row.summary.started},
                                 {"outcome", row.summary.outcome},   {"cumulative_energy_J", row.summary.cumulative_energy_J}};
            for (const record::FigureField& field : record::kFigureFields) entry[field.key] = row.summary.figures.*field.value;
            if (std::isfinite(row.slip_reference)) entry["slip_reference"] = row.slip_reference;
            entry["out_of_tolerance"] = row.summary.out_of_tolerance ? settings::Json(*row.summary.out_of_tolerance) : settings::Json(nullptr);
            entry["warnings"] = row.summary.warnings;
            for (const record::SpecimenField& field : record::kSpecimenFields) entry[field.key] = row.summary.specimen.*field.value;
            auto notes = settings::Json::array();
            for (const record::Note& n : row.notes) notes.push_back({{"field", n.field}, {"text", n.text}, {"who", n.who}, {"made", n.made}});
            entry["noted"] = std::move(notes);
            if (!row.amendments.empty()) {
                auto amendments = settings::Json::array();
                for (const record::Amendment& a : row.amendments)
                    amendments.push_back({{"counted_J", a.counted_J}, {"who", a.who}, {"made", a.made}, {"why", a.why}});
                entry["amendments"] = std::move(amendments);
            }
            entry["health"] = name(row.health.state);
            if (!row.health.model.empty()) {
                entry["health_statistic"] = row.health.statistic;
                entry["health_reason"] = row.health.reason;
                entry["health_model"] = row.health.model;
            }
            list.push_back(std::move(entry));
        }
        one["regulation"] = regulation_of(ledger, campaign.name);
        one["maneuvers"] = std::move(list);
        campaigns.push_back(std::move(one));
    }
    return settings::json_page(campaigns);
}

int show_status(const StatusCommand& command) {
    const auto file = ledger_file(command.directory);
    if (command.json != "-") fmt::print("{}", status_text(file));
    if (!command.json.empty()) settings::deliver(command.json, status_json(file));
    return 0;
}

}  // namespace rig::bridge
