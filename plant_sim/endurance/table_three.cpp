#include "plant_sim/endurance/table_three.hpp"

#include <fmt/core.h>

#include <cmath>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/settings.hpp"

namespace endurance {

TableThree printed_table(const std::filesystem::path& config) {
    const auto doc = settings::Document::load(config / "flywheel_rig.toml");
    const settings::Table t = doc.root().table("endurance");
    TableThree table;
    for (std::size_t i = 0; i < kQuantities; ++i) {
        table[i] = {.mean = t.number(kTableThree[i].mean_key, {.min = 1e-3}), .deviation = t.number(kTableThree[i].deviation_key, {.min = 1e-6})};
    }
    return table;
}

TableThree measured_table(std::span<const rig::record::Summary> maneuvers) {
    TableThree table;
    const auto n = static_cast<double>(maneuvers.size());
    if (maneuvers.empty()) return table;
    for (std::size_t i = 0; i < kQuantities; ++i) {
        const auto figure = kTableThree[i].figure;
        double sum = 0.0;
        for (const rig::record::Summary& m : maneuvers) sum += m.figures.*figure;
        table[i].mean = sum / n;
        double squares = 0.0;
        for (const rig::record::Summary& m : maneuvers) {
            const double off = m.figures.*figure - table[i].mean;
            squares += off * off;
        }
        if (n > 1.0) table[i].deviation = std::sqrt(squares / (n - 1.0));
    }
    return table;
}

std::string to_text(const TableThree& measured, const std::optional<TableThree>& printed) {
    std::string text =
        printed ? "                    Table III            measured             mean off by      std. dev.\n" : "                    measured\n";
    for (std::size_t i = 0; i < kQuantities; ++i) {
        const Quantity& q = kTableThree[i];
        const Distribution& m = measured[i];
        text += fmt::format("  {:<9} {:<5}", q.name, q.unit);
        if (printed) {
            const Distribution& p = (*printed)[i];
            text += fmt::format("{:>9.2f} +- {:<7.2f}{:>9.2f} +- {:<7.2f}{:>+6.2f} std. dev. {:>8.2f} x\n", p.mean, p.deviation, m.mean, m.deviation,
                                (m.mean - p.mean) / p.deviation, m.deviation / p.deviation);
        } else {
            text += fmt::format("{:>9.2f} +- {:<7.2f}\n", m.mean, m.deviation);
        }
    }
    return text;
}

std::string to_json(const CampaignFacts& facts, std::span<const rig::record::Summary> maneuvers, const std::optional<TableThree>& printed) {
    const TableThree measured = measured_table(maneuvers);
    settings::Json quantities;
    for (std::size_t i = 0; i < kQuantities; ++i) {
        settings::Json q{{"mean", measured[i].mean}, {"deviation", measured[i].deviation}};
        if (printed) {
            q["printed_mean"] = (*printed)[i].mean;
            q["printed_deviation"] = (*printed)[i].deviation;
        }
        quantities[kTableThree[i].key] = std::move(q);
    }
    settings::Json json{{"scenario", facts.scenario},    {"seed", facts.seed},
                        {"version", facts.version},      {"config_hash", facts.config_hash},
                        {"maneuvers", maneuvers.size()}, {"quantities", std::move(quantities)}};
    if (!maneuvers.empty()) {
        json["cumulative_energy_J"] = maneuvers.back().cumulative_energy_J;
        json["first_mean_friction"] = maneuvers.front().figures.mean_friction;
        json["last_mean_friction"] = maneuvers.back().figures.mean_friction;
    }
    return settings::json_page(json);
}

}  // namespace endurance
