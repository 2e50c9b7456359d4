#include "rig_bridge/replay/campaign_source.hpp"

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "plant_sim/lab/campaign_options.hpp"
#include "plant_sim/wear/forecast_request.hpp"
#include "plant_sim/wear/landing_mix.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/wear/population_io.hpp"
#include "tests/catch.hpp"

namespace {

/// A directory of its own, gone afterwards.
class Folder {
  public:
    explicit Folder(const std::string& name) : path_(std::filesystem::temp_directory_path() / (name + std::to_string(::getpid()))) {
        std::filesystem::create_directories(path_);
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

void enter(rig::record::Ledger& ledger, const std::string& campaign, std::int64_t number, const std::string& outcome, double c_e_J, double friction,
           const std::vector<std::string>& out_of_tolerance = {}, const std::vector<std::string>& warnings = {}) {
    (void)ledger.begin(number, "2026-01-01T00:00:00Z");
    rig::record::Summary s;
    s.campaign = campaign;
    s.number = number;
    s.outcome = outcome;
    s.started = "2026-01-01T00:00:00Z";
    s.cumulative_energy_J = c_e_J;
    s.figures.mean_friction = friction;
    s.figures.brake_on_mps = 54.0;
    s.figures.mean_torque_Nm = 630.0;
    s.figures.mean_load_N = 23500.0;
    s.out_of_tolerance = out_of_tolerance;
    s.warnings = warnings;
    ledger.finish(s);
}

rig::record::Campaign campaign(const std::string& name) {
    rig::record::Campaign c;
    c.name = name;
    c.scenario = "endurance";
    c.planned = 10;
    return c;
}

}  // namespace

TEST_CASE("a ledger is a campaign", "[WEAR-001]") {
    const Folder folder("wear_ledger");
    {
        rig::record::Ledger ledger(folder / "campaign.sqlite", {.durable = false});
        ledger.open_campaign(campaign("first"), rig::record::IfChanged::reject);
        enter(ledger, "first", 1, "finished", 1.0e6, 0.31);
        enter(ledger, "first", 2, "load lost", 1.4e6, 0.05);
        enter(ledger, "first", 2, "finished", 2.4e6, 0.30);
        enter(ledger, "first", 3, "finished", 3.4e6, 0.29);
        for (const std::int64_t attempt : {1, 2})
            ledger.note(2, attempt, {.field = "lining_worn", .text = attempt == 1 ? "0.1" : "0.2", .who = "Kim", .made = "t"});
        (void)ledger.begin(4, "2026-01-01T00:00:00Z");  // the bridge is killed before anything of it is known
    }
    {
        rig::record::Ledger ledger(folder / "campaign.sqlite", {.durable = false});
        ledger.open_campaign(campaign("first"), rig::record::IfChanged::reject);
        ledger.note(4, 1, {.field = "lining_worn", .text = "0.3", .who = "Kim", .made = "t"});
    }
    const wear::Campaign by_file = rig::replay::load_campaign(folder / "campaign.sqlite", "");
    CHECK(by_file.readings == std::vector<wear::LiningReading>{{1.4e6, 0.1}, {2.4e6, 0.2}, {3.4e6, 0.3}});
    const wear::Campaign by_csv = wear::parse_campaign("table.csv", wear::to_csv(by_file));
    CHECK(by_csv.points == by_file.points);
    CHECK(by_csv.readings == by_file.readings);
    REQUIRE(by_file.points.size() == 3);
    CHECK(by_file.points[0] == wear::Point{1.0e6, 0.31});
    // The aborted attempt is no point, but what it took is.
    CHECK(by_file.points[1] == wear::Point{2.4e6, 0.30});
    CHECK(rig::replay::load_campaign(folder.path(), "first").points == by_file.points);
    {
        rig::record::Ledger ledger(folder / "campaign.sqlite", {.durable = false});
        ledger.open_campaign(campaign("second"), rig::record::IfChanged::reject);
        enter(ledger, "second", 1, "finished", 1.0e6, 0.31);
    }
    CHECK_THROWS_WITH(rig::replay::load_campaign(folder.path(), ""), ContainsSubstring("choose one with --campaign: first, second"));
    CHECK_THROWS_WITH(rig::replay::load_campaign(folder.path(), "second"), ContainsSubstring("one maneuver only"));
    CHECK_THROWS_WITH(rig::replay::load_campaign(folder.path(), "third"), ContainsSubstring("third"));
}

TEST_CASE("maneuvers out of tolerance are left out unless they are asked for; their energy is not", "[WEAR-001]") {
    const Folder folder("wear_off");
    {
        rig::record::Ledger ledger(folder / "campaign.sqlite", {.durable = false});
        ledger.open_campaign(campaign("first"), rig::record::IfChanged::reject);
        enter(ledger, "first", 1, "finished", 1.0e6, 0.31);
        enter(ledger, "first", 2, "finished", 3.3e6, 0.22, {"mean_load_N", "length_m"});
        enter(ledger, "first", 3, "finished", 4.3e6, 0.29);
    }
    const wear::Campaign kept = rig::replay::load_campaign(folder.path(), "");
    CHECK(kept.points == std::vector<wear::Point>{{1.0e6, 0.31}, {4.3e6, 0.29}});
    CHECK(kept.brakings.size() == 2);
    CHECK_THAT(kept.source, ContainsSubstring("1 out of tolerance left out"));
    const auto taken = rig::replay::OutOfTolerance::taken;
    const wear::Campaign all = rig::replay::load_campaign(folder.path(), "", taken);
    CHECK(all.points == std::vector<wear::Point>{{1.0e6, 0.31}, {3.3e6, 0.22}, {4.3e6, 0.29}});
    CHECK_THAT(all.source, !ContainsSubstring("left out"));
    CHECK(rig::replay::load_campaigns({folder.path()}).at(0).points == kept.points);
    CHECK(rig::replay::load_campaigns({folder.path()}, taken).at(0).points == all.points);
}

TEST_CASE("a maneuver whose energies do not balance is no point until it is amended, and blocks no other", "[WEAR-001][BRG-261]") {
    const Folder folder("wear_unbalanced");
    const auto ledger = [&] {
        return std::make_unique<rig::record::Ledger>(folder / "campaign.sqlite", rig::record::LedgerOptions{.durable = false});
    };
    const auto amend = [&](std::int64_t number, double counted_J) {
        const auto open = ledger();
        open->choose("first");
        open->amend(number, 1, {.counted_J = counted_J, .who = "Kim", .made = "t", .why = "its log"});
    };
    {
        const auto open = ledger();
        open->open_campaign(campaign("first"), rig::record::IfChanged::reject);
        enter(*open, "first", 1, "finished", 0.0, 0.31, {}, {"energy_unbalanced: brake and tyre took 9 MJ of 1 MJ kinetic energy"});
        enter(*open, "first", 2, "finished", 1.0e6, 0.30);
        enter(*open, "first", 3, "finished", 1.0e6, 0.90, {}, {"energy_unbalanced: brake and tyre took 9 MJ of 1 MJ kinetic energy"});
        enter(*open, "first", 4, "finished", 2.0e6, 0.28);
    }
    const wear::Campaign read = rig::replay::load_campaign(folder.path(), "");
    CHECK(read.points == std::vector<wear::Point>{{1.0e6, 0.30}, {2.0e6, 0.28}});
    CHECK(read.brakings.size() == 2);
    CHECK_THAT(read.source, ContainsSubstring("(2 unbalanced left out, until amended)"));
    amend(3, 0.9e6);
    CHECK(rig::replay::load_campaign(folder.path(), "").points == std::vector<wear::Point>{{1.0e6, 0.30}, {1.9e6, 0.90}, {2.9e6, 0.28}});
    amend(3, 0.0);
    const wear::Campaign nothing = rig::replay::load_campaign(folder.path(), "");
    CHECK(nothing.points == read.points);
    CHECK_THAT(nothing.source, ContainsSubstring("(1 unbalanced left out, until amended)") && ContainsSubstring("(1 that add no energy left out)"));
}

TEST_CASE("what is left out changes neither the energy of the landings to come nor that taken so far", "[WEAR-001][WEAR-050]") {
    const auto by = wear::read_population("config/wear/population.json");
    const auto forecast_of = [&](const wear::Campaign& c, const std::string& method) {
        wear::ForecastRequest request;
        request.limit = 0.2;
        request.draws = 100;
        request.method = method;
        return wear::answer(request, wear::resolved(request), by, c);
    };
    enum class Marked : std::uint8_t { none, every_second, newest, newest_aborted, unbalanced };
    for (const Marked marked : {Marked::none, Marked::every_second, Marked::newest, Marked::newest_aborted, Marked::unbalanced}) {
        const Folder folder("wear_left_out");
        {
            rig::record::Ledger ledger(folder / "campaign.sqlite", {.durable = false});
            rig::record::Campaign c = campaign("first");
            c.planned = 50;
            c.specimen.disc = "D7";  // another disc's energy is not this one's
            ledger.open_campaign(c, rig::record::IfChanged::reject);
            enter(ledger, "first", 1, "finished", 9e6, 0.31);
            c.specimen.disc = "D8";
            ledger.open_campaign(c, rig::record::IfChanged::go_on);
            for (int i = 1; i <= 24; ++i) {
                const bool newest = i > 18;
                const bool off = (marked == Marked::every_second && i % 2 == 0) || (marked == Marked::newest && newest);
                const bool aborted = marked == Marked::newest_aborted && newest;
                enter(ledger, "first", aborted ? 20 : 1 + i, aborted ? "load lost" : "finished", 9e6 + i * 1e6, 0.31 - i * 0.0005,
                      off ? std::vector<std::string>{"length_m"} : std::vector<std::string>{});
            }
            if (marked == Marked::unbalanced) enter(ledger, "first", 26, "finished", 33e6, 0.3, {}, {"energy_unbalanced: 9 MJ of 1 MJ"});
        }
        const wear::Campaign read = rig::replay::load_campaign(folder.path(), "");
        const wear::Campaign by_csv = wear::parse_campaign("table.csv", wear::to_csv(read));
        CHECK(by_csv.points == read.points);
        CHECK(by_csv.landings == read.landings);
        for (const wear::Campaign& c : {read, by_csv}) {
            CAPTURE(static_cast<int>(marked), c.source);
            CHECK(c.points.size() == (marked == Marked::every_second ? 12 : marked == Marked::newest || marked == Marked::newest_aborted ? 18 : 24));
            CHECK(wear::taken_now_J(c) == 24e6);
            CHECK(wear::taken_before_J(c) == 0.0);
            for (std::size_t i = 0; i < c.points.size(); ++i) CHECK(wear::brake_energy_J(c, i) == 1e6);
            for (const std::string method : {"shipped", "filter"}) {
                const wear::ForecastAnswer answer = forecast_of(c, method);
                CHECK(answer.mix.at(0).energy_J == 1e6);
                CHECK(answer.mix.at(0).deviation_J == 0.0);
                CHECK(answer.forecast.c_e_J == 24e6);
            }
        }
    }
}

TEST_CASE("what is no ledger is read as CSV", "[WEAR-001]") {
    const Folder folder("wear_csv");
    std::ofstream(folder / "data.csv") << "cumulative_energy_MJ,mean_friction\n1,0.3\n2,0.29\n";
    CHECK(rig::replay::load_campaign(folder / "data.csv", "").points.size() == 2);
    CHECK_THROWS_WITH(rig::replay::load_campaign(folder / "data.csv", "x"), ContainsSubstring("--campaign is for ledgers"));
    CHECK_THROWS_AS(rig::replay::load_campaign(folder.path(), ""), settings::Error);
}

TEST_CASE("the bridge's directory is a campaign, and a directory of CSV files is many", "[WEAR-001]") {
    const Folder folder("wear_many");
    {
        rig::record::Ledger ledger(folder / "campaign.sqlite", {.durable = false});
        ledger.open_campaign(campaign("first"), rig::record::IfChanged::reject);
        enter(ledger, "first", 1, "finished", 1.0e6, 0.31);
        enter(ledger, "first", 2, "finished", 2.4e6, 0.30);
    }
    CHECK(rig::replay::load_campaign(folder.path(), "").points.size() == 2);
    std::filesystem::create_directories(folder / "many");
    std::ofstream(folder / "many/b.csv") << "cumulative_energy_MJ,mean_friction\n1,0.3\n2,0.29\n";
    std::ofstream(folder / "many/a.csv") << "cumulative_energy_MJ,mean_friction\n1,0.4\n2,0.29\n";
    const auto all = rig::replay::load_campaigns({folder / "many", folder.path()});
    REQUIRE(all.size() == 3);
    CHECK(all[0].points[0].mean_friction == 0.4);
    CHECK(all[2].points.size() == 2);
    std::filesystem::create_directories(folder / "none");
    CHECK_THROWS_AS(rig::replay::load_campaigns({folder / "none"}), settings::Error);
}

TEST_CASE("nobody's brake is judged by made-up ones unless that is asked for", "[WEAR-071]") {
    plant_sim::lab::PopulationOptions options;
    CHECK_THROWS_WITH(options.read(), ContainsSubstring("made up"));
    options.assume_made_up = true;
    CHECK(options.read().population.provenance.made_up());
    options = {"config/wear/model.json", false};
    CHECK(options.read().population.provenance.lives == 1);
}

TEST_CASE("a landing's energy and the torque reserve are those of the configuration", "[WEAR-050]") {
    // By hand: light 2800 kg at 49 m/s, medium_a 3150 at 52, medium_b 3300 at 53, 76 % to the brake, an eighth on the model's axis.
    const wear::ConfiguredMix c = wear::configured_mix("config", "light=1,medium=3", 0.24);
    REQUIRE(c.mix.size() == 3);
    CHECK(c.mix[0].name == "light");
    CHECK(c.mix[0].share == Approx(0.25));
    CHECK(c.mix[0].energy_J == Approx(0.5 * 2800.0 * 49.0 * 49.0 * 0.76 / 8.0));
    CHECK(c.mix[2].name == "medium_b");
    CHECK(c.mix[2].share == Approx(0.375));
    CHECK(c.mix[2].energy_J == Approx(0.5 * 3300.0 * 53.0 * 53.0 * 0.76 / 8.0));
    CHECK_THROWS_WITH(wear::configured_mix("config", "lihgt=1", 0.24), ContainsSubstring("no maneuver 'lihgt'"));
    CHECK_THROWS_WITH(wear::configured_mix("config", "light", 0.24), ContainsSubstring("is no share"));
    CHECK_THROWS_WITH(wear::configured_mix("config", "light=-1", 0.24), ContainsSubstring("is no share"));

    // Heavy: 4450 kg. At the limit the torque at the speed named is that of full pressure, by the heavy curve of landing_gear.toml shifted to the
    // mean, and a dry runway's 1.17 F_z r.
    const wear::ReserveLimit r = wear::reserve_limit("config");
    const double v = r.speed_mps;
    const double F_z = 4450.0 * 9.80665 - 0.5 * 1.225 * 5.9 * v * v;
    const double wanted_Nm = 1.170 * F_z * (0.335 - F_z / 2.7e6);
    CHECK(r.torque_Nm == Approx(wanted_Nm).epsilon(2e-3));
    const double x = v / 61.0;
    const double relative = 1.22 - 1.02 * x + 0.72 * x * x + 0.20 * x * x * x;
    // The curve is 0.30 times the relative one for a new brake, moved down as a whole.
    const double mu = r.friction + 0.30 * (relative - 1.0);
    CHECK(2.07e7 * 8.04e-4 * 36.0 * 0.12 * mu == Approx(wanted_Nm).epsilon(5e-3));
    CHECK(r.friction > 0.15);
    CHECK(r.friction < 0.30);

    // Springs that take 2.07 of the 20.7 MPa leave nine tenths of the torque: nearly a ninth more friction is needed, at the same speed.
    const Folder folder("springs");
    std::filesystem::copy("config", folder / "config", std::filesystem::copy_options::recursive);
    std::ofstream(folder / "config/landing_gear.toml", std::ios::app)
        << "\n[brake.clamping]\ncontact_Pa = 2.07e6\npiston_friction = 0.0\nrun_out = 0.0\nwarp = 0.0\n";
    CHECK(wear::reserve_limit(folder / "config").friction - r.friction == Approx(mu / 9.0).epsilon(0.03));
}

TEST_CASE("of a ledger whose disc was changed the newest disc is a campaign, with the energy that it took", "[WEAR-001]") {
    const Folder folder("wear_discs");
    {
        rig::record::Ledger ledger(folder / "campaign.sqlite", {.durable = false});
        rig::record::Campaign c = campaign("first");
        c.specimen.disc = "D7";
        ledger.open_campaign(c, rig::record::IfChanged::reject);
        enter(ledger, "first", 1, "finished", 1.0e6, 0.31);
        enter(ledger, "first", 2, "finished", 2.0e6, 0.30);
        c.specimen.disc = "D8";
        ledger.open_campaign(c, rig::record::IfChanged::go_on);
        enter(ledger, "first", 3, "load lost", 2.5e6, 0.05);
        enter(ledger, "first", 3, "finished", 3.5e6, 0.36);
        enter(ledger, "first", 4, "finished", 4.5e6, 0.35);
        ledger.note(4, 1, {.field = "lining_worn", .text = "0.4", .who = "Kim", .made = "t"});
    }
    const wear::Campaign read = rig::replay::load_campaign(folder.path(), "");
    CHECK(read.disc == "D8");
    CHECK(read.points == std::vector<wear::Point>{{1.5e6, 0.36}, {2.5e6, 0.35}});
    CHECK(read.readings.empty());  // the lining has worn on both discs, the energy is that of one
    CHECK_THAT(read.source, ContainsSubstring("readings of the lining left out: another disc has worn it, too"));
    CHECK_THAT(read.source, ContainsSubstring("(brake '', disc 'D8'; 2 maneuvers of others left out)"));
}
