#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <utility>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/lab/campaign_options.hpp"
#include "plant_sim/lab/verbs.hpp"

namespace plant_sim::lab {

namespace {

std::string as_json(const wear::Campaign& data) {
    auto rows = settings::Json::array();
    for (std::size_t i = 0; i < data.points.size(); ++i)
        rows.push_back({{"mean_friction", data.points[i].mean_friction},
                        {"brake_energy_J", wear::brake_energy_J(data, i)},  // null where it is unknown
                        {"cumulative_energy_J", data.points[i].c_e_J}});
    const settings::Json table{
        {"source", data.source}, {"data_hash", wear::data_hash(data)}, {"version", ANTISKID_VERSION}, {"maneuvers", std::move(rows)}};
    return settings::json_page(table);
}

struct TableCommand {
    CampaignOptions from;
    std::string csv, json_file;

    int run() const {
        const wear::Campaign data = from.load();
        if (csv != "-" && json_file != "-") {
            auto table = settings::TextTable::screen("maneuver:>8|mean_friction:>15.5f|brake_energy_MJ:>18|cumulative_energy_MJ:>24.4f");
            for (std::size_t i = 0; i < data.points.size(); ++i) {
                const double energy_J = wear::brake_energy_J(data, i);
                table.add(i + 1, data.points[i].mean_friction, std::isnan(energy_J) ? "unknown" : fmt::format("{:.4f}", energy_J * 1e-6),
                          data.points[i].c_e_J * 1e-6);
            }
            fmt::print("{}{} maneuvers of {}, data hash {}\n", table.text(), data.points.size(), data.source, wear::data_hash(data));
        }
        settings::deliver(csv, wear::to_csv(data));
        settings::deliver(json_file, as_json(data));
        return 0;
    }
};

}  // namespace

LabVerb wear_table_verb(CLI::App& wear) {
    const auto table = std::make_shared<TableCommand>();
    CLI::App* verb =
        wear.add_subcommand("table", "Mean friction by eq. (7), brake energy by eq. (9) and cumulative energy of every maneuver of a campaign.");
    table->from
        .add_to(*verb,
                "ledger, directory with campaign.sqlite, or CSV with the columns cumulative_energy_MJ (or cumulative_energy_J) and mean_friction")
        ->required();
    settings::result_file(verb->add_option("--csv", table->csv, "the table, exact; - for standard output instead"));
    settings::add_json(*verb, table->json_file, "the table");
    verb->footer("Examples:\n  rig-lab wear table out/endurance\n  rig-lab wear table measured.csv --csv -");
    return {verb, [table] { return table->run(); }};
}

}  // namespace plant_sim::lab
