#include <fmt/core.h>

#include <memory>
#include <utility>

#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/progress.hpp"
#include "rig_bridge/record/specimen_options.hpp"
#include "rig_bridge/replay/importer.hpp"
#include "rig_bridge/replay/replay_verbs.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace rig::replay {

namespace {

namespace fs = std::filesystem;

std::string as_json(const ImportReport& report, const std::string& config_hash) {
    auto maneuvers = settings::Json::array();
    for (const ImportedManeuver& m : report.maneuvers)
        maneuvers.push_back({{"folder", m.folder.string()},
                             {"first_row", m.first_row},
                             {"outcome", m.outcome},
                             {"brake_on_mps", m.figures.brake_on_mps},
                             {"duration_s", m.figures.duration_s},
                             {"energy_brake_J", m.figures.energy_brake_J},
                             {"mean_friction", m.figures.mean_friction}});
    const settings::Json root{
        {"rows", report.rows}, {"version", ANTISKID_VERSION}, {"config_hash", config_hash}, {"maneuvers", std::move(maneuvers)}};
    return settings::json_page(root);
}

struct ImportCommand {
    fs::path file, map, out;
    fs::path config = settings::config_directory();
    fs::path dbc, binding;
    record::Specimen specimen;
    std::string json;

    int run() const {
        configured([&] { record::check_texts(specimen); });
        const antiskid::LayoutFiles layout_files(config, dbc, binding);
        const auto layout = configured([&] { return layout_files.load(); });
        const ImportMap loaded = configured([&] { return load_import_map(map); });
        const Scenario scenario = configured([&] { return load_scenario(config / "scenarios" / (loaded.scenario + ".toml"), config); });
        std::vector<fs::path> files = scenario.files;
        files.insert(files.end(), {layout_files.dbc, layout_files.binding, map});
        files.insert(files.end(), loaded.layout_files.begin(), loaded.layout_files.end());
        const std::string hash = settings::hash(files);
        const record::MeterParameters meter =
            configured([&] { return meter_parameters(scenario, antiskid::load_controller_config(scenario.controller)); });
        const bool with_valve = loaded.channels[static_cast<std::size_t>(Channel::valve_current)].has_value();
        settings::Progress progress(100, 0, "%");
        const ImportSettings settings{.file = file,
                                      .map = loaded,
                                      .out = fs::absolute(out / "").parent_path(),
                                      .rig = {.layout = layout, .meter = meter, .plan = scenario.mean, .with_valve = with_valve, .number = 0},
                                      .specimen = specimen,
                                      .config_hash = hash,
                                      .progress = [&progress](double share) { progress.show(static_cast<std::int64_t>(99.0 * share)); }};
        ImportNotes notes(file.string(), [](const std::string& text) { fmt::print(stderr, "rig-replay: warning: {}\n", text); });
        const ImportReport report = import_recording(settings, notes);
        progress.finish();
        std::string table;
        for (const ImportedManeuver& m : report.maneuvers)
            table += fmt::format("{}  row {:>9}  {:6.2f} m/s  {:7.3f} s  {:8.1f} kJ  mu_b {:.4f}  {}\n", m.folder.string(), m.first_row,
                                 m.figures.brake_on_mps, m.figures.duration_s, m.figures.energy_brake_J * 1e-3, m.figures.mean_friction, m.outcome);
        table += fmt::format("{} rows, {} maneuvers", report.rows, report.maneuvers.size());
        for (const auto& [kind, count] : notes.counts()) table += fmt::format(", {} {}", kind, count);
        if (!report.log_troubles.empty()) table += ", " + report.log_troubles;
        if (json != "-") fmt::print("{}\n", table);
        settings::deliver(json, as_json(report, hash));
        if (report.maneuvers.empty())
            throw std::runtime_error(file.string() +
                                     ": no braking found: no row with the pressure rising above brake_on_Pa at min_speed_mps or more");
        return 0;
    }
};

}  // namespace

ReplayVerb import_verb(CLI::App& app) {
    const auto c = std::make_shared<ImportCommand>();
    CLI::App* verb =
        app.add_subcommand("import", "Recordings of other systems (CSV, MATLAB, logs of CAN frames) as maneuver folders with logs of our layout.");
    settings::existing_file(
        verb->add_option("FILE", c->file,
                         "the recording: CSV, .mat, or a log of frames: Vector ASC or BLF, PEAK TRC, candump; text and logs plain or gzip"))
        ->required();
    settings::existing_file(verb->add_option("--map", c->map, "which column is what, in which unit; where a maneuver begins and ends (TOML)"))
        ->required();
    settings::add_out(*verb, c->out, "folder of the campaign to make: 0001/bus.log, 0001/summary.json, ...")->required();
    settings::add_config_directory(*verb, c->config);
    settings::add_json(*verb, c->json, "maneuvers");
    settings::add_layout_files(*verb, c->dbc, c->binding);
    record::add_specimen_options(*verb, c->specimen, ", of every maneuver in the recording");
    verb->footer(
        "config/import_example.toml is a map of a table with every key explained, config/import_bus_example.toml one of a log of frames.\n"
        "Examples:\n"
        "  rig-replay import night.csv --map config/import_example.toml --out out/night --brake B12 --disc D7 --operator 'A. Rossi'\n"
        "  rig-replay import night.blf --map config/import_bus_example.toml --out out/night\n"
        "  rig-replay campaign out/night\n"
        "Exit status: 0 maneuvers written (warnings say what was wrong in the recording); 1 it cannot be read, a unit cannot be right, or\nthere is "
        "no braking in it; 2 mistake in command line, map or configuration.");
    return {verb, [c] { return c->run(); }};
}

}  // namespace rig::replay
