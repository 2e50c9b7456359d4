/// SQLite access of the ledger: owning statements, errors that name the file.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "rig_bridge/record/ledger.hpp"

namespace rig::record {

/// One prepared statement. As in SQLite, parameters count from 1 and columns from 0.
class Statement {
  public:
    Statement(sqlite3* database, const std::string& path, std::string_view sql);

    Statement& bind(int index, std::string_view text);
    Statement& bind(int index, std::int64_t value);
    Statement& bind(int index, double value);
    /// The parameters from the first one on, in their order.
    template <typename... Values>
    Statement& bind_all(const Values&... values) {
        int index = 1;
        (bind(index++, values), ...);
        return *this;
    }

    /// Advances to the next row; false after the last. Throws LedgerError.
    bool step();
    void run() {
        while (step()) {
        }
    }

    [[nodiscard]] std::string text(int column) const;
    [[nodiscard]] std::int64_t integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
    /// NULL is returned as NaN.
    [[nodiscard]] double real(int column) const;
    [[nodiscard]] bool null(int column) const { return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL; }

  private:
    struct Finalizer {
        void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
    };
    sqlite3* database_;
    const std::string& path_;
    std::unique_ptr<sqlite3_stmt, Finalizer> statement_;
};

class LedgerDatabase {
  public:
    enum class Access : std::uint8_t { read, write };

    /// Checks that the file is a ledger. `write`: creates one if the file is missing or empty, and upgrades an older schema in one transaction.
    /// `read`: an older schema is copied to memory and upgraded there.
    LedgerDatabase(const std::filesystem::path& path, Access access, const LedgerOptions& options);

    [[nodiscard]] Statement prepare(std::string_view sql) const { return {database_.get(), path_, sql}; }
    void run(const char* sql) const;
    [[nodiscard]] const std::string& path() const { return path_; }

    /// A campaign from a row of SELECT kCampaignColumns, and how many columns those are.
    static constexpr std::string_view kCampaignColumns =
        "name, scenario, seed, planned, config_hash, version, created, brake_serial, disc_serial, "
        "tyre_serial, specimen_serial, operator, notes";
    static constexpr int kCampaignColumnCount = 7 + static_cast<int>(kSpecimenFields.size());
    [[nodiscard]] static Campaign read_campaign(const Statement& row);

    /// Sum of the amendments to add to a row's cumulative energy: amendments of this and earlier rows, made after the row was entered. Rows entered
    /// later already include them.
    static constexpr std::string_view kAmended_J =
        "coalesce((SELECT sum(a.counted_J - a.before_J) FROM amendments a JOIN maneuvers m ON m.id = "
        "a.maneuver "
        "WHERE m.campaign = maneuvers.campaign AND a.maneuver <= maneuvers.id AND maneuvers.id <= a.newest), "
        "0.0)";

    /// Rolls back unless committed.
    class Transaction {
      public:
        explicit Transaction(const LedgerDatabase& database);
        ~Transaction();
        Transaction(const Transaction&) = delete;
        Transaction& operator=(const Transaction&) = delete;
        void commit();

      private:
        const LedgerDatabase& database_;
        bool open_ = true;
    };

  private:
    struct Closer {
        void operator()(sqlite3* database) const { sqlite3_close(database); }
    };
    void check_identity(Access access);
    void make_schema() const;
    void migrate(std::int64_t from) const;
    void copy_to_memory();
    [[nodiscard]] std::int64_t pragma(const char* name) const;

    std::string path_;
    std::unique_ptr<sqlite3, Closer> database_;
};

/// Separates the warnings of a row.
inline constexpr std::string_view kWarningsApart = "; ";

/// Rows of the campaign with this id, oldest first.
[[nodiscard]] std::vector<LedgerRow> read_rows(const LedgerDatabase& database, const std::filesystem::path& ledger, const std::string& campaign,
                                               std::int64_t id);

inline constexpr std::int64_t kLedgerSchema = 7;

}  // namespace rig::record
