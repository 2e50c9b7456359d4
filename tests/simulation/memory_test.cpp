// The n-th allocation fails that the bridge makes beside its main loop, SQLite's included.
#include <fmt/core.h>
#include <sqlite3.h>

#include <cstdint>
#include <cstdlib>
#include <new>
#include <vector>

#include "plant_sim/simulation/cell_campaign.hpp"
#include "tests/catch.hpp"

using plant_sim::simulation::BridgeMistake;
using plant_sim::simulation::CellFault;
using plant_sim::simulation::CellOutcome;
using plant_sim::simulation::CellSetup;
using plant_sim::simulation::PlannedFault;
using plant_sim::simulation::run_cell_campaign;

namespace {

// Operator new has no other place for them. NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
bool counts = false;
std::uint64_t allocations = 0;
std::uint64_t failing = 0;  // none
sqlite3_mem_methods sqlite{};
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

bool fails() {
    return counts && ++allocations == failing;
}

/// Before SQLite's first use.
void take_sqlite_in() {
    sqlite3_config(SQLITE_CONFIG_GETMALLOC, &sqlite);
    sqlite3_mem_methods counted = sqlite;
    counted.xMalloc = [](int size) { return fails() ? nullptr : sqlite.xMalloc(size); };
    counted.xRealloc = [](void* old, int size) { return fails() ? nullptr : sqlite.xRealloc(old, size); };
    REQUIRE(sqlite3_config(SQLITE_CONFIG_MALLOC, &counted) == SQLITE_OK);
}

const CellSetup& sound_cell_with_counted_memory() {
    static const CellSetup setup = [] {
        take_sqlite_in();
        CellSetup made = plant_sim::simulation::load_cell_setup("config");
        made.allocations = [](bool on) { counts = on; };
        return made;
    }();
    return setup;
}

constexpr std::uint64_t kSeed = 2;  // of a campaign of one maneuver

/// What the next bridge does with what it left is to run out of memory, too.
const std::vector<PlannedFault> kKilled{{.fault = CellFault::bridge_killed, .phase = rig::Phase::braking, .after_s = 0.4, .lasts_s = 0.3}};

CellOutcome campaign(const CellSetup& setup, std::uint64_t fails_at) {
    allocations = 0;
    failing = fails_at;
    CellOutcome outcome = run_cell_campaign(setup, kSeed, kKilled);
    failing = 0;
    return outcome;
}

struct Found {
    std::int64_t campaigns = 0, ended = 0, violated = 0;
};

/// Fails every allocation that `next` gives, from `n` on, until there are no more or, where a mistake is put in, until it is found.
template <typename Next>
Found fail_each(const CellSetup& setup, std::uint64_t n, const Next& next) {
    Found found;
    for (;; n = next(n)) {
        const CellOutcome outcome = campaign(setup, n);
        if (allocations < n) return found;
        ++found.campaigns;
        if (outcome.refusals > 0) ++found.ended;
        if (!outcome.violations.empty()) ++found.violated;
        if (setup.mistake != BridgeMistake::none) {
            if (found.violated > 0) return found;
            continue;
        }
        INFO("allocation " << n);
        for (const std::string& violation : outcome.violations) UNSCOPED_INFO(violation);
        CHECK(outcome.violations.empty());
    }
}

}  // namespace

void* operator new(std::size_t size) {
    if (!fails())
        if (void* const got = std::malloc(size == 0 ? 1 : size)) return got;
    throw std::bad_alloc();
}
/// A sanitizer's own would not come here.
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
    return fails() ? nullptr : std::malloc(size == 0 ? 1 : size);
}
void operator delete(void* pointer) noexcept {
    std::free(pointer);
}
void operator delete(void* pointer, std::size_t /*size*/) noexcept {
    std::free(pointer);
}

TEST_CASE("whichever allocation fails beside the main loop, nothing is lost or half-written and the campaign ends", "[BRG-703]") {
    const Found found = fail_each(sound_cell_with_counted_memory(), 1, [](std::uint64_t n) { return n + 1 + n / 4; });
    fmt::print("{} campaigns, {} with a bridge that ended\n", found.campaigns, found.ended);
    CHECK(found.campaigns > 25);
    CHECK(found.ended > found.campaigns / 2);
}

TEST_CASE("every single allocation", "[.]") {
    const Found found = fail_each(sound_cell_with_counted_memory(), 1, [](std::uint64_t n) { return n + 1; });
    fmt::print("{} campaigns, {} with a bridge that ended\n", found.campaigns, found.ended);
}

TEST_CASE("a bridge that overlooks that there is no memory is found", "[BRG-703]") {
    CellSetup setup = sound_cell_with_counted_memory();
    REQUIRE(campaign(setup, 0).violations.empty());
    const std::uint64_t all = allocations;
    setup.mistake = BridgeMistake::ignores_no_memory;
    CHECK(fail_each(setup, all - all / 4, [all](std::uint64_t n) { return n + all / 40; }).violated > 0);
}
