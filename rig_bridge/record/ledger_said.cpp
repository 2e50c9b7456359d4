/// What people and the wear model say of maneuvers that are in the ledger.

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "rig_bridge/record/ledger_impl.hpp"

namespace rig::record {

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
        throw LedgerError(impl_->path.string() + ": maneuver " + std::to_string(number) + " is not finished, so its brake cannot be judged");
    while (update.step()) {
    }
    transaction.commit();
}

void Ledger::amend(std::int64_t number, std::int64_t attempt, const Amendment& amendment) {
    impl_->need_campaign();
    const std::string where = fmt::format("{}: maneuver {}, attempt {}", impl_->path.string(), number, attempt);
    if (amendment.who.empty() || amendment.why.empty()) throw LedgerError(where + " is amended only with who and why");
    LedgerDatabase::Transaction transaction(impl_->database);
    const std::vector<LedgerRow> rows = read_rows(impl_->database, impl_->path, impl_->campaign.name, impl_->id);
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const LedgerRow& one) { return one.attempt.number == number && one.attempt.attempt == attempt; });
    if (row == rows.end()) throw LedgerError(where + " is not in campaign '" + impl_->campaign.name + "'");
    if (std::any_of(rows.begin(), rows.end(), [](const LedgerRow& one) { return one.state == RowState::running; }))
        throw LedgerError(where + " cannot be amended while a maneuver is running; resume the campaign first");
    impl_->database
        .prepare(
            "INSERT INTO amendments (maneuver, newest, before_J, counted_J, who, made, why) SELECT id, "
            "(SELECT max(id) FROM maneuvers WHERE campaign = ?1), ?4, ?5, ?6, ?7, ?8 FROM maneuvers "
            "WHERE campaign = ?1 AND number = ?2 AND attempt = ?3")
        .bind(1, impl_->id)
        .bind(2, number)
        .bind(3, attempt)
        .bind(4, row->counted_J)
        .bind(5, amendment.counted_J)
        .bind(6, amendment.who)
        .bind(7, amendment.made)
        .bind(8, amendment.why)
        .run();
    transaction.commit();
}

void Ledger::note(std::int64_t number, std::int64_t attempt, const Note& note) {
    impl_->need_campaign();
    const std::string where = fmt::format("{}: maneuver {}, attempt {}", impl_->path.string(), number, attempt);
    if (note.who.empty() || note.text.empty()) throw LedgerError(where + " is noted only with who and what");
    check_text("--who", note.who);
    check_text(note.field, note.text);
    if (std::none_of(kSpecimenFields.begin(), kSpecimenFields.end(), [&](const SpecimenField& field) { return note.field == field.key; }))
        throw LedgerError(where + ": nothing is called '" + note.field + "'");
    LedgerDatabase::Transaction transaction(impl_->database);
    Statement insert = impl_->database.prepare(
        "INSERT INTO said (maneuver, field, text, who, made) SELECT id, ?4, ?5, ?6, ?7 FROM maneuvers "
        "WHERE campaign = ?1 AND number = ?2 AND attempt = ?3 RETURNING id");
    insert.bind(1, impl_->id).bind(2, number).bind(3, attempt).bind(4, note.field).bind(5, note.text).bind(6, note.who).bind(7, note.made);
    if (!insert.step()) throw LedgerError(where + " is not in campaign '" + impl_->campaign.name + "'");
    while (insert.step()) {
    }
    transaction.commit();
}

}  // namespace rig::record
