#include "rig_bridge/replay/campaign_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <stdexcept>

#include "firmware/host/settings/csv_field.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/number_in.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/log_meter.hpp"

namespace rig::replay {

namespace {

namespace fs = std::filesystem;

/// Parses "0012" or "0012.3".
std::optional<record::Attempt> as_maneuver(const fs::path& path) {
    const std::string name = path.filename().string();
    const auto dot = name.find('.');
    const auto number = settings::number_in<std::int64_t>(name.substr(0, dot));
    if (!number || *number < 1) return std::nullopt;
    if (dot == std::string::npos) return record::Attempt{*number, 1, path};
    const auto attempt = settings::number_in<std::int64_t>(name.substr(dot + 1));
    if (!attempt || *attempt < 2) return std::nullopt;
    return record::Attempt{*number, *attempt, path};
}

void compare_figures(const record::Figures& rebuilt, const char* from, const record::Figures& stated, const char* where,
                     std::vector<std::string>& differences) {
    for (const record::FigureField& field : record::kFigureFields) {
        const double a = rebuilt.*field.value;
        const double b = stated.*field.value;
        if (a == b || (std::isnan(a) && std::isnan(b))) continue;
        differences.push_back(fmt::format("{} is {} from {}, {} in {}", field.key, a, from, b, where));
    }
    if (rebuilt.standstill != stated.standstill)
        differences.push_back(fmt::format("standstill is {} from {}, {} in {}", rebuilt.standstill, from, stated.standstill, where));
}

class Rebuild {
  public:
    explicit Rebuild(const CampaignSources& sources) : sources_(sources) { table_.with_ledger = sources.with_ledger; }

    CampaignTable run(const std::vector<record::Attempt>& folders) {
        for (const record::Attempt& attempt : folders)
            if (scenario_.empty() && fs::exists(attempt.folder / "summary.json"))
                scenario_ = record::read_summary(attempt.folder / "summary.json").scenario;
        for (const auto& [attempt, there] : attempts(folders)) add(attempt, there);
        return table_;
    }

  private:
    struct One {
        record::Attempt attempt;
        bool there = true;  // else only in the ledger
    };

    /// By number and attempt, those of the ledger that have no folder among them.
    [[nodiscard]] std::vector<One> attempts(const std::vector<record::Attempt>& folders) const {
        std::vector<One> all;
        all.reserve(folders.size() + sources_.ledger.size());
        for (const record::Attempt& attempt : folders) all.push_back({.attempt = attempt});
        for (const record::LedgerRow& row : sources_.ledger) {
            // A bridge that died before it made the folder knows nothing of the attempt.
            const bool known = row.has_figures || !row.amendments.empty() || !row.notes.empty();
            if (known && std::find(folders.begin(), folders.end(), row.attempt) == folders.end())
                all.push_back({.attempt = row.attempt, .there = false});
        }
        std::sort(all.begin(), all.end(), [](const One& a, const One& b) { return a.attempt < b.attempt; });
        return all;
    }

    void add(const record::Attempt& attempt, bool there) {
        CampaignRow row;
        row.attempt = attempt;
        const record::LedgerRow* const ledger = row_of(sources_.ledger, attempt);
        std::optional<record::Summary> stated;
        if (there && fs::exists(attempt.folder / "summary.json")) {
            row.summary = *(stated = record::read_summary(attempt.folder / "summary.json"));
        } else if (ledger != nullptr) {
            row.summary = ledger->summary;
            row.summary.specimen = ledger->recorded;
        }
        row.ended = stated || (ledger != nullptr && entered(*ledger));
        if (!row.ended) row.summary.outcome = name(record::RowState::unfinished);
        if (row.summary.scenario.empty()) row.summary.scenario = scenario_;
        const fs::path log = there && !row.summary.scenario.empty() ? log_with_lines(row) : fs::path();
        const bool known = stated || (ledger != nullptr && ledger->has_figures);
        row.counted = log.empty() ? known : measure(row, log) || row.ended;
        const bool amended = ledger != nullptr && !ledger->amendments.empty();
        if (row.counted || amended) {
            energy_J_ += amended ? ledger->counted_J : record::counted_energy_J(row.summary);
            amended_ = amended_ || amended;
            row.summary.cumulative_energy_J = energy_J_;
        }
        row.specimen = ledger != nullptr ? ledger->summary.specimen : row.summary.specimen;
        if (ledger != nullptr) row.worn = ledger->worn;
        row.disc_energy_J = disc_.after(row.specimen, energy_J_);
        const char* const from = log.empty() ? "summary.json" : "the log";
        // A summary has the values at the time of writing; sums that were amended later differ.
        if (stated) compare(row.summary, from, *stated, "summary.json", !amended_, row.differences);
        if (ledger != nullptr && known) compare(row.summary, from, ledger->summary, "the ledger", true, row.differences);
        if (table_.with_ledger) compare_state(row, stated.has_value(), there, ledger);
        if (log.empty() && known) log_missing(row, there, stated ? "summary.json" : "the ledger");
        table_.rows.push_back(std::move(row));
    }

    static bool entered(const record::LedgerRow& ledger) {
        return ledger.state == record::RowState::finished || ledger.state == record::RowState::aborted;
    }

    /// The log of the row's folder; empty if there is none, or none of the frames that were recorded is in it.
    static fs::path log_with_lines(const CampaignRow& row) {
        const fs::path log = log_in(row.attempt.folder);
        return !log.empty() && row.summary.frames > 0 && fs::file_size(log) == 0 ? fs::path() : log;
    }

    static void log_missing(CampaignRow& row, bool there, const char* from) {
        row.differences.emplace_back(there ? "neither bus.log nor bus.log.gz, or an empty one" : "in the ledger, but the folder is not there");
        without_log_missing(row.summary.warnings);
        row.summary.warnings.push_back(fmt::format("{}: its figures are those of {}", kLogMissing, from));
    }

    static void without_log_missing(std::vector<std::string>& warnings) {
        std::erase_if(warnings, [](const std::string& text) { return text.starts_with(kLogMissing); });
    }

    void compare(const record::Summary& rebuilt, const char* from, const record::Summary& stated, const char* where, bool sums,
                 std::vector<std::string>& differences) const {
        compare_figures(rebuilt.figures, from, stated.figures, where, differences);
        std::vector<std::string> now = rebuilt.warnings;
        std::vector<std::string> then = stated.warnings;
        for (std::vector<std::string>* const warnings : {&now, &then}) without_log_missing(*warnings);
        if (now != then)
            differences.push_back(fmt::format("warnings are '{}' from {}, '{}' in {}", fmt::join(now, "; "), from, fmt::join(then, "; "), where));
        // With amendments the order of additions differs.
        const double rounding_J = amended_ ? 1e-9 * std::abs(energy_J_) : 0.0;
        if (sums && !(std::abs(energy_J_ - stated.cumulative_energy_J) <= rounding_J)) {
            differences.push_back(fmt::format("cumulative_energy_J is {} from the logs, {} in {}", energy_J_, stated.cumulative_energy_J, where));
        }
    }

    static void compare_state(CampaignRow& row, bool with_summary, bool there, const record::LedgerRow* ledger) {
        if (ledger == nullptr) {
            row.differences.emplace_back("the ledger has no such attempt");
            return;
        }
        if (!there) return;
        if (entered(*ledger) != with_summary)
            row.differences.push_back(fmt::format("{} summary.json, but {} in the ledger", with_summary ? "has a" : "has no", name(ledger->state)));
        else if (row.counted && !ledger->has_figures)
            row.differences.push_back(fmt::format("{:.6g} MJ are in its log, none in the ledger", row.summary.figures.energy_brake_J * 1e-6));
    }

    /// Whether the attempt's log counts.
    bool measure(CampaignRow& row, const fs::path& log) {
        LogWarnings warnings = sources_.warnings(log.string());
        MeteredLog metered =
            meter_log(log, sources_.layout, sources_.parameters(row.summary.scenario), row.ended ? LogEnd::closed : LogEnd::left, warnings);
        row.summary.figures = metered.figures;
        row.summary.warnings = std::move(metered.warnings);
        table_.lines += metered.lines;
        return metered.counts;
    }

    const CampaignSources& sources_;
    CampaignTable table_;
    std::string scenario_;  // of the campaign; for attempts without one
    double energy_J_ = 0.0;
    record::DiscEnergy disc_;
    bool amended_ = false;
};

std::string title(const record::Attempt& a) {
    return a.attempt == 1 ? fmt::format("{:04}", a.number) : fmt::format("{:04}.{}", a.number, a.attempt);
}

std::string verdict(const CampaignTable& table) {
    return fmt::format("{} maneuvers rebuilt from {} lines; {} differ from {}", table.counted(), table.lines, table.different(),
                       table.with_ledger ? "summaries and ledger" : "summaries (no ledger)");
}

}  // namespace

std::vector<record::Attempt> maneuver_folders(const fs::path& campaign) {
    std::vector<record::Attempt> folders;
    if (!fs::is_directory(campaign)) throw std::runtime_error(campaign.string() + ": is no directory; expected the folder of a campaign");
    for (const fs::directory_entry& entry : fs::directory_iterator(campaign))
        if (const auto folder = entry.is_directory() ? as_maneuver(entry.path()) : std::nullopt) folders.push_back(*folder);
    if (folders.empty()) throw std::runtime_error(campaign.string() + ": holds no maneuvers; expected folders 0001, 0002, ...");
    std::sort(folders.begin(), folders.end());
    const auto twice = std::adjacent_find(folders.begin(), folders.end());
    if (twice != folders.end())
        throw std::runtime_error(fmt::format("{} and {} are both maneuver {}, attempt {}: keep one of them under {}", twice->folder.string(),
                                             std::next(twice)->folder.string(), twice->number, twice->attempt, campaign.string()));
    return folders;
}

std::uint64_t CampaignTable::counted() const {
    return static_cast<std::uint64_t>(std::count_if(rows.begin(), rows.end(), [](const auto& r) { return r.counted; }));
}

std::uint64_t CampaignTable::different() const {
    return static_cast<std::uint64_t>(std::count_if(rows.begin(), rows.end(), [](const auto& r) { return !r.differences.empty(); }));
}

CampaignTable rebuild_campaign(const std::vector<record::Attempt>& folders, const CampaignSources& sources) {
    return Rebuild(sources).run(folders);
}

std::string to_text(const CampaignTable& table) {
    auto text = settings::TextTable::screen("maneuver:<10|energy so far:>16.4f|mean friction:>15.5f|brake-on:>12.2f|duration:>11.3f|  outcome");
    text.add("", "MJ", "mu_b", "m/s", "s", "");
    std::string parts;
    for (const CampaignRow& row : table.rows) {
        const record::Figures& f = row.summary.figures;
        if (const std::string now = to_text(row.specimen); now != parts) text.line("    from here on: " + (parts = now));
        if (row.counted)
            text.add(title(row.attempt), row.summary.cumulative_energy_J * 1e-6, f.mean_friction, f.brake_on_mps, f.duration_s);
        else
            text.add(title(row.attempt), "", "", "", "");
        text.add("  " + row.summary.outcome);
        for (const std::string& warning : row.summary.warnings) text.line("    " + warning);
        for (const std::string& difference : row.differences) text.line("    DIFFERS: " + difference);
    }
    text.line(verdict(table));
    return text.text();
}

std::string to_csv(const CampaignTable& table) {
    std::string columns = "number|attempt|outcome|cumulative_energy_J";
    for (const record::FigureField& field : record::kFigureFields) columns.append("|").append(field.key);
    for (const record::SpecimenField& field : record::kSpecimenFields) columns.append("|").append(field.key);
    columns.append("|disc_energy_J");
    for (const record::WearReadingField& field : record::kWearReadingFields) columns.append("|").append(field.key);
    auto csv = settings::TextTable::csv(columns);
    for (const CampaignRow& row : table.rows) {
        if (!row.counted) continue;
        csv.add(row.attempt.number, row.attempt.attempt, row.summary.outcome, row.summary.cumulative_energy_J);
        for (const record::FigureField& field : record::kFigureFields) csv.add(row.summary.figures.*field.value);
        for (const record::SpecimenField& field : record::kSpecimenFields) csv.add(settings::csv_field(row.specimen.*field.value));
        csv.add(row.disc_energy_J);
        for (const record::WearReadingField& field : record::kWearReadingFields) {
            const double worn = row.worn.*field.value;
            csv.add(std::isfinite(worn) ? fmt::format("{}", worn) : std::string());
        }
    }
    return csv.text();
}

std::string to_json(const CampaignTable& table, const std::string& campaign) {
    auto rows = settings::Json::array();
    for (const CampaignRow& row : table.rows) {
        settings::Json one{{"number", row.attempt.number},
                           {"attempt", row.attempt.attempt},
                           {"outcome", row.summary.outcome},
                           {"counted", row.counted},
                           {"cumulative_energy_J", row.summary.cumulative_energy_J}};
        if (row.counted)
            for (const record::FigureField& field : record::kFigureFields) one[field.key] = row.summary.figures.*field.value;
        for (const record::SpecimenField& field : record::kSpecimenFields) one[field.key] = row.specimen.*field.value;
        for (const record::WearReadingField& field : record::kWearReadingFields) one[field.key] = row.worn.*field.value;
        one["disc_energy_J"] = row.disc_energy_J;
        one["warnings"] = row.summary.warnings;
        one["differences"] = row.differences;
        rows.push_back(std::move(one));
    }
    const settings::Json root{{"campaign", campaign},
                              {"version", ANTISKID_VERSION},
                              {"maneuvers", table.counted()},
                              {"different", table.different()},
                              {"with_ledger", table.with_ledger},
                              {"lines", table.lines},
                              {"rows", rows}};
    return settings::json_page(root);
}

}  // namespace rig::replay
