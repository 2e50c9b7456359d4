#include "rig_bridge/record/ledger_lock.hpp"

#include <unistd.h>

#include <string>
#include <system_error>
#include <utility>
#include <variant>

#include "rig_bridge/record/ledger.hpp"

namespace rig::record {

namespace {

std::string lock_file(const std::filesystem::path& ledger) {
    return ledger.string() + "-held";
}

}  // namespace

std::unique_ptr<HeldFile> LedgerLock::take(const std::filesystem::path& ledger) {
    try {
        auto held = hold(lock_file(ledger), "process " + std::to_string(getpid()));
        if (auto* const mine = std::get_if<std::unique_ptr<HeldFile>>(&held)) return std::move(*mine);
        const std::string& who = std::get<HeldBy>(held).who;
        throw LedgerError(ledger.string() + ": is held by another program" + (who.empty() ? "" : " (" + who + ")") +
                          "; one bridge at a time may run campaigns on it");
    } catch (const std::system_error& error) {
        throw LedgerError(error.what());
    }
}

std::optional<std::string> held_by_another(const std::filesystem::path& path) {
    try {
        const LedgerLock lock(path);
        return std::nullopt;
    } catch (const LedgerError& error) {
        return error.what();
    }
}

bool is_held(const std::filesystem::path& path) {
    return held_by(lock_file(path)).has_value();
}

}  // namespace rig::record
