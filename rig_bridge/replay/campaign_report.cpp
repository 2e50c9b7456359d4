#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "firmware/host/settings/csv_field.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/replay/campaign_table.hpp"

namespace rig::replay {

namespace {

std::string title(const ManeuverFolder& folder) {
    return folder.attempt == 1 ? fmt::format("{:04}", folder.number) : fmt::format("{:04}.{}", folder.number, folder.attempt);
}

std::string verdict(const CampaignTable& table) {
    return fmt::format("{} maneuvers rebuilt from {} lines; {} differ from {}", table.counted(), table.lines, table.different(),
                       table.with_ledger ? "summaries and ledger" : "summaries (no ledger)");
}

}  // namespace

std::string to_text(const CampaignTable& table) {
    std::string text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{:<10}{:>16}{:>15}{:>12}{:>11}  {}\n", "maneuver", "energy so far", "mean friction", "brake-on", "duration", "outcome");
    fmt::format_to(out, "{:<10}{:>16}{:>15}{:>12}{:>11}\n", "", "MJ", "mu_b", "m/s", "s");
    std::string parts;
    for (const CampaignRow& row : table.rows) {
        if (const std::string now = to_text(row.specimen); now != parts) fmt::format_to(out, "    from here on: {}\n", parts = now);
        if (row.counted)
            fmt::format_to(out, "{:<10}{:>16.4f}{:>15.5f}{:>12.2f}{:>11.3f}  {}\n", title(row.folder), row.summary.cumulative_energy_J * 1e-6,
                           row.summary.figures.mean_friction, row.summary.figures.brake_on_mps, row.summary.figures.duration_s, row.summary.outcome);
        else
            fmt::format_to(out, "{:<10}{:>54}  {}\n", title(row.folder), "", row.summary.outcome);
        for (const std::string& warning : row.summary.warnings) fmt::format_to(out, "    {}\n", warning);
        for (const std::string& difference : row.differences) fmt::format_to(out, "    DIFFERS: {}\n", difference);
    }
    return text + verdict(table) + "\n";
}

std::string to_csv(const CampaignTable& table) {
    std::string csv = "number,attempt,outcome,cumulative_energy_J";
    const auto out = std::back_inserter(csv);
    for (const record::FigureField& field : record::kFigureFields) fmt::format_to(out, ",{}", field.key);
    for (const record::SpecimenField& field : record::kSpecimenFields) fmt::format_to(out, ",{}", field.key);
    csv += ",disc_energy_J\n";
    for (const CampaignRow& row : table.rows) {
        if (!row.counted) continue;
        fmt::format_to(out, "{},{},{},{}", row.folder.number, row.folder.attempt, row.summary.outcome, row.summary.cumulative_energy_J);
        for (const record::FigureField& field : record::kFigureFields) fmt::format_to(out, ",{}", row.summary.figures.*field.value);
        for (const record::SpecimenField& field : record::kSpecimenFields) fmt::format_to(out, ",{}", settings::csv_field(row.specimen.*field.value));
        fmt::format_to(out, ",{}\n", row.disc_energy_J);
    }
    return csv;
}

std::string to_json(const CampaignTable& table, const std::string& campaign) {
    auto rows = nlohmann::ordered_json::array();
    for (const CampaignRow& row : table.rows) {
        nlohmann::ordered_json one{{"number", row.folder.number},
                                   {"attempt", row.folder.attempt},
                                   {"outcome", row.summary.outcome},
                                   {"counted", row.counted},
                                   {"cumulative_energy_J", row.summary.cumulative_energy_J}};
        if (row.counted)
            for (const record::FigureField& field : record::kFigureFields) one[field.key] = row.summary.figures.*field.value;
        for (const record::SpecimenField& field : record::kSpecimenFields) one[field.key] = row.specimen.*field.value;
        one["disc_energy_J"] = row.disc_energy_J;
        one["warnings"] = row.summary.warnings;
        one["differences"] = row.differences;
        rows.push_back(std::move(one));
    }
    const nlohmann::ordered_json root{{"campaign", campaign},
                                      {"version", ANTISKID_VERSION},
                                      {"maneuvers", table.counted()},
                                      {"different", table.different()},
                                      {"with_ledger", table.with_ledger},
                                      {"lines", table.lines},
                                      {"rows", rows}};
    return root.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace rig::replay
