#include <fmt/core.h>

#include <map>
#include <memory>
#include <utility>

#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"
#include "rig_bridge/replay/campaign_table.hpp"
#include "rig_bridge/replay/replay_verbs.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace rig::replay {

namespace {

namespace fs = std::filesystem;

struct CampaignCommand {
    fs::path folder;
    fs::path ledger;
    fs::path config = settings::config_directory();
    fs::path dbc, binding;
    std::string json, csv;
    std::filesystem::path picture;
    fs::path rebuilt;

    int run() const {
        const antiskid::can::Layout layout = configured([&] { return antiskid::LayoutFiles(config, dbc, binding).load(); });
        const fs::path place = campaign_folder();
        const std::vector<record::Attempt> folders = maneuver_folders(place);
        std::map<std::string, record::MeterParameters> known;
        CampaignSources sources{.layout = layout,
                                .parameters = [&](const std::string& name) { return parameters(known, name); },
                                .ledger = {},
                                .with_ledger = false,
                                .warnings = warnings_of};
        const fs::path file = ledger.empty() ? ledger_in(place.parent_path()) : ledger;
        if (!file.empty()) {
            sources.ledger = record::read_ledger(file, place.filename().string());
            sources.with_ledger = true;
        } else {
            fmt::print(stderr, "rig-replay: warning: no ledger in {}: compared with the summaries only\n", place.parent_path().string());
        }
        const CampaignTable table = rebuild_campaign(folders, sources);
        if (json != "-") fmt::print("{}", to_text(table));
        settings::deliver(json, to_json(table, place.filename().string()));
        settings::deliver(csv, to_csv(table));
        if (!picture.empty()) draw(table);
        if (!rebuilt.empty()) {
            write_ledger(rebuilt, campaign_of(file, place.filename().string(), table), table, sources.ledger);
            fmt::print(stderr, "{}: rebuilt from {} folders\n", rebuilt.string(), table.rows.size());
        }
        return table.different() == 0 ? 0 : 1;
    }

    /// The campaign as in the ledger; without a ledger, as in the summaries.
    [[nodiscard]] static record::Campaign campaign_of(const fs::path& ledger, const std::string& name, const CampaignTable& table) {
        if (!ledger.empty())
            for (const record::Campaign& campaign : record::read_campaigns(ledger))
                if (campaign.name == name) return campaign;
        for (const CampaignRow& row : table.rows)
            if (const record::Summary& s = row.summary; row.ended)
                return {.name = name,
                        .scenario = s.scenario,
                        .seed = s.seed,
                        .planned = table.rows.back().attempt.number,
                        .config_hash = s.config_hash,
                        .version = s.version,
                        .created = s.started};
        throw std::runtime_error(name + ": no maneuver has a summary.json, so nothing is known of the campaign");
    }

    /// Empty: there is none.
    [[nodiscard]] static fs::path ledger_in(const fs::path& directory) {
        const fs::path file = directory / "campaign.sqlite";
        return fs::exists(file) ? file : fs::path();
    }

    /// Folder of the maneuvers: `folder`, or that of the only campaign of the ledger in it.
    [[nodiscard]] fs::path campaign_folder() const {
        fs::path given = fs::absolute(folder / "").parent_path();
        const fs::path inside = ledger_in(given);
        if (inside.empty()) return given;
        const std::vector<record::Campaign> campaigns = record::read_campaigns(inside);
        if (campaigns.size() == 1) return given / campaigns.front().name;
        std::string names;
        for (const record::Campaign& campaign : campaigns) names.append(names.empty() ? "" : ", ").append(campaign.name);
        throw UsageError(fmt::format("{} holds {} campaigns ({}); give the folder of one, like {}", inside.string(), campaigns.size(), names,
                                     (given / "NAME").string()));
    }

    [[nodiscard]] record::MeterParameters parameters(std::map<std::string, record::MeterParameters>& known, const std::string& name) const {
        const auto found = known.find(name);
        if (found != known.end()) return found->second;
        return known[name] = configured([&] {
                   const Scenario scenario = load_scenario(config / "scenarios" / (name + ".toml"), config);
                   return meter_parameters(scenario, antiskid::load_controller_config(scenario.controller));
               });
    }

    void draw(const CampaignTable& table) const {
        pictures::Series points{.style = pictures::Style::points, .colour = pictures::blue};
        for (const CampaignRow& row : table.rows)
            if (row.counted) points.add(row.disc_energy_J * 1e-6, row.summary.figures.mean_friction);
        pictures::draw(
            {.charts = {{.y_label = "mean friction", .x_label = "brake energy of this brake and disc (MJ)", .series = {std::move(points)}}}},
            picture);
    }
};

}  // namespace

ReplayVerb campaign_verb(CLI::App& app) {
    const auto c = std::make_shared<CampaignCommand>();
    CLI::App* verb =
        app.add_subcommand("campaign", "The table of Fig. 7 rebuilt from the raw logs of a campaign, held against summaries and ledger bit by bit.");
    settings::existing_directory(
        verb->add_option("DIRECTORY", c->folder,
                         "folder of the campaign (0001/bus.log or bus.log.gz, 0001/summary.json, ...), or the directory with its ledger"))
        ->required();
    settings::existing_file(verb->add_option("--ledger", c->ledger, "its ledger (default: campaign.sqlite beside the folder)"));
    settings::add_config_directory(*verb, c->config);
    settings::add_layout_files(*verb, c->dbc, c->binding);
    settings::result_file(verb->add_option("--csv", c->csv, "the table with every figure as CSV"));
    settings::add_json(*verb, c->json, "the same");
    settings::result_file(verb->add_option(
        "--rebuild", c->rebuilt, "write a new ledger from the folders, amendments of the old one with it; keep it beside the campaign's folder"));
    settings::add_picture(*verb, c->picture, "mean friction over cumulative energy");
    verb->footer(
        "Examples:\n"
        "  rig-replay campaign out/campaign\n"
        "  rig-replay campaign runs/night --ledger runs/campaign.sqlite --picture fig7.png\n"
        "  rig-replay campaign runs/brake7 --rebuild runs/brake7/rebuilt.sqlite\n"
        "Exit status: 0 equal to summaries and ledger; 1 something differs or cannot be read; 2 mistake in command line or configuration.");
    return {verb, [c] { return c->run(); }};
}

}  // namespace rig::replay
