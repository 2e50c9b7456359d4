#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "firmware/host/settings/error.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/ledger_database.hpp"
#include "rig_bridge/record/ledger_impl.hpp"

namespace rig::record {

namespace {

constexpr std::array kStateNames{"running", "finished", "aborted", "unfinished"};

std::vector<std::string> split(const std::string& text, std::string_view apart) {
    std::vector<std::string> words;
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t to = std::min(text.find(apart, from), text.size());
        if (to > from) words.push_back(text.substr(from, to - from));
        from = to + apart.size();
    }
    return words;
}

/// Columns of a row in the order of read_row().
std::string columns() {
    std::string list = "state, number, attempt, folder, scenario, outcome, started";
    for (const FigureField& field : kFigureFields) list += std::string(", ") + field.key;
    for (const SpecimenField& field : kSpecimenFields) list += std::string(", ") + field.key;
    return list +
           ", standstill, cumulative_energy_J, faults, frames, frames_dropped, seed, version, config_hash, "
           "health, health_statistic, health_reason, health_model, slip_reference, out_of_tolerance, "
           "warnings, id, " +
           std::string(LedgerDatabase::kAmended_J);
}

std::vector<Amendment> amendments(const LedgerDatabase& database, std::int64_t maneuver) {
    Statement rows = database.prepare("SELECT counted_J, who, made, why FROM amendments WHERE maneuver = ?1 ORDER BY id");
    rows.bind(1, maneuver);
    std::vector<Amendment> all;
    while (rows.step()) {
        all.push_back({.counted_J = rows.real(0), .who = rows.text(1), .made = rows.text(2), .why = rows.text(3)});
    }
    return all;
}

std::vector<Note> notes(const LedgerDatabase& database, std::int64_t maneuver) {
    Statement rows = database.prepare("SELECT field, text, who, made FROM noted WHERE maneuver = ?1 ORDER BY id");
    rows.bind(1, maneuver);
    std::vector<Note> all;
    while (rows.step()) all.push_back({.field = rows.text(0), .text = rows.text(1), .who = rows.text(2), .made = rows.text(3)});
    return all;
}

/// A later note replaces the recorded field; free notes are appended.
void take(const Note& note, Specimen& specimen) {
    for (const SpecimenField& field : kSpecimenFields) {
        if (note.field != field.key) continue;
        std::string& value = specimen.*field.value;
        if (field.value == &Specimen::notes && !value.empty())
            value.append("; ").append(note.text);
        else
            value = note.text;
    }
}

double noted_share(const std::filesystem::path& ledger, const Attempt& attempt, const Note& note) {
    try {
        return worn_share(note.field, note.text);
    } catch (const std::invalid_argument& error) {
        throw LedgerError(fmt::format("{}: maneuver {}, attempt {}: {}", ledger.string(), attempt.number, attempt.attempt, error.what()));
    }
}

LedgerRow read_row(const LedgerDatabase& database, const Statement& row, const std::filesystem::path& ledger, const std::string& campaign) {
    LedgerRow out;
    int c = 0;
    const std::string state = row.text(c++);
    for (std::size_t i = 0; i < kStateNames.size(); ++i) {
        if (state == kStateNames[i]) out.state = static_cast<RowState>(i);
    }
    Summary& s = out.summary;
    s.campaign = campaign;
    s.number = out.attempt.number = row.integer(c++);
    out.attempt.attempt = row.integer(c++);
    out.attempt.folder = ledger.parent_path() / row.text(c++);
    s.scenario = row.text(c++);
    s.outcome = row.text(c++);
    s.started = row.text(c++);
    const int cumulative = c + static_cast<int>(kFigureFields.size() + kSpecimenFields.size()) + 1;
    const bool ended = out.state == RowState::finished || out.state == RowState::aborted;
    out.has_figures = ended || !row.null(cumulative);
    for (const FigureField& field : kFigureFields) {
        if (out.has_figures) s.figures.*field.value = row.real(c);
        ++c;
    }
    for (const SpecimenField& field : kSpecimenFields) s.specimen.*field.value = row.text(c++);
    s.figures.standstill = row.integer(c++) != 0;
    if (out.has_figures) s.cumulative_energy_J = row.real(c);
    ++c;
    s.faults = split(row.text(c++), " ");
    s.frames = static_cast<std::uint64_t>(row.integer(c++));
    s.frames_dropped = static_cast<std::uint64_t>(row.integer(c++));
    s.seed = static_cast<std::uint64_t>(row.integer(c++));
    s.version = row.text(c++);
    s.config_hash = row.text(c++);
    const std::string health = row.text(c++);
    for (std::size_t i = 0; i < kHealthNames.size(); ++i) {
        if (health == kHealthNames[i]) out.health.state = static_cast<HealthState>(i);
    }
    out.health.statistic = row.real(c++);
    out.health.reason = row.text(c++);
    out.health.model = row.text(c++);
    out.slip_reference = row.real(c++);
    if (!row.null(c)) s.out_of_tolerance = split(row.text(c), " ");
    ++c;
    s.warnings = split(row.text(c++), kWarningsApart);
    const std::int64_t id = row.integer(c++);
    out.notes = notes(database, id);
    out.recorded = s.specimen;
    for (const Note& note : out.notes) {
        take(note, s.specimen);
        for (const WearReadingField& field : kWearReadingFields)
            if (note.field == field.key) out.worn.*field.value = noted_share(ledger, out.attempt, note);
    }
    out.amendments = amendments(database, id);
    out.counted_J = out.amendments.empty() ? counted_energy_J(s) : out.amendments.back().counted_J;
    s.cumulative_energy_J += row.real(c++);
    return out;
}

}  // namespace

Campaign LedgerDatabase::read_campaign(const Statement& row) {
    Campaign campaign{.name = row.text(0),
                      .scenario = row.text(1),
                      .seed = static_cast<std::uint64_t>(row.integer(2)),
                      .planned = row.integer(3),
                      .config_hash = row.text(4),
                      .version = row.text(5),
                      .created = row.text(6)};
    int column = 7;
    for (const SpecimenField& field : kSpecimenFields) campaign.specimen.*field.value = row.text(column++);
    return campaign;
}

std::vector<LedgerRow> read_ledger(const std::filesystem::path& path, const std::string& campaign, const LedgerOptions& options) {
    const LedgerDatabase database(path, LedgerDatabase::Access::read, options);
    Statement find = database.prepare("SELECT id FROM campaigns WHERE name = ?1");
    if (!find.bind(1, campaign).step()) {
        std::string known;
        for (const Campaign& other : read_campaigns(path, options)) known += (known.empty() ? "" : ", ") + other.name;
        throw settings::Error(path.string(), 0, "", "has no campaign '" + campaign + "'" + (known.empty() ? "" : "; it has " + known));
    }
    return read_rows(database, path, campaign, find.integer(0));
}

std::vector<LedgerRow> read_rows(const LedgerDatabase& database, const std::filesystem::path& ledger, const std::string& campaign, std::int64_t id) {
    Statement rows = database.prepare("SELECT " + columns() + " FROM maneuvers WHERE campaign = ?1 ORDER BY id");
    rows.bind(1, id);
    std::vector<LedgerRow> all;
    while (rows.step()) all.push_back(read_row(database, rows, ledger, campaign));
    return all;
}

const LedgerRow* row_of(const std::vector<LedgerRow>& rows, const Attempt& attempt) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const LedgerRow& row) { return row.attempt == attempt; });
    return found == rows.end() ? nullptr : &*found;
}

std::vector<Campaign> read_campaigns(const std::filesystem::path& path, const LedgerOptions& options) {
    const LedgerDatabase database(path, LedgerDatabase::Access::read, options);
    Statement rows = database.prepare(fmt::format("SELECT {} FROM campaigns ORDER BY id", LedgerDatabase::kCampaignColumns));
    std::vector<Campaign> all;
    while (rows.step()) all.push_back(LedgerDatabase::read_campaign(rows));
    return all;
}

const char* name(RowState state) {
    return kStateNames[static_cast<std::size_t>(state)];
}

void Ledger::judge(std::int64_t number, const Health& health) {
    impl_->need_campaign();
    LedgerDatabase::Transaction transaction(impl_->database);
    Statement update = impl_->database.prepare(
        "UPDATE maneuvers SET health = ?3, health_statistic = ?4, health_reason = ?5, health_model = ?6 "
        "WHERE campaign = ?1 AND number = ?2 AND state = 'finished' RETURNING id");
    update.bind_all(impl_->id, number, std::string_view(name(health.state)), health.statistic, health.reason, health.model);
    if (!update.step())
        throw LedgerError(impl_->path.string() + ": maneuver " + std::to_string(number) + " is not finished, so its brake cannot be judged");
    while (update.step()) {
    }
    transaction.commit();
}

void Ledger::amend(std::int64_t number, std::int64_t attempt, const Amendment& amendment) {
    impl_->need_campaign();
    const std::string where = fmt::format("{}: maneuver {}, attempt {}", impl_->path.string(), number, attempt);
    if (amendment.who.empty() || amendment.why.empty()) throw LedgerError(where + " is amended only with who and why");
    LedgerDatabase::Transaction transaction(impl_->database);
    const std::vector<LedgerRow> rows = read_rows(impl_->database, impl_->path, impl_->campaign.name, impl_->id);
    const LedgerRow* const row = row_of(rows, {number, attempt, {}});
    if (row == nullptr) throw LedgerError(where + " is not in campaign '" + impl_->campaign.name + "'");
    if (std::any_of(rows.begin(), rows.end(), [](const LedgerRow& one) { return one.state == RowState::running; }))
        throw LedgerError(where + " cannot be amended while a maneuver is running; resume the campaign first");
    impl_->database
        .prepare(
            "INSERT INTO amendments (maneuver, newest, before_J, counted_J, who, made, why) SELECT id, "
            "(SELECT max(id) FROM maneuvers WHERE campaign = ?1), ?4, ?5, ?6, ?7, ?8 FROM maneuvers "
            "WHERE campaign = ?1 AND number = ?2 AND attempt = ?3")
        .bind_all(impl_->id, number, attempt, row->counted_J, amendment.counted_J, amendment.who, amendment.made, amendment.why)
        .run();
    transaction.commit();
}

void Ledger::note(std::int64_t number, std::int64_t attempt, const Note& note) {
    impl_->need_campaign();
    const std::string where = fmt::format("{}: maneuver {}, attempt {}", impl_->path.string(), number, attempt);
    if (note.who.empty() || note.text.empty()) throw LedgerError(where + " is noted only with who and what");
    check_text("--who", note.who);
    check_text(note.field, note.text);
    const auto named = [&](const auto& field) { return note.field == field.key; };
    if (std::any_of(kWearReadingFields.begin(), kWearReadingFields.end(), named))
        (void)worn_share(note.field, note.text);
    else if (std::none_of(kSpecimenFields.begin(), kSpecimenFields.end(), named))
        throw LedgerError(where + ": nothing is called '" + note.field + "'");
    LedgerDatabase::Transaction transaction(impl_->database);
    Statement insert = impl_->database.prepare(
        "INSERT INTO noted (maneuver, field, text, who, made) SELECT id, ?4, ?5, ?6, ?7 FROM maneuvers "
        "WHERE campaign = ?1 AND number = ?2 AND attempt = ?3 RETURNING id");
    insert.bind_all(impl_->id, number, attempt, note.field, note.text, note.who, note.made);
    if (!insert.step()) throw LedgerError(where + " is not in campaign '" + impl_->campaign.name + "'");
    while (insert.step()) {
    }
    transaction.commit();
}

}  // namespace rig::record
