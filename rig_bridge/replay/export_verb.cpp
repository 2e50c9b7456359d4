#include <fmt/core.h>

#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "firmware/can/candump.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/progress.hpp"
#include "rig_bridge/replay/measured_signals.hpp"
#include "rig_bridge/replay/replay_verbs.hpp"
#include "rig_bridge/replay/sample_table.hpp"
#include "rig_bridge/replay/table_writer.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace rig::replay {

namespace {

namespace fs = std::filesystem;

struct ExportCommand {
    std::string log;
    fs::path out;
    std::string interface;
    fs::path config = settings::config_directory();
    fs::path scenario, dbc, binding;
    std::string json;

    int run() const {
        const std::string kind = out.extension().string();
        if (kind != ".csv" && kind != ".mat" && kind != ".log")
            throw UsageError(out.string() + ": the ending says the format; expected .csv, .mat or .log");
        LogWarnings warnings = warnings_of(log);
        settings::Progress progress(100, 0, "%");
        const std::uint64_t count = kind == ".log" ? write_frames(warnings, progress) : write_samples(kind == ".mat", warnings, progress);
        progress.finish();
        const char* const unit = kind == ".log" ? "frames" : "samples";
        if (json != "-") {
            fmt::print("{} {} in {}\n", count, unit, out.string());
            if (warnings.any()) fmt::print("warnings of the log: {}\n", warnings.summary());
        }
        const nlohmann::ordered_json report{
            {"log", log}, {"out", out.string()}, {unit, count}, {"version", ANTISKID_VERSION}, {"warnings", warnings.summary()}};
        settings::deliver(json, report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
        return 0;
    }

    [[nodiscard]] LogOptions options() const {
        LogOptions chosen;
        if (!interface.empty()) chosen.interface = interface;
        return chosen;
    }

    static void show(settings::Progress& progress, std::uint64_t count, const LogReader& reader) {
        constexpr std::uint64_t kEvery = 4096;
        if (count % kEvery == 0) progress.show(std::llround(100.0 * reader.share()));
    }

    std::uint64_t write_samples(bool mat, LogWarnings& warnings, settings::Progress& progress) const {
        const auto layout = configured([&] {
            return antiskid::can::load_layout(dbc.empty() ? config / "antiskid.dbc" : dbc,
                                              binding.empty() ? config / "antiskid_binding.toml" : binding);
        });
        const record::MeterParameters rig = configured([&] {
            const Scenario loaded = load_scenario(scenario.empty() ? config / "scenarios" / "heavy.toml" : scenario, config);
            return meter_parameters(loaded, antiskid::load_controller_config(loaded.controller));
        });
        LogOptions chosen = options();
        chosen.layout = &layout;
        LogReader reader(log, chosen, warnings);
        MeasuredSignals signals(reader, layout, rig.period_s);
        SampleTable table(signals, layout, rig);
        const auto writer = mat ? mat_writer(out, table.columns()) : csv_writer(out, table.columns());
        std::uint64_t count = 0;
        for (std::vector<double> row; table.next(row); show(progress, ++count, reader)) writer->row(row);
        if (signals.restarted())
            fmt::print(stderr, "rig-replay: warning: {}:{}: SYNC numbers begin anew: another recording, which is not read\n", log, reader.lines());
        if (count == 0) throw std::runtime_error(log + ": no sample of a rig in it (see the warnings above, --dbc and --interface)");
        writer->finish();
        return count;
    }

    std::uint64_t write_frames(LogWarnings& warnings, settings::Progress& progress) const {
        LogReader reader(log, options(), warnings);
        PartFile file(out);
        std::ofstream lines(file.part(), std::ios::binary);
        std::array<char, antiskid::can::kCandumpLineMax + 1> text{};
        std::uint64_t count = 0;
        for (LogFrame f; lines && reader.next(f); show(progress, ++count, reader)) {
            const std::size_t length = antiskid::can::format_candump({.time = f.frame.received,
                                                                      .interface = reader.interface(),
                                                                      .frame = f.frame,
                                                                      .extended = f.extended,
                                                                      .remote = f.remote,
                                                                      .error = f.error},
                                                                     text);
            text[length] = '\n';
            lines.write(text.data(), static_cast<std::streamsize>(length) + 1);
        }
        lines.close();
        if (!lines) throw std::runtime_error(out.string() + ": cannot be written");
        if (count == 0) throw std::runtime_error(log + ": no frame in it (see the warnings above and --interface)");
        file.commit();
        return count;
    }
};

}  // namespace

ReplayVerb export_verb(CLI::App& app) {
    const auto c = std::make_shared<ExportCommand>();
    CLI::App* verb = app.add_subcommand("export", "A log's samples for other programs (CSV, MATLAB), or its frames as candump writes them.");
    settings::existing_file(verb->add_option("LOG", c->log, "bus log: candump, Vector ASC or BLF, PEAK TRC, plain or gzip"))->required();
    verb->add_option("--out", c->out, "FILE.csv: a row a sample; FILE.mat: MATLAB v7.3; FILE.log: frames, candump format")
        ->required()
        ->type_name("FILE");
    verb->add_option("--interface", c->interface, "lines of this interface (default: the first in the log)");
    settings::existing_file(
        verb->add_option("--scenario", c->scenario, "teeth and radii: a file of config/scenarios (default: CONFIG/scenarios/heavy.toml)"));
    settings::add_config_directory(*verb, c->config);
    settings::add_layout_files(*verb, c->dbc, c->binding);
    settings::add_json(*verb, c->json, "what was written");
    verb->footer(
        "Examples:\n"
        "  rig-replay export out/landing/bus.log --out landing.csv\n"
        "  rig-replay export night.blf --dbc config/foreign.dbc --binding config/foreign_binding.toml --out night.mat\n"
        "  rig-replay export night.trc --out night.log\n"
        "Exit status: 0 written; 1 the log cannot be read or has no such frames, or the file cannot be written; 2 mistake in command line or "
        "configuration.");
    return {verb, [c] { return c->run(); }};
}

}  // namespace rig::replay
