/// One bridge at a time writes a ledger.
#pragma once

#include <filesystem>

#include "config/reader/file_descriptor.hpp"

namespace rig {

/// A file of its own beside the ledger: SQLite's locks on the ledger itself would be lost when any descriptor of it is closed. The kernel
/// frees it when the process dies.
class LedgerLock {
  public:
    /// Throws LedgerError naming the process that has it.
    explicit LedgerLock(const std::filesystem::path& ledger) : file_(take(ledger)) {}

  private:
    [[nodiscard]] static int take(const std::filesystem::path& ledger);
    settings::FileDescriptor file_;
};

}  // namespace rig
