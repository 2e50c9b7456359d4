// Campaigns of maneuvers known in closed form: the raw logs must give what summaries and ledger say, bit by bit.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>

#include "firmware/host/settings/json.hpp"
#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/campaign_table.hpp"
#include "rig_bridge/replay/log_meter.hpp"
#include "tests/catch.hpp"
#include "tests/record/closed_form.hpp"
#include "tests/replay/logs.hpp"

using replay_test::TempDir;

namespace {

/// Three maneuvers, recorded with a ledger beside: the second aborted at first, then an attempt that was cut off.
class Ran {
  public:
    explicit Ran(const rig::record::Specimen& specimen = {}) {
        rig::record::Ledger ledger(file());
        ledger.open_campaign({.name = "night",
                              .scenario = "endurance",
                              .seed = 1,
                              .planned = 3,
                              .config_hash = "x",
                              .version = "0",
                              .created = "now",
                              .specimen = specimen},
                             rig::record::IfChanged::reject);
        maneuver(ledger, 54.86, "finished");
        maneuver(ledger, 30.0, "guard_open");
        cut_off(ledger);
        maneuver(ledger, 54.70, "finished");
        maneuver(ledger, 54.95, "finished");
    }
    [[nodiscard]] std::filesystem::path file() const { return dir.write("x", "").parent_path() / "campaign.sqlite"; }
    [[nodiscard]] std::filesystem::path folder() const { return file().parent_path() / "night"; }

    [[nodiscard]] rig::replay::CampaignTable rebuilt() const { return rebuilt(file()); }
    /// Empty: without one.
    [[nodiscard]] rig::replay::CampaignTable rebuilt(const std::filesystem::path& ledger) const {
        const rig::replay::CampaignSources sources{
            .layout = can_test::ours(),
            .parameters = [](const std::string&) { return record_test::kRig; },
            .ledger = ledger.empty() ? std::vector<rig::record::LedgerRow>{} : rig::record::read_ledger(ledger, "night"),
            .with_ledger = !ledger.empty(),
            .warnings = [](const std::string& name) { return rig::replay::LogWarnings(name, {}); }};
        return rig::replay::rebuild_campaign(rig::replay::maneuver_folders(folder()), sources);
    }

    [[nodiscard]] std::vector<rig::record::LedgerRow> rows() const { return rig::record::read_ledger(file(), "night"); }
    [[nodiscard]] std::filesystem::path new_file() const { return file().parent_path() / "rebuilt.sqlite"; }
    void write(const rig::replay::CampaignTable& table, const std::vector<rig::record::LedgerRow>& old) const {
        rig::replay::write_ledger(new_file(), rig::record::read_campaigns(file()).front(), table, old);
    }
    void write() const { write(rebuilt(), rows()); }
    [[nodiscard]] std::vector<rig::record::LedgerRow> new_rows() const { return rig::record::read_ledger(new_file(), "night"); }
    /// Of the new ledger, whatever it left.
    [[nodiscard]] std::vector<std::string> new_files() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(file().parent_path()))
            if (entry.path().filename().string().starts_with("rebuilt")) names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }

    TempDir dir;
    double energy_J = 0.0;
    double cut_off_J = 0.0;

  private:
    /// Its bridge dies at 4.6 m/s, in the middle of a line; the next one meters what there is.
    void cut_off(rig::record::Ledger& ledger) {
        const rig::record::Attempt attempt = ledger.begin(2, "now");
        std::filesystem::create_directories(attempt.folder);
        record_test::ClosedForm form;
        form.before_s = 1.0;
        const record_test::Recording recording(form, true);
        const double share = (form.before_s + (form.v0_mps - 4.6) / form.a1_mps2) / (form.rest_s() + 0.55);
        const auto frames = static_cast<std::size_t>(share * static_cast<double>(recording.frames.size()));
        std::string log;
        for (std::size_t i = 0; i < frames; ++i) log += replay_test::line(recording.frames[i]);
        std::ofstream(attempt.folder / "bus.log", std::ios::binary) << log.substr(0, log.size() - 9);
        rig::replay::LogWarnings warnings("bus.log", {});
        const rig::replay::MeteredLog metered =
            rig::replay::meter_log(rig::replay::log_in(attempt.folder), can_test::ours(), record_test::kRig, rig::replay::LogEnd::left, warnings);
        REQUIRE(metered.counts);
        REQUIRE(metered.warnings.size() == 2);
        CHECK_THAT(metered.warnings[0], ContainsSubstring("ends_in_braking: at 4."));
        CHECK_THAT(metered.warnings[0], ContainsSubstring("the brake may have taken up to 0.006"));
        CHECK(metered.warnings[1] == "log_damaged: unfinished_line 1");
        rig::record::Summary summary;
        summary.number = 2;
        summary.scenario = "endurance";
        summary.outcome = "unfinished";
        summary.figures = metered.figures;
        summary.warnings = metered.warnings;
        ledger.mark_unfinished(summary);
        energy_J += cut_off_J = metered.figures.energy_brake_J;
        const double v = 4.6 / form.v0_mps;
        CHECK(cut_off_J == Approx((1.0 - v * v) * form.torque_Nm * (1.0 - form.slip) / form.radius_m() * form.length_m()).epsilon(2e-3));
    }
    void maneuver(rig::record::Ledger& ledger, double v0_mps, const std::string& outcome) {
        const rig::record::Attempt attempt = ledger.begin(*ledger.next_number(), "now");
        std::filesystem::create_directories(attempt.folder);
        record_test::ClosedForm form;
        form.v0_mps = v0_mps;
        form.before_s = 1.0;
        const record_test::Recording recording(form, attempt.number != 3);
        rig::record::BusMeter meter(can_test::ours(), record_test::kRig);
        std::string log;
        for (const auto& frame : recording.frames) {
            log += replay_test::line(frame);
            meter.accept(frame);
        }
        if (attempt.number == 3)
            replay_test::write_gzip(attempt.folder / "bus.log.gz", log);
        else
            std::ofstream(attempt.folder / "bus.log", std::ios::binary) << log;
        rig::record::Summary summary;
        summary.campaign = "night";
        summary.number = attempt.number;
        summary.specimen = ledger.specimen();
        summary.scenario = "endurance";
        summary.outcome = outcome;
        summary.started = "now";
        summary.seed = 1;
        summary.figures = meter.figures();
        energy_J += summary.figures.energy_brake_J;
        summary.cumulative_energy_J = energy_J;
        rig::record::write_summary(attempt.folder / "summary.json", summary);
        ledger.finish(summary);
    }
};

/// Warnings aside.
void check_same(const std::vector<rig::record::LedgerRow>& rows, const std::vector<rig::record::LedgerRow>& old) {
    REQUIRE(rows.size() == old.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        CAPTURE(i);
        CHECK(rows[i].state == old[i].state);
        CHECK(rows[i].attempt.folder == old[i].attempt.folder);
        CHECK(rows[i].has_figures == old[i].has_figures);
        CHECK(rows[i].summary.outcome == old[i].summary.outcome);
        CHECK(rows[i].summary.started == old[i].summary.started);
        CHECK(rows[i].summary.specimen == old[i].summary.specimen);
        CHECK(rows[i].health.reason == old[i].health.reason);
        if (old[i].has_figures) CHECK(rows[i].summary.cumulative_energy_J == Approx(old[i].summary.cumulative_energy_J).epsilon(1e-12));
        for (const rig::record::FigureField& field : rig::record::kFigureFields)
            CHECK(rows[i].summary.figures.*field.value == old[i].summary.figures.*field.value);
        REQUIRE(rows[i].amendments.size() == old[i].amendments.size());
        for (std::size_t j = 0; j < rows[i].amendments.size(); ++j) CHECK(rows[i].amendments[j].counted_J == old[i].amendments[j].counted_J);
        REQUIRE(rows[i].notes.size() == old[i].notes.size());
        for (std::size_t j = 0; j < rows[i].notes.size(); ++j) CHECK(rows[i].notes[j].text == old[i].notes[j].text);
    }
}

/// No file may become longer while it lives, as on a full disk.
class FullDisk {
  public:
    explicit FullDisk(rlim_t bytes) {
        getrlimit(RLIMIT_FSIZE, &before_);
        rlimit limit = before_;
        limit.rlim_cur = bytes;
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FullDisk() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;

  private:
    void (*handler_)(int) = std::signal(SIGXFSZ, SIG_IGN);
    rlimit before_{};
};

}  // namespace

TEST_CASE("the campaign's table from the raw logs is that of summaries and ledger", "[BRG-340]") {
    const Ran ran;
    const rig::replay::CampaignTable table = ran.rebuilt();
    REQUIRE(table.rows.size() == 5);
    CHECK(table.counted() == 5);
    for (const auto& row : table.rows) {
        INFO(row.attempt.folder);
        for (const std::string& difference : row.differences) FAIL(difference);
    }
    CHECK(table.different() == 0);
    CHECK(table.rows[2].summary.outcome == "unfinished");
    CHECK(table.rows.back().summary.cumulative_energy_J == ran.energy_J);
    CHECK(table.rows[0].summary.figures.mean_friction == Approx(630.0 / 2.0e6 / record_test::kRig.brake_gain_m3).epsilon(1e-3));
    const auto json = settings::parse_json(rig::replay::to_json(table, "night"));
    CHECK(json["rows"][4]["cumulative_energy_J"].get<double>() == ran.energy_J);
    CHECK(replay_test::lines_of(rig::replay::to_csv(table)).size() == 6);
    CHECK(ran.rebuilt({}).different() == 0);
}

TEST_CASE("a log that ends with the wheel on the rim says how much the brake may have taken after it", "[BRG-261]") {
    const TempDir dir;
    const record_test::ClosedForm form;
    const record_test::Recording recording(form, true);
    const double wheel_radps = form.v0_mps * (1.0 - form.slip) / form.radius_m();
    const double whole_MJ =
        0.5e-6 * (record_test::kRig.flywheel_mass_kg * form.v0_mps * form.v0_mps + record_test::kRig.wheel_inertia_kgm2 * wheel_radps * wheel_radps);
    const auto cut_at = [&](double time_s, rig::replay::LogEnd end = rig::replay::LogEnd::left) {
        std::string log;
        const double share = time_s / (form.rest_s() + 0.55);
        const auto frames = static_cast<std::size_t>(share * static_cast<double>(recording.frames.size()));
        for (std::size_t i = 0; i < frames; ++i) log += replay_test::line(recording.frames[i]);
        const auto path = dir.write("bus.log", log);
        rig::replay::LogWarnings warnings("bus.log", {});
        return rig::replay::meter_log(path, can_test::ours(), record_test::kRig, end, warnings);
    };
    // Of a bridge that dies just after brake-on the last tenth of a second, and the brake-on, are not in it.
    const rig::replay::MeteredLog before = cut_at(1.0);
    CHECK(before.counts);
    CHECK(before.figures.energy_brake_J == 0.0);
    CHECK(before.warnings == std::vector<std::string>{fmt::format("ends_in_settling: at 54.9 m/s, and the brake may have taken "
                                                                  "up to {:.3g} MJ that are in no record",
                                                                  whole_MJ)});
    const rig::replay::MeteredLog within = cut_at(form.before_s + 0.5 * form.duration_s());
    CHECK_THAT(within.warnings.at(0), ContainsSubstring(fmt::format("up to {:.2g}", 0.25 * whole_MJ)));
    CHECK(cut_at(form.rest_s() + 0.2).warnings.empty());
    // A bridge whose bus was down at the end has closed its record nevertheless.
    CHECK(cut_at(1.0, rig::replay::LogEnd::closed).warnings.empty());
    CHECK_FALSE(cut_at(1.0, rig::replay::LogEnd::closed).counts);
    // One that heard nothing but itself from before brake-on to the end says what may be missing.
    std::string own;
    for (std::size_t i = 0; i < recording.frames.size(); ++i) {
        const bool of_bridge = recording.frames[i].id == can_test::ours()[antiskid::can::Role::maneuver_state].id;
        if (of_bridge || i < recording.frames.size() / 20) own += replay_test::line(recording.frames[i]);
    }
    rig::replay::LogWarnings none("bus.log", {});
    const rig::replay::MeteredLog unheard =
        rig::replay::meter_log(dir.write("bus.log", own), can_test::ours(), record_test::kRig, rig::replay::LogEnd::closed, none);
    CHECK(unheard.counts);
    CHECK(unheard.warnings == std::vector<std::string>{fmt::format("ends_unheard: at 54.9 m/s, and the brake may have taken up to {:.3g} MJ that "
                                                                   "are in no record",
                                                                   whole_MJ)});
    // The next bridge finds the rig at a speed: what it still has no brake took. Not if anybody had time to turn it. Of a rig that coasts at
    // once the rest is brake and tyre.
    const auto found_after = [&](double later_s, double v_mps, double from_s) {
        record_test::ClosedForm coasting;
        coasting.v0_mps = v_mps;
        coasting.change_mps = std::min(coasting.change_mps, 0.5 * v_mps);
        const record_test::Recording found(coasting, true);
        const std::size_t first = static_cast<std::size_t>(from_s / (coasting.rest_s() + 0.55) * static_cast<double>(found.frames.size()));
        std::string log;
        for (std::size_t i = first; i < first + 3000; ++i) {
            antiskid::can::Frame frame = found.frames[i];
            frame.received += antiskid::can::Time{static_cast<std::int64_t>((1.0 + later_s - from_s) * 1e9)};
            log += replay_test::line(frame);
        }
        (void)dir.write(rig::replay::kFoundLog, log);
        return cut_at(1.0);
    };
    const double lost_MJ = whole_MJ * (1.0 - 54.0 * 54.0 / (form.v0_mps * form.v0_mps));
    const rig::replay::MeteredLog coasts = found_after(3.0, 54.0, 0.0);
    CHECK(coasts.figures.energy_brake_J == Approx(0.88e6 * lost_MJ).epsilon(1e-3));
    CHECK(coasts.figures.energy_tyre_J == Approx(0.12e6 * lost_MJ).epsilon(1e-3));
    CHECK(coasts.figures.kinetic_energy_J == Approx(1e6 * lost_MJ).epsilon(1e-3));
    CHECK(coasts.warnings.at(0) == fmt::format("ends_in_settling: at 54.9 m/s, the rim still at 54.0 m/s when the next bridge "
                                               "came, by which {:.3g} MJ count, and the brake may have taken up to {:.3g} MJ that are "
                                               "in no record",
                                               coasts.figures.energy_brake_J * 1e-6, coasts.figures.energy_tyre_J * 1e-6));
    const rig::replay::MeteredLog late = found_after(30.0, 54.0, 0.0);
    const rig::replay::MeteredLog braked = found_after(3.0, 54.0, form.before_s + 0.05);
    const rig::replay::MeteredLog slow = found_after(3.0, 4.5, 0.0);
    for (const rig::replay::MeteredLog& each : {late, braked, slow}) {
        CHECK(each.figures.energy_brake_J == 0.0);
        CHECK_THAT(each.warnings.at(0), ContainsSubstring("m/s when the next bridge came, and the brake"));
    }
    CHECK_THAT(late.warnings.at(0), ContainsSubstring(fmt::format("up to {:.3g} MJ", lost_MJ)));
    for (const double later_s : {3600.0, -3600.0})
        CHECK_THAT(found_after(later_s, 54.0, 0.0).warnings.at(0), ContainsSubstring(fmt::format("up to {:.3g} MJ", whole_MJ)));
}

TEST_CASE("a ledger that is rebuilt from the folders is the one that was lost", "[BRG-261]") {
    const Ran ran;
    {
        rig::record::Ledger ledger(ran.file());
        ledger.choose("night");
        ledger.judge(3, {rig::record::HealthState::suspect, 0.5, "friction falls", "f00d"});
        ledger.amend(2, 3, {.counted_J = 0.9e6, .who = "A. Rossi", .made = "t", .why = "load cell"});
    }
    const rig::replay::CampaignTable table = ran.rebuilt();
    for (const auto& row : table.rows)
        for (const std::string& difference : row.differences) FAIL(difference);
    const auto old = ran.rows();
    ran.write(table, old);
    const auto rows = ran.new_rows();
    check_same(rows, old);
    for (std::size_t i = 0; i < rows.size(); ++i) CHECK(rows[i].summary.warnings == old[i].summary.warnings);
    CHECK(ran.new_files() == std::vector<std::string>{"rebuilt.sqlite"});
    CHECK_THROWS_WITH(ran.write(table, old), ContainsSubstring("is there already"));
}

TEST_CASE("a ledger that cannot be rebuilt whole is not there at all", "[BRG-261]") {
    const Ran ran;
    const rig::replay::CampaignTable table = ran.rebuilt();
    const auto old = ran.rows();
    auto with_bad_note = old;
    with_bad_note.back().notes.push_back({.field = "colour", .text = "red", .who = "A. Rossi", .made = "t"});
    CHECK_THROWS_WITH(ran.write(table, with_bad_note), ContainsSubstring("rebuilt.sqlite") && ContainsSubstring("colour"));
    CHECK(ran.new_files().empty());
    // A disk that is full at any point.
    std::size_t failed = 0;
    for (rlim_t bytes = 0; bytes < 400'000; bytes += 4096) {
        CAPTURE(bytes);
        std::string said;
        try {
            const FullDisk disk(bytes);
            ran.write(table, old);
        } catch (const std::exception& error) {
            said = error.what();
        }
        if (said.empty()) break;
        ++failed;
        CHECK_THAT(said, ContainsSubstring("rebuilt.sqlite"));
        CHECK(ran.new_files().empty());
    }
    CHECK(failed > 3);
    check_same(ran.new_rows(), old);
    // What a killed rebuild left is not in the way.
    std::filesystem::remove(ran.new_file());
    for (const char* const end : {".part", ".part-journal", ".part-held"}) std::ofstream(ran.new_file().string() + end) << "half";
    ran.write(table, old);
    check_same(ran.new_rows(), old);
    CHECK(ran.new_files() == std::vector<std::string>{"rebuilt.sqlite"});
}

TEST_CASE("an attempt that never had a folder keeps its amendment and its notes in a rebuilt ledger", "[BRG-261]") {
    const Ran ran;
    {
        rig::record::Ledger ledger(ran.file());
        ledger.choose("night");
        (void)ledger.begin(4, "then", {}, {.disc = "D9"});
        ledger.mark_unfinished();
        ledger.amend(4, 1, {.counted_J = 0.5e6, .who = "A. Rossi", .made = "t", .why = "by the speeds"});
        (void)ledger.begin(4, "later");
        ledger.mark_unfinished();
        ledger.note(4, 2, {.field = "lining_worn", .text = "0.25", .who = "A. Rossi", .made = "t"});
    }
    CHECK(ran.rebuilt().different() == 0);
    ran.write();
    check_same(ran.new_rows(), ran.rows());
}

TEST_CASE("two folders of the same attempt are refused, both by name", "[BRG-340]") {
    const Ran ran;
    std::filesystem::copy(ran.folder() / "0001", ran.folder() / "1", std::filesystem::copy_options::recursive);
    CHECK_THROWS_WITH(ran.rebuilt(), ContainsSubstring("night/1 ") && ContainsSubstring("night/0001 ") && ContainsSubstring("maneuver 1"));
    std::filesystem::remove_all(ran.folder() / "1");
    std::filesystem::copy(ran.folder() / "0002.2", ran.folder() / "2.02", std::filesystem::copy_options::recursive);
    CHECK_THROWS_WITH(ran.rebuilt(), ContainsSubstring("night/2.02 ") && ContainsSubstring("night/0002.2 "));
}

TEST_CASE("an unfinished attempt whose log was never metered is where a ledger differs from its folders", "[BRG-261]") {
    const Ran ran;
    const auto file = ran.file().parent_path() / "older.sqlite";
    {
        rig::record::Ledger ledger(file);
        ledger.open_campaign(rig::record::read_campaigns(ran.file()).front(), rig::record::IfChanged::reject);
        for (const rig::record::LedgerRow& row : rig::record::read_ledger(ran.file(), "night")) {
            (void)ledger.begin(row.attempt.number, "now");
            rig::record::Summary summary = row.summary;
            summary.cumulative_energy_J = ledger.cumulative_energy_J() + summary.figures.energy_brake_J;
            if (row.state == rig::record::RowState::unfinished)
                ledger.mark_unfinished();
            else
                ledger.finish(summary);
        }
    }
    const std::string said = to_text(ran.rebuilt(file));
    CHECK_THAT(said, ContainsSubstring(fmt::format("DIFFERS: {:.6g} MJ are in its log, none in the ledger", ran.cut_off_J * 1e-6)));
    CHECK_THAT(said, ContainsSubstring("DIFFERS: cumulative_energy_J is "));
}

TEST_CASE("a log that is not the one of its summary is named with the figure", "[BRG-340]") {
    const Ran ran;
    const auto log = ran.folder() / "0001/bus.log";
    auto lines = replay_test::lines_of(can_test::contents(log));
    std::string text;
    for (std::size_t i = 0; i < lines.size(); ++i)
        if (i < 30'000 || i > 30'100) text += lines[i];
    std::ofstream(log, std::ios::binary) << text;
    const rig::replay::CampaignTable table = ran.rebuilt();
    CHECK(table.different() >= 1);
    CHECK_FALSE(table.rows[0].differences.empty());
    const std::string said = to_text(table);
    CHECK_THAT(said, ContainsSubstring("DIFFERS: mean_friction is "));
    CHECK_THAT(said, ContainsSubstring("in the ledger"));
}

TEST_CASE("folders and ledger that do not belong together are told", "[BRG-340]") {
    const Ran ran;
    std::filesystem::remove_all(ran.folder() / "0003");
    std::filesystem::create_directories(ran.folder() / "0007");
    std::filesystem::remove(ran.folder() / "0001/bus.log");
    const std::string said = to_text(ran.rebuilt());
    CHECK_THAT(said, ContainsSubstring("in the ledger, but the folder is not there"));
    CHECK_THAT(said, ContainsSubstring("the ledger has no such attempt"));
    CHECK_THAT(said, ContainsSubstring("neither bus.log nor bus.log.gz"));
    ran.write();
    check_same(ran.new_rows(), ran.rows());
    CHECK_THROWS_WITH(rig::replay::maneuver_folders(ran.folder() / "0001"), ContainsSubstring("holds no maneuvers"));
    CHECK_THROWS_WITH(rig::replay::maneuver_folders("/nowhere"), ContainsSubstring("is no directory"));
}

TEST_CASE("what is known of a maneuver whose log or folder is lost stays in the table and in a rebuilt ledger", "[BRG-340]") {
    const Ran ran({.disc = "D7"});
    {
        rig::record::Ledger ledger(ran.file());
        ledger.choose("night");
        ledger.judge(2, {rig::record::HealthState::suspect, 0.5, "friction falls", "f00d"});
        ledger.note(2, 3, {.field = "lining_worn", .text = "0.25", .who = "A. Rossi", .made = "t"});
        ledger.note(3, 1, {.field = "disc_serial", .text = "D8", .who = "A. Rossi", .made = "t"});
    }
    const auto whole = ran.rows();
    const auto lost = [&](const std::string& what, std::size_t row, const std::string& of) {
        CAPTURE(what);
        const auto aside = ran.folder().parent_path() / "aside";
        std::filesystem::rename(ran.folder() / what, aside);
        const rig::replay::CampaignTable table = ran.rebuilt();
        CHECK(table.different() == 1);
        REQUIRE(table.rows.size() == 5);
        CHECK(table.counted() == 5);
        for (std::size_t i = 0; i < 5; ++i) {
            CHECK(table.rows[i].attempt == whole[i].attempt);
            CHECK(table.rows[i].summary.cumulative_energy_J == whole[i].summary.cumulative_energy_J);
        }
        CHECK(table.rows[row].differences.size() == 1);
        CHECK_THAT(to_text(table), ContainsSubstring("log_missing: its figures are those of " + of));
        CHECK(replay_test::lines_of(rig::replay::to_csv(table)).size() == 6);
        // From the new ledger the same once more, and not twice said.
        ran.write(table, whole);
        const auto rows = ran.new_rows();
        check_same(rows, whole);
        for (std::size_t i = 0; i < 5; ++i)
            CHECK(std::count_if(rows[i].summary.warnings.begin(), rows[i].summary.warnings.end(),
                                [](const auto& text) { return text.starts_with("log_missing"); }) == (i == row ? 1 : 0));
        const rig::replay::CampaignTable again = ran.rebuilt(ran.new_file());
        CHECK(again.different() == 1);
        CHECK(again.rows[row].differences.size() == 1);
        CHECK(again.rows[row].summary.warnings == rows[row].summary.warnings);
        std::filesystem::remove(ran.new_file());
        std::filesystem::rename(aside, ran.folder() / what);
    };
    lost("0001/bus.log", 0, "summary.json");
    lost("0002", 1, "the ledger");
    lost("0002.2", 2, "the ledger");
    lost("0002.2/bus.log", 2, "the ledger");
    lost("0002.3", 3, "the ledger");
    lost("0003/bus.log.gz", 4, "summary.json");
    lost("0003", 4, "the ledger");
    // A log that has lost every line is none.
    {
        auto summary = rig::record::read_summary(ran.folder() / "0001/summary.json");
        summary.frames = 7;
        rig::record::write_summary(ran.folder() / "0001/summary.json", summary);
        std::filesystem::resize_file(ran.folder() / "0001/bus.log", 0);
    }
    CHECK(ran.rebuilt().rows[0].summary.figures.energy_brake_J == whole[0].summary.figures.energy_brake_J);
    // Of a maneuver that the ledger has as finished its end is known without a summary, too.
    std::filesystem::remove(ran.folder() / "0003/summary.json");
    CHECK_THAT(to_text(ran.rebuilt()), ContainsSubstring("has no summary.json, but finished in the ledger"));
    ran.write();
    check_same(ran.new_rows(), whole);
    // Without a ledger there is nothing else to go by.
    CHECK(ran.rebuilt({}).rows[0].summary.figures.energy_brake_J == whole[0].summary.figures.energy_brake_J);
    CHECK_THAT(to_text(ran.rebuilt({})), ContainsSubstring("log_missing: its figures are those of summary.json"));
}

TEST_CASE("the exported table has the specimen of each maneuver as noted, and counts energy disc by disc", "[BRG-270]") {
    const Ran ran({.disc = "D7", .notes = "a, \"b\""});
    {
        rig::record::Ledger ledger(ran.file());
        ledger.choose("night");
        ledger.note(3, 1, {.field = "disc_serial", .text = "D8", .who = "A. Rossi", .made = "t"});
        ledger.note(3, 1, {.field = "notes", .text = "changed", .who = "A. Rossi", .made = "t"});
    }
    const rig::replay::CampaignTable table = ran.rebuilt();
    CHECK(table.different() == 0);
    CHECK(table.rows[3].disc_energy_J == table.rows[3].summary.cumulative_energy_J);
    CHECK(table.rows[4].disc_energy_J == Approx(table.rows[4].summary.figures.energy_brake_J));
    const auto lines = replay_test::lines_of(rig::replay::to_csv(table));
    CHECK_THAT(lines[0], ContainsSubstring(",brake_serial,disc_serial,tyre_serial,specimen_serial,operator,notes,disc_energy_J"));
    CHECK_THAT(lines[1], ContainsSubstring(",,D7,,,,\"a, \"\"b\"\"\","));
    CHECK_THAT(lines[5], ContainsSubstring(",,D8,,,,\"a, \"\"b\"\"; changed\","));
    CHECK_THAT(to_text(table), ContainsSubstring("from here on: disc D8"));
    CHECK(settings::parse_json(rig::replay::to_json(table, "night"))["rows"][4]["disc_serial"] == "D8");
    // A ledger that is rebuilt has texts and notes once.
    const auto rebuilt = ran.dir.write("x", "").parent_path() / "rebuilt.sqlite";
    rig::replay::write_ledger(rebuilt, rig::record::read_campaigns(ran.file()).front(), table, rig::record::read_ledger(ran.file(), "night"));
    const auto rows = rig::record::read_ledger(rebuilt, "night");
    REQUIRE(rows.size() == 5);
    CHECK(rows[2].summary.specimen == rig::record::Specimen{.disc = "D7", .notes = "a, \"b\""});
    CHECK(rows[4].summary.specimen == rig::record::Specimen{.disc = "D8", .notes = "a, \"b\"; changed"});
    CHECK(rows[4].notes.size() == 2);
}
