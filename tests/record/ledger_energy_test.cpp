// The cumulative energy of a ledger: what counts in it, what does not, and what people say about it.
#include <sqlite3.h>

#include <cmath>
#include <string>

#include "firmware/host/settings/error.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using namespace rig;
using can_test::TempDir;

namespace {

std::filesystem::path ledger_in(const TempDir& dir) {
    return dir.write("x", "").parent_path() / "campaign.sqlite";
}

rig::record::Campaign brake7() {
    return {.name = "brake7", .scenario = "endurance", .seed = 7, .planned = 9, .config_hash = "abc", .version = "0.1.0", .created = "t0"};
}

rig::record::Summary of(std::int64_t number, double energy_J, const rig::record::Ledger& ledger, const std::string& outcome = "finished") {
    rig::record::Summary s;
    s.campaign = "brake7";
    s.number = number;
    s.scenario = "endurance";
    s.outcome = outcome;
    s.started = "t1";
    s.figures.energy_brake_J = energy_J;
    s.cumulative_energy_J = ledger.cumulative_energy_J() + energy_J;
    return s;
}

void run(rig::record::Ledger& ledger, double energy_J) {
    const std::int64_t number = ledger.begin(*ledger.next_number(), "t1").number;
    ledger.finish(of(number, energy_J, ledger));
}

std::vector<double> sums(const std::filesystem::path& path) {
    std::vector<double> all;
    for (const rig::record::LedgerRow& row : rig::record::read_ledger(path, "brake7")) all.push_back(row.summary.cumulative_energy_J);
    return all;
}

/// Every cell of `maneuvers`, past our code.
std::string table(const std::filesystem::path& path) {
    sqlite3* database = nullptr;
    REQUIRE(sqlite3_open(path.c_str(), &database) == SQLITE_OK);
    std::string text;
    const auto add = [](void* out, int count, char** cells, char**) {
        for (int i = 0; i < count; ++i) static_cast<std::string*>(out)->append(cells[i] == nullptr ? "NULL" : cells[i]).append("|");
        return 0;
    };
    REQUIRE(sqlite3_exec(database, "SELECT * FROM maneuvers ORDER BY id", add, &text, nullptr) == SQLITE_OK);
    sqlite3_close(database);
    return text;
}

}  // namespace

TEST_CASE("what a dead bridge had braked counts once its log was metered, and the number is run again", "[BRG-220]") {
    const TempDir dir;
    const auto path = ledger_in(dir);
    {
        rig::record::Ledger ledger(path);
        ledger.open_campaign(brake7(), rig::record::IfChanged::reject);
        run(ledger, 2e6);
        static_cast<void>(ledger.begin(2, "t2"));  // and here it dies
    }
    {
        rig::record::Ledger ledger(path);
        const rig::record::Resumed resumed = ledger.open_campaign(brake7(), rig::record::IfChanged::reject,
                                                                  [&](const rig::record::Attempt& left) -> std::optional<rig::record::Summary> {
                                                                      CHECK(left.number == 2);
                                                                      CHECK(left.folder == path.parent_path() / "brake7/0002");
                                                                      rig::record::Summary s;
                                                                      s.outcome = "unfinished";
                                                                      s.figures.energy_brake_J = 1.5e6;
                                                                      s.figures.brake_on_mps = 50.0;
                                                                      s.warnings = {"log_damaged: unfinished_line 1"};
                                                                      return s;
                                                                  });
        CHECK(resumed.unfinished == std::vector<std::int64_t>{2});
        CHECK(ledger.cumulative_energy_J() == 3.5e6);
        CHECK(*ledger.next_number() == 2);
        run(ledger, 2e6);
        static_cast<void>(ledger.begin(3, "t3"));
        // A disk that did not take the record: what the meter saw is not lost.
        rig::record::Summary known = of(3, 0.5e6, ledger, "record_lost");
        known.cumulative_energy_J = -1.0;
        ledger.mark_unfinished(known);
        CHECK(ledger.cumulative_energy_J() == 6e6);
    }
    const auto rows = rig::record::read_ledger(path, "brake7");
    REQUIRE(rows.size() == 4);
    CHECK(rows[1].state == rig::record::RowState::unfinished);
    CHECK(rows[1].has_figures);
    CHECK(rows[1].summary.figures.brake_on_mps == 50.0);
    CHECK(rows[1].summary.started == "t2");
    CHECK(rows[1].summary.warnings == std::vector<std::string>{"log_damaged: unfinished_line 1"});
    CHECK(rows[3].state == rig::record::RowState::unfinished);
    CHECK(rows[3].summary.outcome == "record_lost");
    CHECK(sums(path) == std::vector<double>{2e6, 3.5e6, 5.5e6, 6e6});
}

TEST_CASE("energy that does not balance is in its row, and not in the sum", "[BRG-261]") {
    rig::record::Summary s;
    s.figures.energy_brake_J = 59.754e6;
    CHECK(rig::record::counted_energy_J(s) == 59.754e6);
    s.warnings = {"encoder_restarted: wheel 1"};
    CHECK(rig::record::counted_energy_J(s) == 59.754e6);
    s.warnings.push_back(std::string(rig::record::kEnergyUnbalanced) + ": brake and tyre took 60 MJ of 3 MJ kinetic energy");
    CHECK(rig::record::counted_energy_J(s) == 0.0);
    const TempDir dir;
    s.scenario = "x";
    s.outcome = "finished";
    rig::record::write_summary(dir.write("x", "").parent_path() / "summary.json", s);
    CHECK(rig::record::read_summary(dir.write("x", "").parent_path() / "summary.json").warnings == s.warnings);
    CHECK_THAT(rig::record::summary_table(s), ContainsSubstring("energy_unbalanced: brake and tyre took 60 MJ"));
}

TEST_CASE("an amendment moves every sum that stands on the maneuver, and overwrites nothing", "[BRG-261]") {
    const TempDir dir;
    const auto path = ledger_in(dir);
    rig::record::Ledger ledger(path);
    ledger.open_campaign(brake7(), rig::record::IfChanged::reject);
    run(ledger, 1e6);
    run(ledger, 59e6);
    run(ledger, 2e6);
    const std::string before = table(path);
    CHECK_THROWS_WITH(ledger.amend(2, 1, {.counted_J = 3e6, .who = "", .made = "t", .why = "so"}),
                      ContainsSubstring("maneuver 2, attempt 1 is amended only with who and why"));
    CHECK_THROWS_WITH(ledger.amend(2, 1, {.counted_J = 3e6, .who = "me", .made = "t", .why = ""}), ContainsSubstring("only with who and why"));
    CHECK_THROWS_WITH(ledger.amend(2, 2, {.counted_J = 3e6, .who = "me", .made = "t", .why = "so"}),
                      ContainsSubstring("maneuver 2, attempt 2 is not in campaign 'brake7'"));
    ledger.amend(2, 1, {.counted_J = 3e6, .who = "A. Rossi", .made = "t9", .why = "encoder node restarted"});
    CHECK(table(path) == before);
    CHECK(sums(path) == std::vector<double>{1e6, 4e6, 6e6});
    CHECK(ledger.cumulative_energy_J() == 6e6);
    // What comes later stands on it, and is not moved twice.
    run(ledger, 2e6);
    CHECK(sums(path) == std::vector<double>{1e6, 4e6, 6e6, 8e6});
    ledger.amend(2, 1, {.counted_J = 2.5e6, .who = "B. Bianchi", .made = "t10", .why = "measured again"});
    ledger.amend(1, 1, {.counted_J = 1.25e6, .who = "B. Bianchi", .made = "t11", .why = "the same"});
    CHECK(sums(path) == std::vector<double>{1.25e6, 3.75e6, 5.75e6, 7.75e6});
    run(ledger, 1e6);
    CHECK(sums(path).back() == 8.75e6);
    const auto rows = rig::record::read_ledger(path, "brake7");
    CHECK(rows[1].summary.figures.energy_brake_J == 59e6);
    CHECK(rows[1].counted_J == 2.5e6);
    REQUIRE(rows[1].amendments.size() == 2);
    CHECK(rows[1].amendments[0].who == "A. Rossi");
    CHECK(rows[1].amendments[0].made == "t9");
    CHECK(rows[1].amendments[0].why == "encoder node restarted");
    CHECK(rows[2].amendments.empty());
    // While one is running its sum is on its way.
    static_cast<void>(ledger.begin(6, "t"));
    CHECK_THROWS_WITH(ledger.amend(2, 1, {.counted_J = 3e6, .who = "me", .made = "t", .why = "so"}),
                      ContainsSubstring("while a maneuver is running"));
}

TEST_CASE("an attempt without figures can be amended, too, and a campaign is chosen as it is", "[BRG-261]") {
    const TempDir dir;
    const auto path = ledger_in(dir);
    {
        rig::record::Ledger ledger(path);
        ledger.open_campaign(brake7(), rig::record::IfChanged::reject);
        run(ledger, 1e6);
        static_cast<void>(ledger.begin(2, "t"));
        ledger.mark_unfinished();
        ledger.amend(2, 1, {.counted_J = 0.75e6, .who = "me", .made = "t", .why = "its log was lost"});
        CHECK(ledger.cumulative_energy_J() == 1.75e6);
        run(ledger, 1e6);
        CHECK(ledger.cumulative_energy_J() == 2.75e6);
        static_cast<void>(ledger.begin(3, "t"));
    }
    rig::record::Ledger ledger(path);
    CHECK_THROWS_WITH(ledger.choose("brake8"), ContainsSubstring("has no campaign 'brake8'"));
    ledger.choose("brake7");
    CHECK(rig::record::read_ledger(path, "brake7").back().state == rig::record::RowState::running);
    CHECK(ledger.cumulative_energy_J() == 2.75e6);
}
