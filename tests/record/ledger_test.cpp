#include <sqlite3.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <string>

#include "firmware/host/settings/error.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using namespace rig;
using can_test::TempDir;

namespace {

std::filesystem::path place(const TempDir& dir) {
    return dir.write("x", "").parent_path() / "runs" / "campaign.sqlite";
}

rig::record::Campaign some_campaign() {
    return {.name = "endurance",
            .scenario = "endurance",
            .seed = 7,
            .planned = 5,
            .config_hash = "abc",
            .version = "0.1.0",
            .created = "2026-01-02T03:04:05Z"};
}

rig::record::Summary summary_of(std::int64_t number, const rig::record::Ledger& ledger, const std::string& outcome = "finished") {
    rig::record::Summary s;
    s.campaign = "endurance";
    s.number = number;
    s.scenario = "endurance";
    s.outcome = outcome;
    s.started = "2026-01-02T03:04:06Z";
    double value = 0.1 * static_cast<double>(number);
    for (const rig::record::FigureField& field : rig::record::kFigureFields) s.figures.*field.value = value += 1.0 / 3.0;
    s.figures.standstill = true;
    s.cumulative_energy_J = ledger.cumulative_energy_J() + s.figures.energy_brake_J;
    s.faults = {"wheel_lost", "overrun"};
    s.frames = 1234;
    s.frames_dropped = 1;
    s.seed = 99;
    s.version = "0.1.0";
    s.config_hash = "abc";
    return s;
}

/// Straight to SQLite, past our code.
void sql(const std::filesystem::path& path, const std::string& text) {
    sqlite3* database = nullptr;
    REQUIRE(sqlite3_open(path.c_str(), &database) == SQLITE_OK);
    CHECK(sqlite3_exec(database, text.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK);
    sqlite3_close(database);
}

}  // namespace

TEST_CASE("a campaign goes through its maneuvers, each in a row with all its figures", "[BRG-220]") {
    const TempDir dir;
    const auto path = place(dir);
    std::vector<rig::record::Summary> entered;
    {
        rig::record::Ledger ledger(path);
        CHECK(ledger.open_campaign(some_campaign(), rig::record::IfChanged::reject).created);
        while (const auto number = ledger.next_number()) {
            const rig::record::Attempt attempt = ledger.begin(*number, "2026-01-02T03:04:06Z");
            CHECK(attempt.attempt == 1);
            CHECK(attempt.folder == path.parent_path() / "endurance" / ("000" + std::to_string(*number)));
            entered.push_back(summary_of(*number, ledger));
            ledger.finish(entered.back());
            CHECK(ledger.cumulative_energy_J() == entered.back().cumulative_energy_J);
        }
        CHECK(ledger.finished_count() == 5);
    }
    const auto rows = rig::record::read_ledger(path, "endurance");
    REQUIRE(rows.size() == 5);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        CHECK(rows[i].state == rig::record::RowState::finished);
        const rig::record::Summary& s = rows[i].summary;
        CHECK(s.number == entered[i].number);
        for (const rig::record::FigureField& field : rig::record::kFigureFields) CHECK(s.figures.*field.value == entered[i].figures.*field.value);
        CHECK(s.figures.standstill);
        CHECK(s.cumulative_energy_J == entered[i].cumulative_energy_J);
        CHECK(s.faults == entered[i].faults);
        CHECK(s.frames == 1234);
        CHECK(s.frames_dropped == 1);
        CHECK(s.seed == 99);
        CHECK(s.outcome == "finished");
        CHECK(s.config_hash == "abc");
    }
    REQUIRE(rig::record::read_campaigns(path).size() == 1);
    CHECK(rig::record::read_campaigns(path)[0].seed == 7);
}

TEST_CASE("what a dead bridge left is settled on resume, once", "[BRG-220]") {
    const TempDir dir;
    const auto path = place(dir);
    rig::record::Summary whole;
    std::filesystem::path second;
    {
        rig::record::Ledger ledger(path);
        ledger.open_campaign(some_campaign(), rig::record::IfChanged::reject);
        const rig::record::Attempt attempt = ledger.begin(1, "t");
        whole = summary_of(1, ledger);
        rig::record::write_summary(attempt.folder / "summary.json", whole);
    }
    {
        rig::record::Ledger ledger(path);
        const rig::record::Resumed resumed = ledger.open_campaign(some_campaign(), rig::record::IfChanged::reject);
        CHECK_FALSE(resumed.created);
        CHECK(resumed.adopted == std::vector<std::int64_t>{1});
        CHECK(resumed.unfinished.empty());
        CHECK(ledger.cumulative_energy_J() == whole.cumulative_energy_J);
        CHECK(ledger.next_number() == 2);
        second = ledger.begin(2, "t").folder;
    }
    // A summary that is torn, of another campaign or of another number is none.
    for (const int wrong : {0, 1, 2, 3}) {
        INFO(wrong);
        rig::record::Summary s = whole;
        s.number = wrong == 1 ? 3 : 2;
        if (wrong == 2) s.campaign = "other";
        if (wrong != 3) rig::record::write_summary(second / "summary.json", s);
        if (wrong == 0) {
            const std::string text = can_test::contents(second / "summary.json");
            std::ofstream(second / "summary.json") << text.substr(0, text.size() / 2);
        }
        rig::record::Ledger ledger(path);
        const rig::record::Resumed resumed = ledger.open_campaign(some_campaign(), rig::record::IfChanged::reject);
        CHECK(resumed.adopted.empty());
        CHECK(resumed.unfinished == std::vector<std::int64_t>{2});
        CHECK(ledger.next_number() == 2);
        const rig::record::Attempt again = ledger.begin(2, "t");
        CHECK(again.attempt == wrong + 2);
        CHECK(again.folder.filename() == "0002." + std::to_string(wrong + 2));
        second = again.folder;
    }
    CHECK(rig::record::read_ledger(path, "endurance").size() == 6);
}

TEST_CASE("aborted maneuvers keep their row and are run again; nothing is finished twice", "[BRG-220]") {
    const TempDir dir;
    const auto path = place(dir);
    rig::record::Ledger ledger(path);
    CHECK_THROWS_WITH(ledger.next_number(), ContainsSubstring("no campaign is open"));
    ledger.open_campaign(some_campaign(), rig::record::IfChanged::reject);
    CHECK_THROWS_WITH(ledger.finish(summary_of(1, ledger)), ContainsSubstring("maneuver 1 is not running"));
    static_cast<void>(ledger.begin(1, "t"));
    CHECK_THROWS_WITH(ledger.begin(2, "t"), ContainsSubstring("another one is running"));
    CHECK_THROWS_WITH(ledger.finish(summary_of(2, ledger)), ContainsSubstring("maneuver 2 is not running"));
    rig::record::Summary other = summary_of(1, ledger);
    other.campaign = "else";
    CHECK_THROWS_WITH(ledger.finish(other), ContainsSubstring("is of campaign 'else'"));
    const rig::record::Summary aborted = summary_of(1, ledger, "guard_open");
    ledger.finish(aborted);
    CHECK(ledger.cumulative_energy_J() == aborted.cumulative_energy_J);
    CHECK(ledger.next_number() == 1);
    CHECK(ledger.begin(1, "t").attempt == 2);
    ledger.finish(summary_of(1, ledger));
    CHECK_THROWS_WITH(ledger.finish(summary_of(1, ledger)), ContainsSubstring("is not running"));
    CHECK_THROWS_WITH(ledger.begin(1, "t"), ContainsSubstring("maneuver 1 is finished already"));
    static_cast<void>(ledger.begin(2, "t"));
    ledger.mark_unfinished();
    CHECK(ledger.next_number() == 2);
    const auto rows = rig::record::read_ledger(path, "endurance");
    REQUIRE(rows.size() == 3);
    CHECK(rows[0].state == rig::record::RowState::aborted);
    CHECK(rows[0].summary.outcome == "guard_open");
    CHECK(rows[1].state == rig::record::RowState::finished);
    CHECK(rows[2].state == rig::record::RowState::unfinished);
    CHECK(rows[2].summary.figures.length_m == 0.0);
    CHECK(std::string(name(rows[2].state)) == "unfinished");
}

TEST_CASE("a campaign is not resumed as another one unless told so", "[BRG-223]") {
    const TempDir dir;
    const auto path = place(dir);
    rig::record::Ledger ledger(path);
    ledger.open_campaign(some_campaign(), rig::record::IfChanged::reject);
    rig::record::Campaign longer = some_campaign();
    longer.planned = 50;
    longer.version = "0.2.0";
    CHECK(ledger.open_campaign(longer, rig::record::IfChanged::reject).changed.empty());
    CHECK(rig::record::read_campaigns(path)[0].planned == 50);
    rig::record::Campaign changed = longer;
    changed.seed = 8;
    changed.config_hash = "def";
    CHECK_THROWS_WITH(ledger.open_campaign(changed, rig::record::IfChanged::reject),
                      ContainsSubstring("campaign.sqlite: campaign 'endurance' was begun otherwise: seed was 7, is 8; config "
                                        "hash was abc, is def"));
    CHECK(rig::record::read_campaigns(path)[0].seed == 7);
    CHECK(ledger.open_campaign(changed, rig::record::IfChanged::go_on).changed.size() == 2);
    CHECK(rig::record::read_campaigns(path)[0].config_hash == "def");
    for (const char* bad : {"", "a/b", "../x", "."}) {
        changed.name = bad;
        CHECK_THROWS_WITH(ledger.open_campaign(changed, rig::record::IfChanged::go_on), ContainsSubstring("is no campaign name"));
    }
    changed.name = "second";
    CHECK(ledger.open_campaign(changed, rig::record::IfChanged::reject).created);
    CHECK(ledger.next_number() == 1);
    CHECK(rig::record::read_campaigns(path).size() == 2);
    changed.seed = std::uint64_t{1} << 63U;
    CHECK_THROWS_WITH(ledger.open_campaign(changed, rig::record::IfChanged::go_on), ContainsSubstring("seed: must be below 2^63"));
    CHECK_THROWS_WITH(rig::record::read_ledger(path, "third"), ContainsSubstring("has no campaign 'third'; it has endurance, second"));
}

TEST_CASE("one bridge at a time; readers may look", "[BRG-223]") {
    const TempDir dir;
    const auto path = place(dir);
    {
        rig::record::Ledger ledger(path);
        ledger.open_campaign(some_campaign(), rig::record::IfChanged::reject);
        CHECK_THROWS_WITH(rig::record::Ledger(path), ContainsSubstring("is held by another program (process " + std::to_string(getpid())));
        static_cast<void>(ledger.begin(1, "t"));
        CHECK(rig::record::read_ledger(path, "endurance").size() == 1);
        ledger.finish(summary_of(1, ledger));
    }
    CHECK_NOTHROW(rig::record::Ledger(path));
}

TEST_CASE("foreign, newer and damaged files are refused by name, and left as they are", "[BRG-223]") {
    const TempDir dir;
    const auto text = dir.write("text.sqlite", "campaign,number\n1,2\n" + std::string(2000, 'x'));
    CHECK_THROWS_WITH(rig::record::Ledger(text), ContainsSubstring("text.sqlite: is no SQLite file"));
    CHECK(can_test::contents(text).starts_with("campaign,number"));

    const auto other = text.parent_path() / "other.sqlite";
    sql(other, "CREATE TABLE t (a); INSERT INTO t VALUES (1)");
    CHECK_THROWS_WITH(rig::record::Ledger(other), ContainsSubstring("other.sqlite: is an SQLite file of another program"));

    const auto path = place(dir);
    {
        rig::record::Ledger ledger(path);
        ledger.open_campaign(some_campaign(), rig::record::IfChanged::reject);
        for (int i = 0; i < 3; ++i) {
            static_cast<void>(ledger.begin(*ledger.next_number(), "t"));
            ledger.finish(summary_of(*ledger.next_number(), ledger));
        }
    }
    const std::string whole = can_test::contents(path);
    sql(path, "PRAGMA user_version = 99");
    CHECK_THROWS_WITH(rig::record::Ledger(path),
                      ContainsSubstring("ledger of schema 99; this program knows schema") && ContainsSubstring("and older: use the newer"));
    CHECK_THROWS_WITH(rig::record::read_ledger(path, "endurance"), ContainsSubstring("ledger of schema 99"));

    std::string damaged = whole;
    for (std::size_t i = 8192; i < 16384 && i < damaged.size(); ++i) damaged[i] = 'Z';
    std::ofstream(path, std::ios::binary) << damaged;
    CHECK_THROWS_WITH(rig::record::Ledger(path), ContainsSubstring("campaign.sqlite: is damaged"));
    std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() / 2);
    CHECK_THROWS_WITH(rig::record::Ledger(path), ContainsSubstring("campaign.sqlite: is damaged"));

    std::string claims = whole;  // the schema's first row: 4 GB long, found by the fuzzer
    const auto row = static_cast<std::size_t>(static_cast<unsigned char>(whole[108]) << 8U | static_cast<unsigned char>(whole[109]));
    claims.replace(row, 5, "\x8F\xFF\xFF\xFF\x7F");
    std::ofstream(path, std::ios::binary) << claims;
    CHECK_THROWS_WITH(rig::record::Ledger(path), ContainsSubstring("campaign.sqlite: is damaged"));

    CHECK_THROWS_WITH(rig::record::read_ledger(text.parent_path() / "none.sqlite", "x"), ContainsSubstring("none.sqlite: no such ledger"));
    CHECK_FALSE(std::filesystem::exists(text.parent_path() / "none.sqlite"));
    const auto empty = dir.write("empty.sqlite", "");  // a bridge that was killed before it had made the tables
    CHECK_NOTHROW(rig::record::Ledger(empty).open_campaign(some_campaign(), rig::record::IfChanged::reject));
    CHECK_THROWS_AS(rig::record::Ledger("/proc/no/campaign.sqlite"), rig::record::LedgerError);
}

TEST_CASE("a disk without room is an error that says so; the ledger stays whole", "[BRG-220]") {
    const TempDir dir;
    const auto path = place(dir);
    std::int64_t finished = 0;
    {
        rig::record::Ledger ledger(path);
        rig::record::Campaign campaign = some_campaign();
        campaign.planned = 1000;
        ledger.open_campaign(campaign, rig::record::IfChanged::reject);
        rlimit before{};
        getrlimit(RLIMIT_FSIZE, &before);
        auto* const handler = std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{.rlim_cur = 65536, .rlim_max = before.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
        std::string error;
        try {
            while (const auto number = ledger.next_number()) {
                static_cast<void>(ledger.begin(*number, "t"));
                ledger.finish(summary_of(*number, ledger));
                ++finished;
            }
        } catch (const rig::record::LedgerError& e) {
            error = e.what();
        }
        setrlimit(RLIMIT_FSIZE, &before);
        std::signal(SIGXFSZ, handler);
        CHECK_THAT(error, ContainsSubstring(path.string()) && ContainsSubstring("the disk refused it; the ledger is as it was before"));
        CHECK(finished > 50);
        CHECK(ledger.finished_count() == finished);
        ledger.mark_unfinished();
        // With room again it goes on.
        static_cast<void>(ledger.begin(*ledger.next_number(), "t"));
        ledger.finish(summary_of(*ledger.next_number(), ledger));
    }
    std::int64_t entered = 0;
    for (const rig::record::LedgerRow& row : rig::record::read_ledger(path, "endurance"))
        entered += row.state == rig::record::RowState::finished ? 1 : 0;
    CHECK(entered == finished + 1);
}

TEST_CASE("a finished maneuver keeps what was thought of its brake", "[BRG-500]") {
    const TempDir dir;
    const auto path = place(dir);
    rig::record::Ledger ledger(path);
    ledger.open_campaign(some_campaign(), rig::record::IfChanged::reject);
    for (int i = 0; i < 3; ++i) {
        static_cast<void>(ledger.begin(*ledger.next_number(), "t"));
        ledger.finish(summary_of(*ledger.next_number(), ledger));
    }
    ledger.judge(2, {rig::record::HealthState::suspect, 0.625, "friction falls", "f00d"});
    ledger.judge(3, {rig::record::HealthState::abnormal, 1.5, "friction has dropped", "f00d"});
    const std::vector<rig::record::LedgerRow> rows = rig::record::read_ledger(path, "endurance");
    REQUIRE(rows.size() == 3);
    CHECK(rows[0].health.state == rig::record::HealthState::unknown);
    CHECK(std::isnan(rows[0].health.statistic));
    CHECK(rows[1].health.state == rig::record::HealthState::suspect);
    CHECK(rows[1].health.statistic == 0.625);
    CHECK(rows[1].health.reason == "friction falls");
    CHECK(rows[1].health.model == "f00d");
    CHECK(rows[2].health.state == rig::record::HealthState::abnormal);
    static_cast<void>(ledger.begin(4, "t"));
    CHECK_THROWS_WITH(ledger.judge(4, {}), ContainsSubstring("maneuver 4 is not finished"));
    CHECK_THROWS_WITH(ledger.judge(5, {}), ContainsSubstring("maneuver 5 is not finished"));
}

TEST_CASE("a ledger of schema 1 is read as it is, and brought to the newest when it is written; nothing is lost", "[BRG-223]") {
    // Two maneuvers and an aborted third, as the program of that schema wrote them.
    const TempDir dir;
    const auto path = dir.write("old.sqlite", "");
    sql(path, can_test::contents("tests/record/ledger_schema_1.sql"));
    sql(path,
        "INSERT INTO maneuvers (campaign, number, attempt, state, folder, scenario, started, seed, version, "
        "config_hash) VALUES (1, 3, 1, 'running', 'endurance/0003', 'endurance', 't', 3, '0.1.0', 'h')");
    const std::string before = can_test::contents(path);
    const std::vector<rig::record::LedgerRow> read = rig::record::read_ledger(path, "endurance");
    CHECK(can_test::contents(path) == before);
    const rig::record::Campaign campaign = rig::record::read_campaigns(path).at(0);
    CHECK(campaign.seed == 3);
    {
        rig::record::Ledger ledger(path);
        const rig::record::Resumed resumed = ledger.open_campaign(campaign, rig::record::IfChanged::reject);
        CHECK_FALSE(resumed.created);
        CHECK(resumed.unfinished == std::vector<std::int64_t>{3});
        ledger.judge(2, {rig::record::HealthState::healthy, 0.25, "", "f00d"});
    }
    const std::vector<rig::record::LedgerRow> migrated = rig::record::read_ledger(path, "endurance");
    REQUIRE(read.size() == 3);
    REQUIRE(migrated.size() == 3);
    CHECK(read[2].state == rig::record::RowState::running);
    CHECK(migrated[2].state == rig::record::RowState::unfinished);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(read[i].state == rig::record::RowState::finished);
        CHECK(read[i].health.state == rig::record::HealthState::unknown);
        CHECK(std::isnan(read[i].slip_reference));
        CHECK_FALSE(migrated[i].summary.out_of_tolerance.has_value());
        CHECK(read[i].summary.specimen == rig::record::Specimen{});
        CHECK(migrated[i].summary.specimen == rig::record::Specimen{});
        CHECK(read[i].attempt.folder == migrated[i].attempt.folder);
        CHECK(read[i].summary.started == migrated[i].summary.started);
        CHECK(read[i].summary.config_hash == migrated[i].summary.config_hash);
        CHECK(read[i].summary.cumulative_energy_J == migrated[i].summary.cumulative_energy_J);
        for (const rig::record::FigureField& field : rig::record::kFigureFields)
            CHECK(read[i].summary.figures.*field.value == migrated[i].summary.figures.*field.value);
    }
    // As printed in the dump.
    CHECK(migrated[0].summary.figures.mean_torque_Nm == 631.3551978069459);
    CHECK(migrated[0].summary.cumulative_energy_J == 968989.5573412941);
    CHECK(migrated[1].health.state == rig::record::HealthState::healthy);
}
