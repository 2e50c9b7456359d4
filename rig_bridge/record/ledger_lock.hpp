/// One bridge at a time writes a ledger.
#pragma once

#include <filesystem>
#include <memory>

#include "rig_bridge/record/held_file.hpp"

namespace rig::record {

/// A file of its own beside the ledger: SQLite's locks on the ledger itself would be lost when any descriptor of it is closed. The kernel
/// frees it when the process dies.
class LedgerLock {
  public:
    /// Throws LedgerError naming the process that has it.
    explicit LedgerLock(const std::filesystem::path& ledger) : file_(take(ledger)) {}

  private:
    [[nodiscard]] static std::unique_ptr<HeldFile> take(const std::filesystem::path& ledger);
    std::unique_ptr<HeldFile> file_;
};

}  // namespace rig::record
