#include <fmt/core.h>

#include <chrono>
#include <optional>
#include <string>

#include "firmware/host/settings/error.hpp"
#include "rig_bridge/bridge/hold.hpp"
#include "rig_bridge/bridge/verbs.hpp"
#include "rig_bridge/bridge/wall_clock.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/specimen.hpp"
#include "rig_bridge/replay/campaign_source.hpp"

namespace rig::bridge {

namespace {

/// `wanted`, or the only attempt at the maneuver: an energy or a reading at the wrong one of several would count there.
std::int64_t chosen_attempt(const std::filesystem::path& ledger, const std::string& campaign, std::int64_t number,
                            std::optional<std::int64_t> wanted) {
    if (wanted) return *wanted;
    std::string all;
    std::int64_t only = 0;
    int count = 0;
    for (const record::LedgerRow& row : record::read_ledger(ledger, campaign)) {
        if (row.attempt.number != number) continue;
        only = row.attempt.attempt;
        ++count;
        const bool aborted = row.state == record::RowState::aborted;
        all += fmt::format("{}{} {}{}", all.empty() ? "" : ", ", only, name(row.state), aborted ? " (" + row.summary.outcome + ")" : std::string());
    }
    if (count == 0) throw settings::Error(ledger.string(), 0, "--maneuver", fmt::format("{} is not in campaign '{}'", number, campaign));
    if (count > 1)
        throw settings::Error(ledger.string(), 0, "--maneuver", fmt::format("{} has {} attempts; choose one with --attempt: {}", number, count, all));
    return only;
}

}  // namespace

int amend_ledger(const AmendCommand& command) {
    const std::filesystem::path file = ledger_file(command.directory);
    const std::string campaign = replay::chosen_campaign(file, command.campaign);
    const std::int64_t attempt = chosen_attempt(file, campaign, command.number, command.attempt);
    record::Ledger ledger(file);
    ledger.choose(campaign);
    const double before_J = ledger.cumulative_energy_J();
    ledger.amend(command.number, attempt,
                 {.counted_J = command.energy_MJ * 1e6, .who = command.who, .made = iso_8601(std::chrono::system_clock::now()), .why = command.why});
    fmt::print("campaign {}: maneuver {}, attempt {} counts {:.6g} MJ; {:.6g} MJ in all, before {:.6g} MJ\n", campaign, command.number, attempt,
               command.energy_MJ, ledger.cumulative_energy_J() * 1e-6, before_J * 1e-6);
    return 0;
}

int note_in_ledger(const NoteCommand& command) {
    const std::filesystem::path file = ledger_file(command.directory);
    const std::string campaign = replay::chosen_campaign(file, command.campaign);
    const std::string now = iso_8601(std::chrono::system_clock::now());
    std::string said = to_text(command.said);
    const std::int64_t attempt = chosen_attempt(file, campaign, command.number, command.attempt);
    record::Ledger ledger(file);
    ledger.choose(campaign);
    record::check_texts(command.said);
    for (const record::SpecimenField& field : record::kSpecimenFields)
        if (const std::string& text = command.said.*field.value; !text.empty())
            ledger.note(command.number, attempt, {.field = field.key, .text = text, .who = command.who, .made = now});
    for (std::size_t i = 0; i < command.worn.size(); ++i) {
        const std::string& text = command.worn.at(i);
        if (text.empty()) continue;
        const std::string field = record::kWearReadingFields.at(i).key;
        ledger.note(command.number, attempt, {.field = field, .text = text, .who = command.who, .made = now});
        said += fmt::format("{}{} {}", said.empty() ? "" : ", ", field, text);
    }
    fmt::print("campaign {}: maneuver {}, attempt {}: {}, says {}\n", campaign, command.number, attempt, said, command.who);
    return 0;
}

int change_hold(const HoldCommand& command) {
    const std::filesystem::path& place = command.directory;
    if (!std::filesystem::exists(ledger_file(place))) throw UsageError(place.string() + ": no campaign is here: no " + ledger_file({}).string());
    if (!command.hold) {
        fmt::print("{}: {}\n", place.string(), remove_hold(place) ? "goes on" : "was not held");
        return 0;
    }
    record::check_text("--who", command.who);
    record::check_text("--why", command.why);
    const auto before = read_hold(place);
    if (!before) write_hold(place, {.who = command.who, .since = iso_8601(std::chrono::system_clock::now()), .why = command.why});
    fmt::print("{}: {}; {}\n", place.string(), to_text(*read_hold(place)),
               before ? "it was held already" : "a maneuver that runs comes to its end first");
    return 0;
}

}  // namespace rig::bridge
