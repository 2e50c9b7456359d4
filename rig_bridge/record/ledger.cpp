#include "rig_bridge/record/ledger.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <system_error>
#include <utility>
#include <variant>

#include "firmware/host/settings/atomic_file.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/ledger_impl.hpp"
#include "rig_bridge/record/summary_file.hpp"

namespace rig::record {

namespace {

std::string_view state_of(const Summary& summary) {
    return summary.outcome == "finished" ? "finished" : "aborted";
}

std::filesystem::path make_parent(const std::filesystem::path& path, const settings::Storage& storage) {
    if (!path.has_parent_path()) return path;
    try {
        settings::create_directories(path.parent_path(), storage);
    } catch (const settings::Error& error) {
        throw LedgerError(error.what());
    }
    return path;
}

std::string joined(const std::vector<std::string>& words) {
    return fmt::format("{}", fmt::join(words, " "));
}

void write_specimen(const LedgerDatabase& database, const char* table, std::int64_t row, const Specimen& specimen) {
    for (const SpecimenField& field : kSpecimenFields)
        database.prepare(fmt::format("UPDATE {} SET {} = ?2 WHERE id = ?1", table, field.key)).bind_all(row, specimen.*field.value).run();
}

std::int64_t as_integer(std::uint64_t value, const std::string& path, const char* what) {
    if (value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) throw settings::Error(path, 0, what, "must be below 2^63");
    return static_cast<std::int64_t>(value);
}

std::string lock_file(const std::filesystem::path& ledger) {
    return ledger.string() + "-held";
}

}  // namespace

Ledger::Impl::Impl(const std::filesystem::path& ledger, const LedgerOptions& options)
    : storage(options.storage),
      path(make_parent(ledger, *storage)),
      lock(ledger, *storage),
      database(ledger, LedgerDatabase::Access::write, options) {}

Ledger::Ledger(const std::filesystem::path& path, const LedgerOptions& options) : impl_(std::make_unique<Impl>(path, options)) {}
Ledger::~Ledger() = default;

Resumed Ledger::open_campaign(const Campaign& campaign, IfChanged changed, const MeterLog& meter) {
    const std::string path = impl_->path.string();
    if (campaign.name.empty() || campaign.name.find('/') != std::string::npos || campaign.name.front() == '.')
        throw settings::Error(path, 0, "", "'" + campaign.name + "' is no campaign name: it names a folder, so no '/' and no leading '.'");
    const std::int64_t seed = as_integer(campaign.seed, path, "seed");
    Specimen specimen = campaign.specimen;
    check_texts(specimen);
    Resumed resumed;
    LedgerDatabase::Transaction transaction(impl_->database);
    Statement find = impl_->database.prepare(fmt::format("SELECT {}, id FROM campaigns WHERE name = ?1", LedgerDatabase::kCampaignColumns));
    std::int64_t id = 0;
    if (find.bind(1, campaign.name).step()) {
        const Campaign old = LedgerDatabase::read_campaign(find);
        id = find.integer(LedgerDatabase::kCampaignColumnCount);
        const auto compare = [&resumed](const char* what, const auto& was, const auto& is) {
            if (was != is) resumed.changed.push_back(fmt::format("{} was {}, is {}", what, was, is));
        };
        compare("scenario", old.scenario, campaign.scenario);
        compare("seed", old.seed, campaign.seed);
        compare("config hash", old.config_hash, campaign.config_hash);
        specimen = taken_over(specimen, old.specimen);
        for (const auto part : {&Specimen::brake, &Specimen::disc})  // wear of another brake or disc belongs to another campaign
            if (!(old.specimen.*part).empty()) compare(part == &Specimen::brake ? "brake" : "disc", old.specimen.*part, specimen.*part);
        if (!resumed.changed.empty() && changed == IfChanged::reject) {
            throw settings::Error(path, 0, "",
                                  fmt::format("campaign '{}' was begun otherwise: {}; resume it as it was begun, or give "
                                              "another name",
                                              campaign.name, fmt::join(resumed.changed, "; ")));
        }
        impl_->database.prepare("UPDATE campaigns SET scenario = ?2, seed = ?3, planned = ?4, config_hash = ?5, version = ?6 WHERE id = ?1")
            .bind_all(id, campaign.scenario, seed, campaign.planned, campaign.config_hash, campaign.version)
            .run();
    } else {
        resumed.created = true;
        Statement insert = impl_->database.prepare(
            "INSERT INTO campaigns (name, scenario, seed, planned, config_hash, version, created) "
            "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7) RETURNING id");
        insert.bind_all(campaign.name, campaign.scenario, seed, campaign.planned, campaign.config_hash, campaign.version, campaign.created);
        while (insert.step()) id = insert.integer(0);
    }
    impl_->campaign = campaign;
    impl_->campaign.specimen = specimen;
    impl_->id = id;
    write_specimen(impl_->database, "campaigns", id, specimen);
    impl_->settle(resumed, meter);
    transaction.commit();
    return resumed;
}

void Ledger::choose(const std::string& campaign) {
    Statement find = impl_->database.prepare(fmt::format("SELECT {}, id FROM campaigns WHERE name = ?1", LedgerDatabase::kCampaignColumns));
    if (!find.bind(1, campaign).step()) throw settings::Error(impl_->path.string(), 0, "", "has no campaign '" + campaign + "'");
    impl_->campaign = LedgerDatabase::read_campaign(find);
    impl_->id = find.integer(LedgerDatabase::kCampaignColumnCount);
}

void Ledger::Impl::settle(Resumed& resumed, const MeterLog& meter) {
    struct Left {
        std::int64_t row;
        Attempt attempt;
    };
    std::vector<Left> left;
    Statement running = database.prepare("SELECT id, number, attempt, folder FROM maneuvers WHERE campaign = ?1 AND state = 'running' ORDER BY id");
    running.bind(1, id);
    while (running.step()) {
        left.push_back(
            {running.integer(0), {.number = running.integer(1), .attempt = running.integer(2), .folder = path.parent_path() / running.text(3)}});
    }
    for (const auto& [row, attempt] : left) {
        if (const auto summary = whole_summary(attempt.folder, attempt.number)) {
            enter(*summary, row, state_of(*summary));
            resumed.adopted.push_back(attempt.number);
        } else {
            leave_unfinished(row, meter ? meter(attempt) : std::nullopt);
            resumed.unfinished.push_back(attempt.number);
        }
    }
}

void Ledger::Impl::leave_unfinished(std::int64_t row, const std::optional<Summary>& known) {
    if (!known) {
        database.prepare("UPDATE maneuvers SET state = 'unfinished' WHERE id = ?1").bind(1, row).run();
        return;
    }
    Summary summary = *known;
    summary.cumulative_energy_J = cumulative_J() + counted_energy_J(summary);
    enter(summary, row, "unfinished");
}

std::optional<Summary> Ledger::Impl::whole_summary(const std::filesystem::path& folder, std::int64_t number) const {
    try {
        Summary summary = read_summary(folder / "summary.json", *storage);
        if (summary.campaign == campaign.name && summary.number == number) {
            // The program that wrote it may have died before its name was on the disk; the ledger's row must not be on the disk without it.
            if (const int error = storage->sync_directory(folder); error != 0)
                throw LedgerError((folder / "summary.json").string() + ": " + std::strerror(error));
            return summary;
        }
    } catch (const settings::Error&) {
        // Missing or incomplete: the maneuver did not end.
    }
    return std::nullopt;
}

void Ledger::Impl::enter(const Summary& summary, std::int64_t row, std::string_view state) {
    std::string sql =
        "UPDATE maneuvers SET state = ?2, scenario = ?3, outcome = ?4, started = coalesce(nullif(?5, ''), started), standstill = ?6, "
        "cumulative_energy_J = ?7, faults = ?8, frames = ?9, frames_dropped = ?10, seed = ?11, version = ?12, config_hash = ?13, warnings = ?14, "
        "out_of_tolerance = ?15";
    constexpr int kFirstFigure = 16;
    int parameter = kFirstFigure;
    for (const FigureField& field : kFigureFields) sql += fmt::format(", {} = ?{}", field.key, parameter++);
    Statement update = database.prepare(sql + " WHERE id = ?1");
    update.bind_all(row, state, summary.scenario, summary.outcome, summary.started, std::int64_t{summary.figures.standstill ? 1 : 0},
                    summary.cumulative_energy_J, joined(summary.faults), as_integer(summary.frames, path.string(), "frames"),
                    as_integer(summary.frames_dropped, path.string(), "frames_dropped"), as_integer(summary.seed, path.string(), "seed"),
                    summary.version, summary.config_hash, fmt::format("{}", fmt::join(summary.warnings, kWarningsApart)));
    if (summary.out_of_tolerance) update.bind(kFirstFigure - 1, joined(*summary.out_of_tolerance));  // else NULL
    parameter = kFirstFigure;
    for (const FigureField& field : kFigureFields) update.bind(parameter++, summary.figures.*field.value);
    update.run();
}

std::optional<std::int64_t> Ledger::next_number() const {
    impl_->need_campaign();
    Statement next = impl_->database.prepare(
        "WITH done AS (SELECT number FROM maneuvers WHERE campaign = ?1 AND state = 'finished') "
        "SELECT min(n) FROM (SELECT 1 AS n UNION SELECT number + 1 FROM done) WHERE n NOT IN done");
    if (!next.bind(1, impl_->id).step()) return std::nullopt;
    const std::int64_t number = next.integer(0);
    return number <= impl_->campaign.planned ? std::optional(number) : std::nullopt;
}

double Ledger::cumulative_energy_J() const {
    impl_->need_campaign();
    return impl_->cumulative_J();
}

double Ledger::Impl::cumulative_J() const {
    // The sums in rows with figures contain the amendments made before that row began.
    Statement sum = database.prepare(
        "WITH last AS (SELECT id, cumulative_energy_J AS J FROM maneuvers WHERE campaign = ?1 AND "
        "cumulative_energy_J IS NOT NULL ORDER BY id DESC LIMIT 1) "
        "SELECT coalesce((SELECT J FROM last), 0.0) + coalesce((SELECT sum(a.counted_J - a.before_J) "
        "FROM amendments a JOIN maneuvers m ON m.id = a.maneuver "
        "WHERE m.campaign = ?1 AND a.newest >= coalesce((SELECT id FROM last), 0)), 0.0)");
    return sum.bind(1, id).step() ? sum.real(0) : 0.0;
}

std::int64_t Ledger::finished_count() const {
    impl_->need_campaign();
    Statement count = impl_->database.prepare("SELECT count(*) FROM maneuvers WHERE campaign = ?1 AND state = 'finished'");
    return count.bind(1, impl_->id).step() ? count.integer(0) : 0;
}

const Specimen& Ledger::specimen() const {
    return impl_->campaign.specimen;
}

Attempt Ledger::begin(std::int64_t number, const std::string& started, std::optional<double> slip_reference) {
    return begin(number, started, slip_reference, impl_->campaign.specimen);
}

Attempt Ledger::begin(std::int64_t number, const std::string& started, std::optional<double> slip_reference, const Specimen& specimen) {
    impl_->need_campaign();
    LedgerDatabase::Transaction transaction(impl_->database);
    Statement last = impl_->database.prepare(
        "SELECT coalesce(max(attempt), 0), coalesce(max(state = 'finished'), 0), "
        "(SELECT count(*) FROM maneuvers WHERE campaign = ?1 AND state = 'running') "
        "FROM maneuvers WHERE campaign = ?1 AND number = ?2");
    last.bind_all(impl_->id, number).step();
    const std::string where = impl_->path.string() + ": maneuver " + std::to_string(number);
    if (last.integer(1) != 0) throw LedgerError(where + " is finished already");
    if (last.integer(2) != 0) throw LedgerError(where + " cannot begin: another one is running");
    const std::int64_t attempt = last.integer(0) + 1;
    const Campaign& campaign = impl_->campaign;
    const std::string folder =
        attempt == 1 ? fmt::format("{}/{:04}", campaign.name, number) : fmt::format("{}/{:04}.{}", campaign.name, number, attempt);
    Statement insert = impl_->database.prepare(
        "INSERT INTO maneuvers (campaign, number, attempt, state, folder, scenario, started, seed, version, config_hash, slip_reference) "
        "VALUES (?1, ?2, ?3, 'running', ?4, ?5, ?6, ?7, ?8, ?9, ?10) RETURNING id");
    insert.bind_all(impl_->id, number, attempt, folder, campaign.scenario, started, static_cast<std::int64_t>(campaign.seed), campaign.version,
                    campaign.config_hash, slip_reference.value_or(std::numeric_limits<double>::quiet_NaN()));  // NaN is NULL
    std::int64_t row = 0;
    while (insert.step()) row = insert.integer(0);
    write_specimen(impl_->database, "maneuvers", row, specimen);
    transaction.commit();
    return {.number = number, .attempt = attempt, .folder = impl_->path.parent_path() / folder};
}

void Ledger::finish(const Summary& summary) {
    impl_->need_campaign();
    const std::string where = impl_->path.string() + ": maneuver " + std::to_string(summary.number);
    if (summary.campaign != impl_->campaign.name)
        throw LedgerError(where + " is of campaign '" + summary.campaign + "', not '" + impl_->campaign.name + "'");
    LedgerDatabase::Transaction transaction(impl_->database);
    Statement running = impl_->database.prepare("SELECT id FROM maneuvers WHERE campaign = ?1 AND number = ?2 AND state = 'running'");
    if (!running.bind_all(impl_->id, summary.number).step()) throw LedgerError(where + " is not running");
    impl_->enter(summary, running.integer(0), state_of(summary));
    transaction.commit();
}

void Ledger::mark_unfinished(const std::optional<Summary>& known) {
    impl_->need_campaign();
    LedgerDatabase::Transaction transaction(impl_->database);
    Statement running = impl_->database.prepare("SELECT id FROM maneuvers WHERE campaign = ?1 AND state = 'running'");
    if (running.bind(1, impl_->id).step()) impl_->leave_unfinished(running.integer(0), known);
    transaction.commit();
}

std::unique_ptr<settings::File> LedgerLock::take(const std::filesystem::path& ledger, const settings::Storage& storage) {
    try {
        auto held = storage.hold(lock_file(ledger), "process " + std::to_string(getpid()));
        if (auto* const mine = std::get_if<std::unique_ptr<settings::File>>(&held)) return std::move(*mine);
        const std::string& who = std::get<settings::LockHolder>(held).who;
        throw LedgerError(ledger.string() + ": is held by another program" + (who.empty() ? "" : " (" + who + ")") +
                          "; one bridge at a time may run campaigns on it");
    } catch (const std::system_error& error) {
        throw LedgerError(error.what());
    }
}

std::optional<std::string> held_by_another(const std::filesystem::path& path) {
    try {
        const LedgerLock lock(path, settings::PosixStorage{});
        return std::nullopt;
    } catch (const LedgerError& error) {
        return error.what();
    }
}

bool is_held(const std::filesystem::path& path) {
    return settings::PosixStorage{}.held_by(lock_file(path)).has_value();
}

}  // namespace rig::record
