#include "plant_sim/campaign_source.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "rig_bridge/record/ledger.hpp"
#include "tests/catch.hpp"

namespace {

/// A directory of its own, gone afterwards.
class Folder {
  public:
    explicit Folder(const std::string& name)
        : path_(std::filesystem::temp_directory_path() / (name + std::to_string(::getpid()))) {
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

void enter(rig::Ledger& ledger, const std::string& campaign, std::int64_t number, const std::string& outcome,
           double c_e_J, double friction) {
    (void)ledger.begin(number, "2026-01-01T00:00:00Z");
    rig::Summary s;
    s.campaign = campaign;
    s.number = number;
    s.outcome = outcome;
    s.started = "2026-01-01T00:00:00Z";
    s.cumulative_energy_J = c_e_J;
    s.figures.mean_friction = friction;
    ledger.finish(s);
}

rig::Campaign campaign(const std::string& name) {
    rig::Campaign c;
    c.name = name;
    c.scenario = "endurance";
    c.planned = 10;
    return c;
}

}  // namespace

TEST_CASE("a ledger is a campaign", "[WEAR-014]") {
    const Folder folder("wear_ledger");
    {
        rig::Ledger ledger(folder / "ledger.sqlite", {.durable = false});
        ledger.open_campaign(campaign("first"), rig::IfChanged::refuse);
        enter(ledger, "first", 1, "finished", 1.0e6, 0.31);
        enter(ledger, "first", 2, "load lost", 1.4e6, 0.05);
        enter(ledger, "first", 2, "finished", 2.4e6, 0.30);
        enter(ledger, "first", 3, "finished", 3.4e6, 0.29);
    }
    const wear::Campaign by_file = plant_sim::load_campaign(folder / "ledger.sqlite", "");
    REQUIRE(by_file.points.size() == 3);
    CHECK(by_file.points[0] == wear::Point{1.0e6, 0.31});
    // The aborted attempt is no point, but what it took is.
    CHECK(by_file.points[1] == wear::Point{2.4e6, 0.30});
    CHECK(plant_sim::load_campaign(folder.path(), "first").points == by_file.points);
    {
        rig::Ledger ledger(folder / "ledger.sqlite", {.durable = false});
        ledger.open_campaign(campaign("second"), rig::IfChanged::refuse);
        enter(ledger, "second", 1, "finished", 1.0e6, 0.31);
    }
    CHECK_THROWS_WITH(plant_sim::load_campaign(folder.path(), ""),
                      ContainsSubstring("choose one with --campaign: first, second"));
    CHECK_THROWS_WITH(plant_sim::load_campaign(folder.path(), "second"),
                      ContainsSubstring("one maneuver only"));
    CHECK_THROWS_WITH(plant_sim::load_campaign(folder.path(), "third"), ContainsSubstring("third"));
}

TEST_CASE("what is no ledger is read as CSV", "[WEAR-014]") {
    const Folder folder("wear_csv");
    std::ofstream(folder / "data.csv") << "cumulative_energy_MJ,mean_friction\n1,0.3\n2,0.29\n";
    CHECK(plant_sim::load_campaign(folder / "data.csv", "").points.size() == 2);
    CHECK_THROWS_WITH(plant_sim::load_campaign(folder / "data.csv", "x"),
                      ContainsSubstring("--campaign is for ledgers"));
    CHECK_THROWS_AS(plant_sim::load_campaign(folder.path(), ""), settings::Error);
}
