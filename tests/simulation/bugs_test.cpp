#include <fmt/core.h>

#include <optional>
#include <string>

#include "plant_sim/simulation/disk_campaign.hpp"
#include "tests/catch.hpp"
#include "tests/simulation/careless.hpp"

using plant_sim::simulation::DiskCampaignSetup;
using plant_sim::simulation::ReadLog;
using simulation_test::Careless;
using simulation_test::Mistake;

namespace {

struct DiskBug {
    std::string name;
    DiskCampaignSetup setup;
};

DiskBug of_storage(const char* name, Mistake mistake) {
    DiskBug bug{.name = name, .setup = {}};
    bug.setup.storage = [mistake](auto disk) { return std::make_shared<Careless>(std::move(disk), mistake); };
    return bug;
}

std::vector<DiskBug> disk_bugs() {
    std::vector<DiskBug> all{of_storage("sync of a file left out", Mistake::file_not_synced),
                             of_storage("sync of a directory left out", Mistake::directory_not_synced),
                             of_storage("renamed before it is synced", Mistake::renamed_before_sync),
                             of_storage("short write taken as whole", Mistake::short_write_is_whole),
                             of_storage("refused write taken as written", Mistake::refused_write_is_written),
                             of_storage("refused sync taken as synced", Mistake::refused_sync_is_synced)};
    all.push_back({.name = "ledger with synchronous = OFF", .setup = {}});
    all.back().setup.durable = false;
    all.push_back({.name = "ledger with synchronous = FULL", .setup = {}});
    all.back().setup.deviation = plant_sim::simulation::SqliteDeviation::removal_not_synced;
    all.push_back({.name = "cumulative energy not restored", .setup = {}});
    all.back().setup.taken_J = [](const auto&) { return 0.0; };
    all.push_back({.name = "torn tail believed", .setup = {}});
    all.back().setup.reading = [](ReadLog read) {
        read.damage_named = false;
        return read;
    };
    all.push_back({.name = "said to be finished before the ledger has it", .setup = {}});
    all.back().setup.says_early = true;
    all.push_back({.name = "record with missing lines counted", .setup = {}});
    all.back().setup.counts_lost = true;
    return all;
}

/// The first seed that finds it.
std::optional<std::uint64_t> found(const DiskCampaignSetup& setup) {
    constexpr std::uint64_t kSeeds = 2000;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed)
        if (!plant_sim::simulation::run_disk_campaign(seed, setup).violations.empty()) return seed;
    return std::nullopt;
}

}  // namespace

TEST_CASE("each mistake with the disk is found by the invariants of a campaign", "[BRG-700]") {
    for (const DiskBug& bug : disk_bugs()) {
        INFO(bug.name);
        const auto seed = found(bug.setup);
        fmt::print("{:60} {}\n", bug.name, seed ? fmt::format("seed {}", *seed) : "not found");
        CHECK(seed.has_value());
    }
}
