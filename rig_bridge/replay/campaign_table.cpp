#include "rig_bridge/replay/campaign_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/summary_file.hpp"

namespace rig {

namespace {

namespace fs = std::filesystem;

/// "0012" or "0012.3"
std::optional<ManeuverFolder> as_maneuver(const fs::path& path) {
    const std::string name = path.filename().string();
    ManeuverFolder folder{.path = path, .number = 0, .attempt = 1};
    const char* const end = name.data() + name.size();
    auto [at, error] = std::from_chars(name.data(), end, folder.number);
    if (error != std::errc{} || folder.number < 1) return std::nullopt;
    if (at == end) return folder;
    if (*at != '.') return std::nullopt;
    const auto [last, second] = std::from_chars(at + 1, end, folder.attempt);
    if (second != std::errc{} || last != end || folder.attempt < 2) return std::nullopt;
    return folder;
}

void compare(const Figures& from_log, const Figures& stated, const char* where,
             std::vector<std::string>& differences) {
    for (const FigureField& field : kFigureFields) {
        const double a = from_log.*field.value;
        const double b = stated.*field.value;
        if (a == b || (std::isnan(a) && std::isnan(b))) continue;
        differences.push_back(fmt::format("{} is {} from the log, {} in {}", field.key, a, b, where));
    }
    if (from_log.standstill != stated.standstill)
        differences.push_back(fmt::format("standstill is {} from the log, {} in {}", from_log.standstill,
                                          stated.standstill, where));
}

void compare_energy(double from_logs, double stated, const char* where,
                    std::vector<std::string>& differences) {
    if (from_logs == stated) return;
    differences.push_back(
        fmt::format("cumulative_energy_J is {} from the logs, {} in {}", from_logs, stated, where));
}

class Rebuild {
  public:
    explicit Rebuild(const CampaignSources& sources) : sources_(sources) {
        table_.with_ledger = sources.with_ledger;
    }

    CampaignTable run(const std::vector<ManeuverFolder>& folders) {
        for (const ManeuverFolder& folder : folders) add(folder);
        if (table_.with_ledger) rows_without_folder(folders);
        return table_;
    }

  private:
    void add(const ManeuverFolder& folder) {
        CampaignRow row;
        row.folder = folder;
        const LedgerRow* const ledger = ledger_row(folder);
        row.counted = fs::exists(folder.path / "summary.json");
        row.outcome = "unfinished";
        if (row.counted) {
            const Summary summary = read_summary(folder.path / "summary.json");
            row.outcome = summary.outcome;
            measure(summary, row);
            energy_J_ += row.figures.energy_brake_J;
            row.cumulative_energy_J = energy_J_;
            compare(row.figures, summary.figures, "summary.json", row.differences);
            compare_energy(energy_J_, summary.cumulative_energy_J, "summary.json", row.differences);
            if (ledger != nullptr) {
                compare(row.figures, ledger->summary.figures, "the ledger", row.differences);
                compare_energy(energy_J_, ledger->summary.cumulative_energy_J, "the ledger", row.differences);
            }
        }
        if (table_.with_ledger) compare_state(row, ledger);
        table_.rows.push_back(std::move(row));
    }

    static void compare_state(CampaignRow& row, const LedgerRow* ledger) {
        if (ledger == nullptr) {
            row.differences.emplace_back("the ledger has no such attempt");
            return;
        }
        const bool entered = ledger->state == RowState::finished || ledger->state == RowState::aborted;
        if (entered != row.counted)
            row.differences.push_back(fmt::format("{} summary.json, but {} in the ledger",
                                                  row.counted ? "has a" : "has no", name(ledger->state)));
    }

    void rows_without_folder(const std::vector<ManeuverFolder>& folders) {
        for (const LedgerRow& ledger : sources_.ledger) {
            const bool there = std::any_of(folders.begin(), folders.end(), [&](const ManeuverFolder& f) {
                return f.number == ledger.attempt.number && f.attempt == ledger.attempt.attempt;
            });
            if (there || ledger.state == RowState::unfinished || ledger.state == RowState::running) continue;
            CampaignRow row;
            row.folder = {.path = ledger.attempt.folder,
                          .number = ledger.attempt.number,
                          .attempt = ledger.attempt.attempt};
            row.outcome = name(ledger.state);
            row.differences.push_back("in the ledger, but the folder is not there");
            table_.rows.push_back(std::move(row));
        }
    }

    [[nodiscard]] const LedgerRow* ledger_row(const ManeuverFolder& folder) const {
        const auto found =
            std::find_if(sources_.ledger.begin(), sources_.ledger.end(), [&](const LedgerRow& row) {
                return row.attempt.number == folder.number && row.attempt.attempt == folder.attempt;
            });
        return found == sources_.ledger.end() ? nullptr : &*found;
    }

    void measure(const Summary& summary, CampaignRow& row) {
        fs::path log = row.folder.path / "bus.log";
        if (!fs::exists(log)) log += ".gz";
        if (!fs::exists(log)) {
            row.differences.emplace_back("neither bus.log nor bus.log.gz");
            return;
        }
        LogWarnings warnings = sources_.warnings(log.string());
        LogOptions options;
        options.layout = &sources_.layout;
        LogReader reader(log, options, warnings);
        BusMeter meter(sources_.layout, sources_.parameters(summary.scenario));
        for (LogFrame frame; reader.next(frame);) meter.accept(frame.frame);
        row.figures = meter.figures();
        table_.lines += reader.lines();
    }

    const CampaignSources& sources_;
    CampaignTable table_;
    double energy_J_ = 0.0;
};

}  // namespace

std::vector<ManeuverFolder> maneuver_folders(const fs::path& campaign) {
    std::vector<ManeuverFolder> folders;
    if (!fs::is_directory(campaign))
        throw std::runtime_error(campaign.string() + ": is no directory; expected the folder of a campaign");
    for (const fs::directory_entry& entry : fs::directory_iterator(campaign))
        if (const auto folder = entry.is_directory() ? as_maneuver(entry.path()) : std::nullopt)
            folders.push_back(*folder);
    if (folders.empty())
        throw std::runtime_error(campaign.string() +
                                 ": holds no maneuvers; expected folders 0001, 0002, ...");
    std::sort(folders.begin(), folders.end(), [](const ManeuverFolder& a, const ManeuverFolder& b) {
        return a.number != b.number ? a.number < b.number : a.attempt < b.attempt;
    });
    return folders;
}

std::uint64_t CampaignTable::counted() const {
    return static_cast<std::uint64_t>(
        std::count_if(rows.begin(), rows.end(), [](const auto& r) { return r.counted; }));
}

std::uint64_t CampaignTable::different() const {
    return static_cast<std::uint64_t>(
        std::count_if(rows.begin(), rows.end(), [](const auto& r) { return !r.differences.empty(); }));
}

CampaignTable rebuild_campaign(const std::vector<ManeuverFolder>& folders, const CampaignSources& sources) {
    return Rebuild(sources).run(folders);
}

}  // namespace rig
