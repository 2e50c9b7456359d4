// Campaigns of maneuvers known in closed form: the raw logs must give what summaries and ledger say, bit by bit.
#include <fmt/format.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/campaign_table.hpp"
#include "tests/catch.hpp"
#include "tests/record/closed_form.hpp"
#include "tests/replay/logs.hpp"

using replay_test::TempDir;

namespace {

/// Three maneuvers, recorded with a ledger beside: the second aborted at first, then an attempt that was cut off.
class Ran {
  public:
    Ran() {
        rig::Ledger ledger(file());
        ledger.open_campaign({.name = "night",
                              .scenario = "endurance",
                              .seed = 1,
                              .planned = 3,
                              .config_hash = "x",
                              .version = "0",
                              .created = "now"},
                             rig::IfChanged::refuse);
        maneuver(ledger, 54.86, "finished");
        maneuver(ledger, 30.0, "guard_open");
        (void)ledger.begin(2, "now");
        ledger.mark_unfinished();
        std::filesystem::create_directories(folder() / "0002.2");
        maneuver(ledger, 54.70, "finished");
        maneuver(ledger, 54.95, "finished");
    }
    [[nodiscard]] std::filesystem::path file() const {
        return dir.write("x", "").parent_path() / "ledger.sqlite";
    }
    [[nodiscard]] std::filesystem::path folder() const { return file().parent_path() / "night"; }

    [[nodiscard]] rig::CampaignTable rebuilt(bool with_ledger = true) const {
        const rig::CampaignSources sources{
            .layout = can_test::ours(),
            .parameters = [](const std::string&) { return record_test::kRig; },
            .ledger = with_ledger ? rig::read_ledger(file(), "night") : std::vector<rig::LedgerRow>{},
            .with_ledger = with_ledger,
            .warnings = [](const std::string& name) { return rig::LogWarnings(name, {}); }};
        return rig::rebuild_campaign(rig::maneuver_folders(folder()), sources);
    }

    TempDir dir;
    double energy_J = 0.0;

  private:
    void maneuver(rig::Ledger& ledger, double v0_mps, const std::string& outcome) {
        const rig::Attempt attempt = ledger.begin(*ledger.next_number(), "now");
        std::filesystem::create_directories(attempt.folder);
        record_test::ClosedForm form;
        form.v0_mps = v0_mps;
        form.before_s = 1.0;
        const record_test::Recording recording(form, attempt.number != 3);
        rig::BusMeter meter(can_test::ours(), record_test::kRig);
        std::string log;
        for (const auto& frame : recording.frames) {
            log += replay_test::line(frame);
            meter.accept(frame);
        }
        if (attempt.number == 3)
            replay_test::write_gzip(attempt.folder / "bus.log.gz", log);
        else
            std::ofstream(attempt.folder / "bus.log", std::ios::binary) << log;
        rig::Summary summary;
        summary.campaign = "night";
        summary.number = attempt.number;
        summary.scenario = "endurance";
        summary.outcome = outcome;
        summary.started = "now";
        summary.seed = 1;
        summary.figures = meter.figures();
        energy_J += summary.figures.energy_brake_J;
        summary.cumulative_energy_J = energy_J;
        rig::write_summary(attempt.folder / "summary.json", summary);
        ledger.finish(summary);
    }
};

}  // namespace

TEST_CASE("the campaign's table from the raw logs is that of summaries and ledger", "[BRG-340]") {
    const Ran ran;
    const rig::CampaignTable table = ran.rebuilt();
    REQUIRE(table.rows.size() == 5);
    CHECK(table.counted() == 4);
    for (const auto& row : table.rows) {
        INFO(row.folder.path);
        for (const std::string& difference : row.differences) FAIL(difference);
    }
    CHECK(table.different() == 0);
    CHECK(table.rows[2].outcome == "unfinished");
    CHECK(table.rows.back().cumulative_energy_J == ran.energy_J);
    CHECK(table.rows[0].figures.mean_friction ==
          Approx(630.0 / 2.0e6 / record_test::kRig.brake_gain_m3).epsilon(1e-3));
    const auto json = nlohmann::json::parse(rig::to_json(table, "night"));
    CHECK(json["rows"][4]["cumulative_energy_J"].get<double>() == ran.energy_J);
    CHECK(replay_test::lines_of(rig::to_csv(table)).size() == 5);
    CHECK(ran.rebuilt(false).different() == 0);
}

TEST_CASE("a log that is not the one of its summary is named with the figure", "[BRG-341]") {
    const Ran ran;
    const auto log = ran.folder() / "0001/bus.log";
    auto lines = replay_test::lines_of(can_test::contents(log));
    std::string text;
    for (std::size_t i = 0; i < lines.size(); ++i)
        if (i < 30'000 || i > 30'100) text += lines[i];
    std::ofstream(log, std::ios::binary) << text;
    const rig::CampaignTable table = ran.rebuilt();
    CHECK(table.different() >= 1);
    CHECK_FALSE(table.rows[0].differences.empty());
    const std::string said = rig::to_text(table);
    CHECK_THAT(said, ContainsSubstring("DIFFERS: mean_friction is "));
    CHECK_THAT(said, ContainsSubstring("in the ledger"));
}

TEST_CASE("folders and ledger that do not belong together are told", "[BRG-341]") {
    const Ran ran;
    std::filesystem::remove_all(ran.folder() / "0003");
    std::filesystem::create_directories(ran.folder() / "0007");
    std::filesystem::remove(ran.folder() / "0001/bus.log");
    const std::string said = rig::to_text(ran.rebuilt());
    CHECK_THAT(said, ContainsSubstring("in the ledger, but the folder is not there"));
    CHECK_THAT(said, ContainsSubstring("the ledger has no such attempt"));
    CHECK_THAT(said, ContainsSubstring("neither bus.log nor bus.log.gz"));
    CHECK_THROWS_WITH(rig::maneuver_folders(ran.folder() / "0001"), ContainsSubstring("holds no maneuvers"));
    CHECK_THROWS_WITH(rig::maneuver_folders("/nowhere"), ContainsSubstring("is no directory"));
}
