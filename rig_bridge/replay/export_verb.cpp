#include <fcntl.h>
#include <fmt/format.h>
#include <matio.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "firmware/can/candump.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/file_descriptor.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/progress.hpp"
#include "rig_bridge/replay/measured_signals.hpp"
#include "rig_bridge/replay/replay_verbs.hpp"
#include "rig_bridge/replay/sample_table.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace rig::replay {

namespace {

namespace fs = std::filesystem;

/// A file that gets its final name by commit(); before that, and after a failure, an existing file of that name is unchanged.
class PartFile {
  public:
    explicit PartFile(const fs::path& path) : name_(path.string()), part_(path.string() + ".part") {
        if (path.has_parent_path()) fs::create_directories(path.parent_path());
    }
    ~PartFile() {
        std::error_code ignored;
        fs::remove(part_, ignored);
    }
    PartFile(const PartFile&) = delete;
    PartFile& operator=(const PartFile&) = delete;

    [[nodiscard]] const std::string& name() const { return name_; }
    /// Where to write.
    [[nodiscard]] const std::string& part() const { return part_; }
    /// Throws std::filesystem::filesystem_error.
    void commit() const {
        const settings::FileDescriptor file(::open(part_.c_str(), O_RDONLY | O_CLOEXEC));
        if (!file.is_open() || ::fsync(file.get()) != 0)
            throw fs::filesystem_error("cannot be stored", part_, std::error_code(errno, std::generic_category()));
        fs::rename(part_, name_);
    }

  private:
    std::string name_, part_;
};

/// Writes a table of any length in constant memory; the file appears only when complete.
class TableWriter {
  public:
    virtual ~TableWriter() = default;
    /// Writes one number per column. row() and finish() throw std::runtime_error naming the file if it cannot be written.
    virtual void row(const std::vector<double>& values) = 0;
    virtual void finish() = 0;
};

/// One row of names, commas, decimal points; readable by PlotJuggler, pandas and spreadsheets.
class CsvWriter final : public TableWriter {
  public:
    CsvWriter(const fs::path& path, const std::vector<std::string>& columns) : file_(path), out_(file_.part(), std::ios::binary) {
        out_ << fmt::format("{}\n", fmt::join(columns, ","));
        check();
    }

    void row(const std::vector<double>& values) override {
        line_.clear();
        // Times in microseconds, as in a log; the other values had 32 bits.
        fmt::format_to(std::back_inserter(line_), "{:.6f}", values.front());
        for (std::size_t i = 1; i < values.size(); ++i) fmt::format_to(std::back_inserter(line_), ",{:.7g}", values[i]);
        line_.push_back('\n');
        out_.write(line_.data(), static_cast<std::streamsize>(line_.size()));
        check();
    }

    void finish() override {
        out_.close();
        check();
        file_.commit();
    }

  private:
    void check() const {
        if (!out_) throw std::runtime_error(file_.name() + ": cannot be written: " + std::strerror(errno));
    }

    PartFile file_;
    std::ofstream out_;
    fmt::memory_buffer line_;
};

struct CloseMat {
    void operator()(mat_t* file) const { Mat_Close(file); }
};

/// MATLAB v7.3: a column vector of each name.
class MatWriter final : public TableWriter {
  public:
    MatWriter(const fs::path& path, std::vector<std::string> columns)
        : file_(path), columns_(std::move(columns)), blocks_(columns_.size()), mat_(Mat_CreateVer(file_.part().c_str(), nullptr, MAT_FT_MAT73)) {
        if (!mat_) throw std::runtime_error(file_.name() + ": cannot be written");
    }

    void row(const std::vector<double>& values) override {
        constexpr std::size_t kRowsInMemory = 16384;
        for (std::size_t i = 0; i < blocks_.size(); ++i) blocks_[i].push_back(values[i]);
        if (blocks_.front().size() == kRowsInMemory) flush();
    }

    void finish() override {
        if (!blocks_.front().empty()) flush();
        if (Mat_Close(mat_.release()) != 0) fail();
        file_.commit();
    }

  private:
    void flush() {
        for (std::size_t i = 0; i < blocks_.size(); ++i) {
            std::array<std::size_t, 2> size{blocks_[i].size(), 1};
            matvar_t* const column =
                Mat_VarCreate(columns_[i].c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), blocks_[i].data(), MAT_F_DONT_COPY_DATA);
            const int status = Mat_VarWriteAppend(mat_.get(), column, MAT_COMPRESSION_ZLIB, 1);
            Mat_VarFree(column);
            if (status != 0) fail();
            blocks_[i].clear();
        }
    }
    [[noreturn]] void fail() const { throw std::runtime_error(file_.name() + ": cannot be written; is the disk full?"); }

    PartFile file_;
    std::vector<std::string> columns_;
    std::vector<std::vector<double>> blocks_;
    std::unique_ptr<mat_t, CloseMat> mat_;
};

struct ExportCommand {
    std::string log;
    fs::path csv, mat, candump, parquet;
    std::string interface;
    fs::path config = settings::config_directory();
    fs::path scenario, dbc, binding;
    std::string json;

    int run() const {
        if (!parquet.empty()) throw UsageError(how_to_make_parquet());
        if (csv.empty() && mat.empty() && candump.empty()) throw UsageError("nothing to write: expected --csv, --mat or --candump");
        LogWarnings warnings = warnings_of(log);
        settings::Json report{{"log", log}, {"version", ANTISKID_VERSION}};
        if (!csv.empty() || !mat.empty()) report["samples"] = write_samples(warnings);
        if (!candump.empty()) report["frames"] = write_frames(warnings);
        report["warnings"] = warnings.summary();
        if (json != "-") {
            for (const char* const unit : {"samples", "frames"})
                if (report.contains(unit)) fmt::print("{} {}\n", report[unit].get<std::uint64_t>(), unit);
            if (warnings.any()) fmt::print("warnings of the log: {}\n", warnings.summary());
        }
        settings::deliver(json, settings::json_page(report));
        return 0;
    }

    [[nodiscard]] std::string how_to_make_parquet() const {
        const std::string table = (csv.empty() ? fs::path(parquet).replace_extension(".csv") : csv).string();
        return fmt::format(
            "{0}: Parquet is not written, since Debian 12 has no library for it; export --csv {1}, and where pandas and pyarrow are: "
            "python3 -c \"import pandas; pandas.read_csv('{1}').to_parquet('{0}')\"",
            parquet.string(), table);
    }

    [[nodiscard]] LogOptions options() const {
        LogOptions chosen;
        if (!interface.empty()) chosen.interface = interface;
        return chosen;
    }

    static void show(settings::Progress& progress, std::uint64_t count, const LogReader& reader) {
        constexpr std::uint64_t kEvery = 4096;
        if (count % kEvery == 0) progress.show(static_cast<std::int64_t>(99.0 * reader.share()));
    }

    std::uint64_t write_samples(LogWarnings& warnings) const {
        const auto layout = configured([&] { return antiskid::LayoutFiles(config, dbc, binding).load(); });
        const record::MeterParameters rig = configured([&] {
            const Scenario loaded = load_scenario(scenario.empty() ? config / "scenarios" / "heavy.toml" : scenario, config);
            return meter_parameters(loaded, antiskid::load_controller_config(loaded.controller));
        });
        LogOptions chosen = options();
        chosen.layout = &layout;
        LogReader reader(log, chosen, warnings);
        MeasuredSignals signals(reader, layout, rig.period_s);
        SampleTable table(signals, layout, rig);
        std::vector<std::unique_ptr<TableWriter>> writers;
        if (!csv.empty()) writers.push_back(std::make_unique<CsvWriter>(csv, table.columns()));
        if (!mat.empty()) writers.push_back(std::make_unique<MatWriter>(mat, table.columns()));
        settings::Progress progress(100, 0, "%");
        std::uint64_t count = 0;
        for (std::vector<double> row; table.next(row); show(progress, ++count, reader))
            for (const auto& writer : writers) writer->row(row);
        if (signals.restarted())
            fmt::print(stderr, "rig-replay: warning: {}:{}: SYNC numbers begin anew: another recording, which is not read\n", log, reader.lines());
        if (count == 0) throw std::runtime_error(log + ": no sample of a rig in it (see the warnings above, --dbc and --interface)");
        for (const auto& writer : writers) writer->finish();
        return count;
    }

    std::uint64_t write_frames(LogWarnings& warnings) const {
        LogReader reader(log, options(), warnings);
        settings::Progress progress(100, 0, "%");
        PartFile file(candump);
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
            if (length == 0) throw std::runtime_error(fmt::format("{}:{}: the name of the interface is too long", log, reader.lines()));
            text[length] = '\n';
            lines.write(text.data(), static_cast<std::streamsize>(length) + 1);
        }
        lines.close();
        if (!lines) throw std::runtime_error(candump.string() + ": cannot be written");
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
    settings::result_file(verb->add_option("--csv", c->csv, "a row for each sample, time first, units in the names of the columns"));
    settings::result_file(verb->add_option("--mat", c->mat, "the same columns as variables, MATLAB v7.3"));
    settings::result_file(verb->add_option("--candump", c->candump, "the frames, candump format"));
    settings::result_file(verb->add_option("--parquet", c->parquet, "is not written here: says by which command pandas makes it of --csv"));
    verb->add_option("--interface", c->interface, "lines of this interface (default: the first in the log)");
    settings::existing_file(
        verb->add_option("--scenario", c->scenario, "teeth and radii: a file of config/scenarios (default: CONFIG/scenarios/heavy.toml)"));
    settings::add_config_directory(*verb, c->config);
    settings::add_layout_files(*verb, c->dbc, c->binding);
    settings::add_json(*verb, c->json, "what was written");
    verb->footer(
        "Examples:\n"
        "  rig-replay export out/landing/bus.log --csv landing.csv\n"
        "  rig-replay export night.blf --dbc config/foreign.dbc --binding config/foreign_binding.toml --mat night.mat\n"
        "  rig-replay export night.trc --candump night.log\n"
        "Exit status: 0 written; 1 the log cannot be read or has no such frames, or the file cannot be written; 2 mistake in command line or "
        "configuration.");
    return {verb, [c] { return c->run(); }};
}

}  // namespace rig::replay
