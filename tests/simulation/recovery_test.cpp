// What campaigns on the simulated disk once found, each by itself.
#include <memory>

#include "firmware/host/settings/atomic_file.hpp"
#include "plant_sim/simulation/simulated_disk.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "tests/catch.hpp"
#include "tests/simulation/careless.hpp"

using plant_sim::simulation::DiskFault;
using plant_sim::simulation::SimulatedDisk;
using rig::record::Ledger;
using rig::record::LedgerOptions;
using simulation_test::Careless;
using simulation_test::Mistake;

namespace {

const rig::record::Campaign kCampaign{
    .name = "endurance", .scenario = "heavy", .seed = 1, .planned = 3, .config_hash = "c", .version = "v", .created = "2026"};

/// Which operation of Ledger::finish() syncs the directory of a new journal.
constexpr std::uint64_t kNameOfJournal = 16;

LedgerOptions on(std::shared_ptr<const settings::Storage> storage) {
    LedgerOptions options;
    options.storage = std::move(storage);
    return options;
}

rig::record::Summary summary() {
    rig::record::Summary s;
    s.campaign = kCampaign.name;
    s.number = 1;
    s.scenario = "heavy";
    s.outcome = "finished";
    return s;
}

}  // namespace

TEST_CASE("a summary that a dead bridge left is on the disk before its maneuver is finished", "[BRG-700]") {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const auto disk = std::make_shared<SimulatedDisk>(seed);
        std::filesystem::path file;
        {
            Ledger ledger("/runs/campaign.sqlite", on(disk));
            (void)ledger.open_campaign(kCampaign, rig::record::IfChanged::reject);
            file = ledger.begin(1, "2026").folder / "summary.json";
            settings::create_directories(file.parent_path(), *disk);
            rig::record::write_summary(file, summary(), Careless(disk, Mistake::directory_not_synced));
        }
        CHECK(Ledger("/runs/campaign.sqlite", on(disk)).open_campaign(kCampaign, rig::record::IfChanged::reject).adopted.size() == 1);
        disk->restart();
        CHECK(std::filesystem::exists(disk->status(file)));
    }
}

TEST_CASE("a directory that was there, but not on the disk, is so before anything counts on it", "[BRG-700]") {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const auto disk = std::make_shared<SimulatedDisk>(seed);
        REQUIRE(disk->make_directory("/runs") == 0);
        const std::filesystem::path folder = seed % 2 == 0 ? "/runs" : "/runs/brake7";
        settings::create_directories(folder, *disk);
        disk->restart();
        CHECK(std::filesystem::exists(disk->status(folder)));
    }
}

TEST_CASE("what the ledger refused is not in it, and what may be in it is named", "[BRG-700]") {
    bool in_doubt = false;
    bool refused = false;
    for (std::uint64_t at = 1;; ++at) {
        const auto disk = std::make_shared<SimulatedDisk>(5);
        Ledger ledger("/runs/campaign.sqlite", on(disk));
        (void)ledger.open_campaign(kCampaign, rig::record::IfChanged::reject);
        (void)ledger.begin(1, "2026");
        disk->clear_faults();
        disk->inject(at, DiskFault::refused);
        try {
            ledger.finish(summary());
            if (disk->fault_counts()[static_cast<std::size_t>(DiskFault::refused)] == 0) break;
        } catch (const rig::record::LedgerInDoubt&) {
            in_doubt = true;
        } catch (const rig::record::LedgerError&) {
            refused = true;
            CHECK(rig::record::read_ledger("/runs/campaign.sqlite", kCampaign.name, on(disk)).at(0).state == rig::record::RowState::running);
        }
    }
    CHECK(in_doubt);
    CHECK(refused);
}

TEST_CASE("what the next start reads in the ledger outlives a power cut, although the disk refused its last sync", "[BRG-700]") {
    int in_doubt = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        for (std::uint64_t at = kNameOfJournal; at < kNameOfJournal + 20; ++at) {
            const auto disk = std::make_shared<SimulatedDisk>(seed);
            {
                Ledger ledger("/runs/campaign.sqlite", on(disk));
                (void)ledger.open_campaign(kCampaign, rig::record::IfChanged::reject);
                (void)ledger.begin(1, "2026");
                disk->clear_faults();
                disk->inject(at, DiskFault::refused);
                try {
                    ledger.finish(summary());
                    continue;
                } catch (const rig::record::LedgerInDoubt&) {
                    ++in_doubt;
                } catch (const rig::record::LedgerError&) {
                    continue;
                }
            }
            disk->clear_faults();
            std::int64_t read = 0;
            {
                Ledger next("/runs/campaign.sqlite", on(disk));
                (void)next.open_campaign(kCampaign, rig::record::IfChanged::reject);
                read = next.finished_count();
            }
            CHECK(read == 1);
            disk->restart();
            Ledger later("/runs/campaign.sqlite", on(disk));
            (void)later.open_campaign(kCampaign, rig::record::IfChanged::reject);
            CHECK(later.finished_count() == read);
        }
    }
    CHECK(in_doubt == 40);
}

TEST_CASE("what SQLite lets be: the name of its journal refused, and the power cut in the same commit", "[BRG-700]") {
    int damaged = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const auto disk =
            std::make_shared<SimulatedDisk>(seed, plant_sim::simulation::DiskTrace{}, plant_sim::simulation::SqliteDeviation::journal_name_unnoticed);
        const LedgerOptions options = on(disk);
        {
            Ledger ledger("/runs/campaign.sqlite", options);
            (void)ledger.open_campaign(kCampaign, rig::record::IfChanged::reject);
            (void)ledger.begin(1, "2026");
            disk->clear_faults();
            disk->inject(kNameOfJournal, DiskFault::refused);
            disk->inject(kNameOfJournal + 5, DiskFault::power_cut);
            CHECK_THROWS_AS(ledger.finish(summary()), rig::record::LedgerError);
        }
        disk->restart();
        try {
            (void)rig::record::read_ledger("/runs/campaign.sqlite", kCampaign.name, options);
        } catch (const rig::record::LedgerError& error) {
            ++damaged;
            CHECK_THAT(error.what(), ContainsSubstring("is damaged"));
        }
    }
    CHECK(damaged > 0);
}
