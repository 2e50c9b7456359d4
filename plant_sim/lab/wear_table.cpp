#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <memory>

#include "plant_sim/lab/campaign_source.hpp"
#include "plant_sim/lab/wear.hpp"

namespace plant_sim {

namespace {

struct TableCommand {
    std::filesystem::path source;
    std::string campaign;
    OutOfTolerance off = OutOfTolerance::left_out;
    std::string csv;

    int run() const {
        const wear::Campaign data = load_campaign(source, campaign, off);
        if (csv != "-") {
            std::string table = fmt::format("{:>8}{:>15}{:>18}{:>24}\n", "maneuver", "mean_friction",
                                            "brake_energy_MJ", "cumulative_energy_MJ");
            for (std::size_t i = 0; i < data.points.size(); ++i) {
                const double energy_J = wear::brake_energy_J(data, i);
                fmt::format_to(std::back_inserter(table), "{:>8}{:>15.5f}{:>18}{:>24.4f}\n", i + 1,
                               data.points[i].mean_friction,
                               std::isnan(energy_J) ? "unknown" : fmt::format("{:.4f}", energy_J * 1e-6),
                               data.points[i].c_e_J * 1e-6);
            }
            fmt::print("{}{} maneuvers of {}, data hash {}\n", table, data.points.size(), data.source,
                       wear::data_hash(data));
        }
        if (!csv.empty()) deliver(csv, wear::to_csv(data));
        return 0;
    }
};

}  // namespace

LabVerb wear_table_verb(CLI::App& wear) {
    const auto table = std::make_shared<TableCommand>();
    CLI::App* verb = wear.add_subcommand("table",
                                         "Mean friction by eq. (7), brake energy by eq. (9) and cumulative "
                                         "energy of every maneuver of a campaign.");
    verb->add_option("SOURCE", table->source,
                     "ledger, directory with ledger.sqlite, or CSV with the columns cumulative_energy_MJ (or "
                     "cumulative_energy_J) and mean_friction")
        ->required()
        ->check(CLI::ExistingPath);
    verb->add_option("--campaign", table->campaign, "which of a ledger's campaigns; may be left out for one");
    add_out_of_tolerance_flag(*verb, table->off);
    verb->add_option("--csv", table->csv, "the table as CSV, exact: a file, or - for standard output");
    verb->footer("Examples:\n  rig-lab wear table out/endurance\n  rig-lab wear table measured.csv --csv -");
    return {verb, [table] { return table->run(); }};
}

}  // namespace plant_sim
