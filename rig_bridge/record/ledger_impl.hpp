/// Shared by the parts of the ledger.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/ledger_database.hpp"

namespace rig::record {

/// A separate lock file beside the ledger: closing any descriptor of the ledger itself would release SQLite's locks on it. The kernel frees the lock
/// when the process dies.
class LedgerLock {
  public:
    /// Throws LedgerError naming the process that holds it.
    LedgerLock(const std::filesystem::path& ledger, const settings::Storage& storage) : file_(take(ledger, storage)) {}

  private:
    [[nodiscard]] static std::unique_ptr<settings::File> take(const std::filesystem::path& ledger, const settings::Storage& storage);
    std::unique_ptr<settings::File> file_;
};

struct Ledger::Impl {
    Impl(const std::filesystem::path& ledger, const LedgerOptions& options);

    void settle(Resumed& resumed, const MeterLog& meter);
    void enter(const Summary& summary, std::int64_t row, std::string_view state);
    void leave_unfinished(std::int64_t row, const std::optional<Summary>& known);
    [[nodiscard]] double cumulative_J() const;
    [[nodiscard]] std::optional<Summary> whole_summary(const std::filesystem::path& folder, std::int64_t number) const;
    void need_campaign() const {
        if (id == 0) throw LedgerError(path.string() + ": no campaign is open");
    }

    std::shared_ptr<const settings::Storage> storage;
    std::filesystem::path path;
    LedgerLock lock;
    LedgerDatabase database;
    Campaign campaign;
    std::int64_t id = 0;  // of the open campaign; 0: none
};

}  // namespace rig::record
