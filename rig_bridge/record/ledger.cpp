#include "rig_bridge/record/ledger.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>

#include "config/reader/error.hpp"
#include "config/reader/file_descriptor.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/ledger_database.hpp"
#include "rig_bridge/record/summary_file.hpp"

namespace rig {

namespace {

constexpr std::string_view kFinished = "finished";

std::filesystem::path make_parent(const std::filesystem::path& path) {
    if (path.has_parent_path()) {
        std::error_code error;
        std::filesystem::create_directories(path.parent_path(), error);
        if (error) throw LedgerError(path.parent_path().string() + ": " + error.message());
    }
    return path;
}

/// A file of its own beside the ledger: SQLite's locks on the ledger itself would be lost when any descriptor of it is closed.
class Lock {
  public:
    explicit Lock(const std::filesystem::path& ledger) : file_(take(ledger)) {}

  private:
    static int take(const std::filesystem::path& ledger) {
        const std::string path = ledger.string() + "-held";
        const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (file < 0) throw LedgerError(path + ": " + std::strerror(errno));
        if (flock(file, LOCK_EX | LOCK_NB) == 0) {
            const std::string pid = std::to_string(getpid()) + "\n";
            // Only for the message below.
            static_cast<void>(ftruncate(file, 0) == 0 && pwrite(file, pid.data(), pid.size(), 0) > 0);
            return file;
        }
        std::array<char, 24> text{};
        const ssize_t size = pread(file, text.data(), text.size() - 1, 0);
        std::string pid(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
        while (!pid.empty() && pid.back() == '\n') pid.pop_back();
        ::close(file);
        throw LedgerError(ledger.string() + ": is held by another program" +
                          (pid.empty() ? "" : " (process " + pid + ")") +
                          "; one bridge at a time may run campaigns on it");
    }
    settings::FileDescriptor file_;
};

std::string joined(const std::vector<std::string>& words) {
    return fmt::format("{}", fmt::join(words, " "));
}

std::int64_t as_integer(std::uint64_t value, const std::string& path, const char* what) {
    if (value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
        throw settings::Error(path, 0, what, "must be below 2^63");
    return static_cast<std::int64_t>(value);
}

}  // namespace

struct Ledger::Impl {
    Impl(const std::filesystem::path& ledger, const LedgerOptions& options)
        : path(make_parent(ledger)), lock(ledger), database(ledger, LedgerDatabase::Access::write, options) {}

    void settle(Resumed& resumed);
    void enter(const Summary& summary, std::int64_t row);
    [[nodiscard]] std::optional<Summary> whole_summary(const std::filesystem::path& folder,
                                                       std::int64_t number) const;
    void need_campaign() const {
        if (id == 0) throw LedgerError(path.string() + ": no campaign is open");
    }

    std::filesystem::path path;
    Lock lock;
    LedgerDatabase database;
    Campaign campaign;
    std::int64_t id = 0;  // of the open campaign; 0: none
};

Ledger::Ledger(const std::filesystem::path& path, const LedgerOptions& options)
    : impl_(std::make_unique<Impl>(path, options)) {}
Ledger::~Ledger() = default;

Resumed Ledger::open_campaign(const Campaign& campaign, IfChanged changed) {
    const std::string path = impl_->path.string();
    if (campaign.name.empty() || campaign.name.find('/') != std::string::npos || campaign.name.front() == '.')
        throw settings::Error(
            path, 0, "",
            "'" + campaign.name + "' is no campaign name: it names a folder, so no '/' and no leading '.'");
    const std::int64_t seed = as_integer(campaign.seed, path, "seed");
    Resumed resumed;
    LedgerDatabase::Transaction transaction(impl_->database);
    Statement find = impl_->database.prepare(
        fmt::format("SELECT {}, id FROM campaigns WHERE name = ?1", LedgerDatabase::kCampaignColumns));
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
        if (!resumed.changed.empty() && changed == IfChanged::refuse) {
            throw settings::Error(
                path, 0, "",
                fmt::format("campaign '{}' was begun otherwise: {}; resume it as it was begun, or give "
                            "another name",
                            campaign.name, fmt::join(resumed.changed, "; ")));
        }
        impl_->database
            .prepare(
                "UPDATE campaigns SET scenario = ?2, seed = ?3, planned = ?4, config_hash = ?5, version = ?6 "
                "WHERE id = ?1")
            .bind(1, id)
            .bind(2, campaign.scenario)
            .bind(3, seed)
            .bind(4, campaign.planned)
            .bind(5, campaign.config_hash)
            .bind(6, campaign.version)
            .run();
    } else {
        resumed.created = true;
        Statement insert = impl_->database.prepare(
            "INSERT INTO campaigns (name, scenario, seed, planned, config_hash, version, created) "
            "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7) RETURNING id");
        insert.bind(1, campaign.name)
            .bind(2, campaign.scenario)
            .bind(3, seed)
            .bind(4, campaign.planned)
            .bind(5, campaign.config_hash)
            .bind(6, campaign.version)
            .bind(7, campaign.created);
        while (insert.step()) id = insert.integer(0);
    }
    impl_->campaign = campaign;
    impl_->id = id;
    impl_->settle(resumed);
    transaction.commit();
    return resumed;
}

void Ledger::Impl::settle(Resumed& resumed) {
    struct Left {
        std::int64_t row, number;
        std::string folder;
    };
    std::vector<Left> left;
    Statement running = database.prepare(
        "SELECT id, number, folder FROM maneuvers WHERE campaign = ?1 AND state = 'running' ORDER BY id");
    running.bind(1, id);
    while (running.step()) left.push_back({running.integer(0), running.integer(1), running.text(2)});
    for (const Left& one : left) {
        if (const auto summary = whole_summary(path.parent_path() / one.folder, one.number)) {
            enter(*summary, one.row);
            resumed.adopted.push_back(one.number);
        } else {
            database.prepare("UPDATE maneuvers SET state = 'unfinished' WHERE id = ?1")
                .bind(1, one.row)
                .run();
            resumed.unfinished.push_back(one.number);
        }
    }
}

std::optional<Summary> Ledger::Impl::whole_summary(const std::filesystem::path& folder,
                                                   std::int64_t number) const {
    try {
        Summary summary = read_summary(folder / "summary.json");
        if (summary.campaign == campaign.name && summary.number == number) return summary;
    } catch (const settings::Error&) {
        // Not there, or not whole: the maneuver did not come to its end.
    }
    return std::nullopt;
}

void Ledger::Impl::enter(const Summary& summary, std::int64_t row) {
    std::string sql =
        "UPDATE maneuvers SET state = ?2, scenario = ?3, outcome = ?4, started = ?5, standstill = ?6, "
        "cumulative_energy_J = ?7, faults = ?8, frames = ?9, frames_dropped = ?10, seed = ?11, version = "
        "?12, "
        "config_hash = ?13, out_of_tolerance = ?14";
    int parameter = 15;
    for (const FigureField& field : kFigureFields) sql += fmt::format(", {} = ?{}", field.key, parameter++);
    Statement update = database.prepare(sql + " WHERE id = ?1");
    update.bind(1, row)
        .bind(2, summary.outcome == kFinished ? "finished" : "aborted")
        .bind(3, summary.scenario)
        .bind(4, summary.outcome)
        .bind(5, summary.started)
        .bind(6, std::int64_t{summary.figures.standstill ? 1 : 0})
        .bind(7, summary.cumulative_energy_J)
        .bind(8, joined(summary.faults))
        .bind(9, as_integer(summary.frames, path.string(), "frames"))
        .bind(10, as_integer(summary.frames_dropped, path.string(), "frames_dropped"))
        .bind(11, as_integer(summary.seed, path.string(), "seed"))
        .bind(12, summary.version)
        .bind(13, summary.config_hash);
    if (summary.out_of_tolerance) update.bind(14, joined(*summary.out_of_tolerance));  // else NULL
    parameter = 15;
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
    Statement newest = impl_->database.prepare(
        "SELECT cumulative_energy_J FROM maneuvers WHERE campaign = ?1 AND state IN ('finished', 'aborted') "
        "AND cumulative_energy_J IS NOT NULL ORDER BY id DESC LIMIT 1");
    return newest.bind(1, impl_->id).step() ? newest.real(0) : 0.0;
}

std::int64_t Ledger::finished_count() const {
    impl_->need_campaign();
    Statement count =
        impl_->database.prepare("SELECT count(*) FROM maneuvers WHERE campaign = ?1 AND state = 'finished'");
    return count.bind(1, impl_->id).step() ? count.integer(0) : 0;
}

Attempt Ledger::begin(std::int64_t number, const std::string& started, std::optional<double> slip_reference) {
    impl_->need_campaign();
    LedgerDatabase::Transaction transaction(impl_->database);
    Statement last = impl_->database.prepare(
        "SELECT coalesce(max(attempt), 0), coalesce(max(state = 'finished'), 0), "
        "(SELECT count(*) FROM maneuvers WHERE campaign = ?1 AND state = 'running') "
        "FROM maneuvers WHERE campaign = ?1 AND number = ?2");
    last.bind(1, impl_->id).bind(2, number).step();
    const std::string where = impl_->path.string() + ": maneuver " + std::to_string(number);
    if (last.integer(1) != 0) throw LedgerError(where + " is finished already");
    if (last.integer(2) != 0) throw LedgerError(where + " cannot begin: another one is running");
    const std::int64_t attempt = last.integer(0) + 1;
    const Campaign& campaign = impl_->campaign;
    const std::string folder = attempt == 1 ? fmt::format("{}/{:04}", campaign.name, number)
                                            : fmt::format("{}/{:04}.{}", campaign.name, number, attempt);
    impl_->database
        .prepare(
            "INSERT INTO maneuvers (campaign, number, attempt, state, folder, scenario, started, seed, "
            "version, config_hash, slip_reference) "
            "VALUES (?1, ?2, ?3, 'running', ?4, ?5, ?6, ?7, ?8, ?9, ?10)")
        .bind(1, impl_->id)
        .bind(2, number)
        .bind(3, attempt)
        .bind(4, folder)
        .bind(5, campaign.scenario)
        .bind(6, started)
        .bind(7, static_cast<std::int64_t>(campaign.seed))
        .bind(8, campaign.version)
        .bind(9, campaign.config_hash)
        .bind(10, slip_reference.value_or(std::numeric_limits<double>::quiet_NaN()))  // NaN is NULL
        .run();
    transaction.commit();
    return {.number = number, .attempt = attempt, .folder = impl_->path.parent_path() / folder};
}

void Ledger::finish(const Summary& summary) {
    impl_->need_campaign();
    const std::string where = impl_->path.string() + ": maneuver " + std::to_string(summary.number);
    if (summary.campaign != impl_->campaign.name)
        throw LedgerError(where + " is of campaign '" + summary.campaign + "', not '" + impl_->campaign.name +
                          "'");
    LedgerDatabase::Transaction transaction(impl_->database);
    Statement running = impl_->database.prepare(
        "SELECT id FROM maneuvers WHERE campaign = ?1 AND number = ?2 AND state = 'running'");
    if (!running.bind(1, impl_->id).bind(2, summary.number).step())
        throw LedgerError(where + " is not running");
    impl_->enter(summary, running.integer(0));
    transaction.commit();
}

void Ledger::judge(std::int64_t number, const Health& health) {
    impl_->need_campaign();
    LedgerDatabase::Transaction transaction(impl_->database);
    Statement update = impl_->database.prepare(
        "UPDATE maneuvers SET health = ?3, health_statistic = ?4, health_reason = ?5, health_model = ?6 "
        "WHERE campaign = ?1 AND number = ?2 AND state = 'finished' RETURNING id");
    update.bind(1, impl_->id)
        .bind(2, number)
        .bind(3, std::string_view(name(health.state)))
        .bind(4, health.statistic)
        .bind(5, health.reason)
        .bind(6, health.model);
    if (!update.step())
        throw LedgerError(impl_->path.string() + ": maneuver " + std::to_string(number) +
                          " is not finished, so its brake cannot be judged");
    while (update.step()) {
    }
    transaction.commit();
}

void Ledger::mark_unfinished() {
    impl_->need_campaign();
    LedgerDatabase::Transaction transaction(impl_->database);
    impl_->database
        .prepare("UPDATE maneuvers SET state = 'unfinished' WHERE campaign = ?1 AND state = 'running'")
        .bind(1, impl_->id)
        .run();
    transaction.commit();
}

std::optional<std::string> held_by_another(const std::filesystem::path& path) {
    try {
        const Lock lock(path);
        return std::nullopt;
    } catch (const LedgerError& error) {
        return error.what();
    }
}

}  // namespace rig
