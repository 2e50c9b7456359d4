/// Out of tolerance, within it, or not judged: in summary.json and ledger.
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using can_test::TempDir;
using Verdict = std::optional<std::vector<std::string>>;

namespace {

rig::record::Summary judged(const Verdict& verdict) {
    rig::record::Summary s;
    s.campaign = "endurance";
    s.number = 1;
    s.scenario = "endurance";
    s.outcome = "finished";
    s.started = "2026-01-02T03:04:06Z";
    s.out_of_tolerance = verdict;
    s.version = "0.1.0";
    s.config_hash = "abc";
    return s;
}

const Verdict kVerdicts[] = {std::nullopt, Verdict{std::in_place}, Verdict{std::vector<std::string>{"mean_load_N", "length_m"}}};

}  // namespace

TEST_CASE("a summary keeps the verdict; one of a time that knew none is not judged", "[BRG-140]") {
    const TempDir dir;
    const auto path = dir.write("summary.json", "");
    for (const Verdict& verdict : kVerdicts) {
        rig::record::write_summary(path, judged(verdict));
        CHECK(rig::record::read_summary(path).out_of_tolerance == verdict);
    }
    CHECK(rig::record::off_conditions(judged(kVerdicts[2])));
    CHECK_FALSE((rig::record::off_conditions(judged(kVerdicts[0])) || rig::record::off_conditions(judged(kVerdicts[1]))));
    CHECK_THAT(rig::record::summary_table(judged(kVerdicts[2])), ContainsSubstring("out_of_tolerance: mean_load_N, length_m"));
    CHECK_THAT(rig::record::summary_table(judged(kVerdicts[1])), ContainsSubstring("within tolerance"));
    CHECK_THAT(rig::record::summary_table(judged(kVerdicts[0])), !ContainsSubstring("tolerance"));
    std::string text = can_test::contents(path);
    const auto at = text.find("  \"out_of_tolerance\"");
    REQUIRE(at != std::string::npos);
    text.erase(at, text.find("],\n", at) + 3 - at);
    CHECK_FALSE(rig::record::read_summary(dir.write("old.json", text)).out_of_tolerance.has_value());
}

TEST_CASE("a ledger's row keeps the verdict, and a bridge that died leaves it in its summary", "[BRG-140]") {
    for (const Verdict& verdict : kVerdicts) {
        const TempDir dir;
        const auto path = dir.write("x", "").parent_path() / "campaign.sqlite";
        const rig::record::Campaign campaign{.name = "endurance",
                                             .scenario = "endurance",
                                             .seed = 1,
                                             .planned = 2,
                                             .config_hash = "abc",
                                             .version = "0.1.0",
                                             .created = "2026-01-02T03:04:05Z"};
        {
            rig::record::Ledger ledger(path);
            (void)ledger.open_campaign(campaign, rig::record::IfChanged::reject);
            (void)ledger.begin(1, "t");
            ledger.finish(judged(verdict));
            const rig::record::Attempt second = ledger.begin(2, "t");
            rig::record::Summary summary = judged(verdict);
            summary.number = 2;
            std::filesystem::create_directories(second.folder);
            rig::record::write_summary(second.folder / "summary.json", summary);
        }
        rig::record::Ledger ledger(path);
        CHECK(ledger.open_campaign(campaign, rig::record::IfChanged::reject).adopted == std::vector<std::int64_t>{2});
        CHECK_FALSE(ledger.next_number().has_value());  // it finished, whatever it was
        for (const rig::record::LedgerRow& row : rig::record::read_ledger(path, "endurance")) CHECK(row.summary.out_of_tolerance == verdict);
    }
}
