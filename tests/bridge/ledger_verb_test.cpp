#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rig_bridge/bridge/verbs.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

namespace {

using rig::record::LedgerRow;

/// A campaign whose maneuver 2 was aborted and run again; a megajoule a row.
struct Campaign {
    Campaign() {
        rig::record::Ledger ledger(rig::bridge::ledger_file(directory));
        ledger.open_campaign(
            {.name = "brake7", .scenario = "endurance", .seed = 7, .planned = 9, .config_hash = "abc", .version = "0.1.0", .created = "t0"},
            rig::record::IfChanged::reject);
        for (const auto& [number, outcome] : {std::pair{1, "finished"}, {2, "load_lost"}, {2, "finished"}}) {
            rig::record::Summary s;
            s.campaign = "brake7";
            s.number = ledger.begin(number, "t1").number;
            s.outcome = outcome;
            s.figures.energy_brake_J = 1e6;
            s.cumulative_energy_J = ledger.cumulative_energy_J() + counted_energy_J(s);
            ledger.finish(s);
        }
    }
    [[nodiscard]] std::vector<LedgerRow> rows() const { return rig::record::read_ledger(rig::bridge::ledger_file(directory), "brake7"); }
    [[nodiscard]] rig::bridge::AmendCommand amend(std::int64_t number, std::optional<std::int64_t> attempt) const {
        return {.directory = directory, .campaign = {}, .number = number, .attempt = attempt, .energy_MJ = 0.5, .who = "Kim", .why = "its log"};
    }
    [[nodiscard]] rig::bridge::NoteCommand note(std::int64_t number, std::optional<std::int64_t> attempt) const {
        return {.directory = directory, .campaign = {}, .number = number, .attempt = attempt, .who = "Kim", .said = {}, .worn = {"0.31"}};
    }

    can_test::TempDir dir;
    std::filesystem::path directory = dir.write("x", "").parent_path();
};

}  // namespace

TEST_CASE("Of several attempts none is amended or noted unless it is named", "[BRG-261][BRG-430]") {
    const Campaign campaign;
    const auto choose = ContainsSubstring("--maneuver: 2 has 2 attempts; choose one with --attempt: 1 aborted (load_lost), 2 finished");
    CHECK_THROWS_WITH(rig::bridge::amend_ledger(campaign.amend(2, {})), choose);
    CHECK_THROWS_WITH(rig::bridge::note_in_ledger(campaign.note(2, {})), choose);
    CHECK_THROWS_WITH(rig::bridge::amend_ledger(campaign.amend(3, {})), ContainsSubstring("--maneuver: 3 is not in campaign 'brake7'"));
    CHECK_THROWS_WITH(rig::bridge::note_in_ledger(campaign.note(3, {})), ContainsSubstring("--maneuver: 3 is not in campaign 'brake7'"));
    for (const LedgerRow& row : campaign.rows()) CHECK((row.amendments.empty() && row.notes.empty() && row.counted_J == 1e6));
}

TEST_CASE("The only attempt, or the one that is named, is amended and noted", "[BRG-261]") {
    const Campaign campaign;
    CHECK(rig::bridge::amend_ledger(campaign.amend(1, {})) == 0);
    CHECK(rig::bridge::note_in_ledger(campaign.note(1, {})) == 0);
    CHECK(rig::bridge::amend_ledger(campaign.amend(2, 2)) == 0);
    CHECK(rig::bridge::note_in_ledger(campaign.note(2, 1)) == 0);
    const std::vector<LedgerRow> rows = campaign.rows();
    REQUIRE(rows.size() == 3);
    CHECK((rows[0].counted_J == 0.5e6 && rows[0].worn.lining == 0.31));
    CHECK((rows[1].counted_J == 1e6 && rows[1].worn.lining == 0.31));
    CHECK((rows[2].counted_J == 0.5e6 && rows[2].notes.empty()));
}
