#include "rig_bridge/record/ledger_database.hpp"

#include <array>
#include <cstring>
#include <limits>

#include "firmware/host/settings/error.hpp"
#include "rig_bridge/record/figure_fields.hpp"

namespace rig::record {

namespace {

std::filesystem::path directory_of(const std::filesystem::path& path) {
    return path.has_parent_path() ? path.parent_path() : ".";
}

constexpr std::int64_t kApplicationId = 0x41534c47;  // "ASLG"

[[noreturn]] void fail(sqlite3* database, const std::string& path, int code) {
    if (code == SQLITE_IOERR_DIR_FSYNC)
        throw LedgerInDoubt(path + ": the disk refused the last step, and the operation may be in the ledger or not; the next start sees which");
    std::string why;
    switch (code & 0xFF) {
        case SQLITE_FULL:
            why = "the disk is full; the ledger is as it was before";
            break;
        case SQLITE_IOERR:
            why = "the disk refused it; the ledger is as it was before";
            break;
        case SQLITE_BUSY:
            why = "another program keeps it locked";
            break;
        case SQLITE_CORRUPT:
            why = "is damaged; `sqlite3 FILE .recover` may save what is left";
            break;
        case SQLITE_NOMEM:  // a ledger is small: a size in it is wrong
            why =
                "is damaged, or the machine has no memory left; `sqlite3 FILE .recover` may save what is "
                "left";
            break;
        case SQLITE_READONLY:
        case SQLITE_CANTOPEN:
        case SQLITE_PERM:
            why = "cannot be opened or written: check that file and directory are yours to write";
            break;
        default:
            why = "cannot be read or written";
            break;
    }
    why += std::string(" (") + (database != nullptr ? sqlite3_errmsg(database) : sqlite3_errstr(code));
    throw LedgerError(path + ": " + why + ")");
}

/// Element i migrates schema i + 1 to schema i + 2. A new ledger is schema 1 migrated to the newest, so that each schema is made in one way only.
constexpr std::array<const char*, kLedgerSchema - 1> kMigrations{
    R"(
ALTER TABLE maneuvers ADD COLUMN health TEXT NOT NULL DEFAULT 'unknown'
    CHECK (health IN ('unknown', 'healthy', 'suspect', 'abnormal'));
ALTER TABLE maneuvers ADD COLUMN health_statistic REAL;
ALTER TABLE maneuvers ADD COLUMN health_reason TEXT NOT NULL DEFAULT '';
ALTER TABLE maneuvers ADD COLUMN health_model TEXT NOT NULL DEFAULT '';
)", "ALTER TABLE maneuvers ADD COLUMN slip_reference REAL;", "ALTER TABLE maneuvers ADD COLUMN out_of_tolerance TEXT;",
    R"(
ALTER TABLE maneuvers ADD COLUMN warnings TEXT NOT NULL DEFAULT '';
CREATE TABLE amendments (
    id INTEGER PRIMARY KEY,
    maneuver INTEGER NOT NULL REFERENCES maneuvers (id),
    newest INTEGER NOT NULL REFERENCES maneuvers (id),  -- of the campaign, when it was made
    before_J REAL NOT NULL,
    counted_J REAL NOT NULL,
    who TEXT NOT NULL CHECK (who <> ''),
    made TEXT NOT NULL,
    why TEXT NOT NULL CHECK (why <> '')
) STRICT;
)",
    R"(
ALTER TABLE campaigns ADD COLUMN brake_serial TEXT NOT NULL DEFAULT '';
ALTER TABLE campaigns ADD COLUMN disc_serial TEXT NOT NULL DEFAULT '';
ALTER TABLE campaigns ADD COLUMN tyre_serial TEXT NOT NULL DEFAULT '';
ALTER TABLE campaigns ADD COLUMN specimen_serial TEXT NOT NULL DEFAULT '';
ALTER TABLE campaigns ADD COLUMN operator TEXT NOT NULL DEFAULT '';
ALTER TABLE campaigns ADD COLUMN notes TEXT NOT NULL DEFAULT '';
ALTER TABLE maneuvers ADD COLUMN brake_serial TEXT NOT NULL DEFAULT '';
ALTER TABLE maneuvers ADD COLUMN disc_serial TEXT NOT NULL DEFAULT '';
ALTER TABLE maneuvers ADD COLUMN tyre_serial TEXT NOT NULL DEFAULT '';
ALTER TABLE maneuvers ADD COLUMN specimen_serial TEXT NOT NULL DEFAULT '';
ALTER TABLE maneuvers ADD COLUMN operator TEXT NOT NULL DEFAULT '';
ALTER TABLE maneuvers ADD COLUMN notes TEXT NOT NULL DEFAULT '';
CREATE TABLE said (  -- of a maneuver's specimen, afterwards
    id INTEGER PRIMARY KEY,
    maneuver INTEGER NOT NULL REFERENCES maneuvers (id),
    field TEXT NOT NULL
        CHECK (field IN ('brake_serial', 'disc_serial', 'tyre_serial', 'specimen_serial', 'operator', 'notes')),
    text TEXT NOT NULL CHECK (text <> ''),
    who TEXT NOT NULL CHECK (who <> ''),
    made TEXT NOT NULL
) STRICT;
)",
    R"(
CREATE TABLE noted (  -- of a maneuver afterwards: its specimen, or the wear that was read after it
    id INTEGER PRIMARY KEY,
    maneuver INTEGER NOT NULL REFERENCES maneuvers (id),
    field TEXT NOT NULL
        CHECK (field IN ('brake_serial', 'disc_serial', 'tyre_serial', 'specimen_serial', 'operator', 'notes',
            'lining_worn', 'tread_worn')),
    text TEXT NOT NULL CHECK (text <> ''),
    who TEXT NOT NULL CHECK (who <> ''),
    made TEXT NOT NULL
) STRICT;
INSERT INTO noted SELECT * FROM said;
DROP TABLE said;
)",
};

/// The tables of schema 1.
std::string first_schema() {
    std::string figures;
    for (const FigureField& field : kFigureFields) figures += std::string(field.key) + " REAL,\n";
    return R"(
CREATE TABLE campaigns (
    id INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    scenario TEXT NOT NULL,
    seed INTEGER NOT NULL,
    planned INTEGER NOT NULL CHECK (planned >= 0),
    config_hash TEXT NOT NULL,
    version TEXT NOT NULL,
    created TEXT NOT NULL
) STRICT;
CREATE TABLE maneuvers (
    id INTEGER PRIMARY KEY,
    campaign INTEGER NOT NULL REFERENCES campaigns (id),
    number INTEGER NOT NULL CHECK (number >= 1),
    attempt INTEGER NOT NULL CHECK (attempt >= 1),
    state TEXT NOT NULL CHECK (state IN ('running', 'finished', 'aborted', 'unfinished')),
    folder TEXT NOT NULL,
    scenario TEXT NOT NULL,
    outcome TEXT,
    started TEXT NOT NULL,
)" + figures +
           R"(    standstill INTEGER CHECK (standstill IN (0, 1)),
    cumulative_energy_J REAL,
    faults TEXT,
    frames INTEGER,
    frames_dropped INTEGER,
    seed INTEGER NOT NULL,
    version TEXT NOT NULL,
    config_hash TEXT NOT NULL,
    UNIQUE (campaign, number, attempt)
) STRICT;
CREATE UNIQUE INDEX finished_once ON maneuvers (campaign, number) WHERE state = 'finished';
CREATE UNIQUE INDEX one_running ON maneuvers (campaign) WHERE state = 'running';
)";
}

}  // namespace

Statement::Statement(sqlite3* database, const std::string& path, std::string_view sql) : database_(database), path_(path) {
    sqlite3_stmt* statement = nullptr;
    const int code = sqlite3_prepare_v2(database, sql.data(), static_cast<int>(sql.size()), &statement, nullptr);
    if (code != SQLITE_OK) fail(database, path, code);
    statement_.reset(statement);
}

Statement& Statement::bind(int index, std::string_view text) {
    const int code = sqlite3_bind_text(statement_.get(), index, text.data(), static_cast<int>(text.size()),
                                       SQLITE_TRANSIENT);  // NOLINT: SQLite's own macro casts -1 to a pointer
    if (code != SQLITE_OK) fail(database_, path_, code);
    return *this;
}

Statement& Statement::bind(int index, std::int64_t value) {
    if (const int code = sqlite3_bind_int64(statement_.get(), index, value); code != SQLITE_OK) fail(database_, path_, code);
    return *this;
}

Statement& Statement::bind(int index, double value) {
    if (const int code = sqlite3_bind_double(statement_.get(), index, value); code != SQLITE_OK) fail(database_, path_, code);
    return *this;
}

bool Statement::step() {
    const int code = sqlite3_step(statement_.get());
    if (code == SQLITE_ROW) return true;
    if (code != SQLITE_DONE) fail(database_, path_, code);
    return false;
}

std::string Statement::text(int column) const {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
    if (text == nullptr) return {};
    return {text, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

double Statement::real(int column) const {
    return null(column) ? std::numeric_limits<double>::quiet_NaN() : sqlite3_column_double(statement_.get(), column);
}

LedgerDatabase::LedgerDatabase(const std::filesystem::path& path, Access access, const LedgerOptions& options) : path_(path.string()) {
    const int flags = access == Access::write ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READWRITE;
    if (access == Access::read && !std::filesystem::exists(options.storage->status(path))) throw settings::Error(path_, 0, "", "no such ledger");
    sqlite3* database = nullptr;
    const int code = sqlite3_open_v2(path_.c_str(), &database, flags | SQLITE_OPEN_NOMUTEX, options.storage->sqlite_vfs());
    database_.reset(database);
    if (code != SQLITE_OK) fail(database, path_, code);
    sqlite3_extended_result_codes(database, 1);
    sqlite3_busy_timeout(database, options.busy_timeout_ms);
    check_identity(access);
    if (access == Access::read) {
        run("PRAGMA query_only = 1");
        return;
    }
    // What is read here is believed. Its commit may have lacked only the sync of the journal's removal, without which a power cut undoes it.
    if (options.durable)
        if (const int error = options.storage->sync_directory(directory_of(path)); error != 0) throw LedgerError(path_ + ": " + std::strerror(error));
    run(options.durable ? "PRAGMA synchronous = EXTRA" : "PRAGMA synchronous = OFF");
    run("PRAGMA foreign_keys = 1");
}

void LedgerDatabase::run(const char* sql) const {
    const int code = sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr);
    if (code != SQLITE_OK) fail(database_.get(), path_, code);
}

std::int64_t LedgerDatabase::pragma(const char* name) const {
    Statement statement = prepare(std::string("PRAGMA ") + name);
    return statement.step() ? statement.integer(0) : 0;
}

void LedgerDatabase::check_identity(Access access) {
    std::int64_t application = 0;
    std::int64_t version = 0;
    std::int64_t tables = 0;
    {
        sqlite3_stmt* raw = nullptr;
        const int code = sqlite3_prepare_v2(database_.get(), "SELECT count(*) FROM sqlite_schema", -1, &raw, nullptr);
        sqlite3_finalize(raw);
        if (code == SQLITE_NOTADB) throw settings::Error(path_, 0, "", "is no SQLite file, so it is no campaign ledger");
    }
    {
        Statement count = prepare("SELECT count(*) FROM sqlite_schema");
        if (count.step()) tables = count.integer(0);
    }
    application = pragma("application_id");
    version = pragma("user_version");
    if (tables == 0 && application == 0 && version == 0 && access == Access::write) {
        make_schema();
        return;
    }
    if (application != kApplicationId) throw settings::Error(path_, 0, "", "is an SQLite file of another program, not a campaign ledger");
    if (version < 1 || version > kLedgerSchema) {
        throw settings::Error(path_, 0, "user_version",
                              "ledger of schema " + std::to_string(version) + "; this program knows schema " + std::to_string(kLedgerSchema) +
                                  " and older" + (version > kLedgerSchema ? ": use the newer program that made it" : ""));
    }
    {
        Statement check = prepare("PRAGMA quick_check(1)");
        if (check.step() && check.text(0) != "ok")
            throw LedgerError(path_ + ": is damaged; `sqlite3 FILE .recover` may save what is left (" + check.text(0) + ")");
    }
    if (version == kLedgerSchema) return;
    if (access == Access::read) copy_to_memory();
    Transaction transaction(*this);
    migrate(version);
    transaction.commit();
}

void LedgerDatabase::make_schema() const {
    Transaction transaction(*this);
    run(first_schema().c_str());
    run(("PRAGMA application_id = " + std::to_string(kApplicationId)).c_str());
    migrate(1);
    transaction.commit();
}

void LedgerDatabase::migrate(std::int64_t from) const {
    for (auto i = static_cast<std::size_t>(from - 1); i < kMigrations.size(); ++i) run(kMigrations.at(i));
    run(("PRAGMA user_version = " + std::to_string(kLedgerSchema)).c_str());
}

void LedgerDatabase::copy_to_memory() {
    sqlite3* memory = nullptr;
    int code = sqlite3_open(":memory:", &memory);
    std::unique_ptr<sqlite3, Closer> copy(memory);
    if (code != SQLITE_OK) fail(memory, path_, code);
    sqlite3_extended_result_codes(memory, 1);
    if (sqlite3_backup* const backup = sqlite3_backup_init(memory, "main", database_.get(), "main")) {
        sqlite3_backup_step(backup, -1);
        sqlite3_backup_finish(backup);
    }
    code = sqlite3_extended_errcode(memory);
    if (code != SQLITE_OK) fail(memory, path_, code);
    database_ = std::move(copy);
}

LedgerDatabase::Transaction::Transaction(const LedgerDatabase& database) : database_(database) {
    database_.run("BEGIN IMMEDIATE");
}

LedgerDatabase::Transaction::~Transaction() {
    if (open_) sqlite3_exec(database_.database_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void LedgerDatabase::Transaction::commit() {
    database_.run("COMMIT");
    open_ = false;
}

}  // namespace rig::record
