/// What ledger.cpp and ledger_said.cpp share.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/ledger_database.hpp"
#include "rig_bridge/record/ledger_lock.hpp"

namespace rig::record {

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

    std::filesystem::path path;
    LedgerLock lock;
    LedgerDatabase database;
    Campaign campaign;
    std::int64_t id = 0;  // of the open campaign; 0: none
};

}  // namespace rig::record
