/// However the stops are shared out, the table is the same, byte for byte.
#include "plant_sim/study/sweep/run.hpp"

#include <unistd.h>

#include <fstream>
#include <iterator>
#include <numeric>
#include <thread>

#include "plant_sim/study/in_process.hpp"
#include "plant_sim/study/sweep/part_file.hpp"
#include "plant_sim/study/sweep/together.hpp"
#include "plant_sim/study/team/shared_work.hpp"
#include "tests/catch.hpp"
#include "tests/study/team_of_threads.hpp"
#include "tests/sweep/small_plan.hpp"

namespace {

std::string csv_of(const sweep::SweepPlan& plan, std::span<const sweep::SweptStop> rows) {
    return sweep::to_csv(sweep::identity_of(plan), rows);
}

/// Runs stop `number` alone.
sweep::SweptStop run_one(const sweep::SweepPlan& plan, std::size_t number) {
    const study::RunResult result = study::run_in_process(plan.controller, plan.layout, plan.rig(number), plan.session(number), study::Link::rounded);
    return {.stop = plan.stop(number), .figures = result.figures, .faults = result.faults};
}

/// By one thread, from the last stop to the first: what every other way is held against.
const std::string& reference_csv() {
    static const std::string kCsv = [] {
        const sweep::SweepPlan plan = small::plan();
        std::vector<sweep::SweptStop> rows;
        for (std::size_t i = plan.stops(); i-- > 0;) rows.insert(rows.begin(), run_one(plan, i));
        return csv_of(plan, rows);
    }();
    return kCsv;
}

struct Scratch {
    std::filesystem::path path = std::filesystem::temp_directory_path() / ("sweep_test_" + std::to_string(::getpid()));
    Scratch() { std::filesystem::create_directories(path); }
    ~Scratch() { std::filesystem::remove_all(path); }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
};

std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

TEST_CASE("the number of threads and the order of work change no byte", "[STUDY-148]") {
    const sweep::SweepPlan plan = small::plan();
    std::vector<std::size_t> in_order(plan.stops());
    std::iota(in_order.begin(), in_order.end(), std::size_t{0});
    CHECK(csv_of(plan, sweep::run(plan, in_order, {.threads = 1})) == reference_csv());
    CHECK(csv_of(plan, sweep::run(plan, study::team::order_of_work(plan.stops()), {.threads = 5})) == reference_csv());
    const sweep::SweepPlan other = small::plan(2);
    CHECK(csv_of(other, sweep::run(other, in_order, {.threads = 2})) != reference_csv());
}

namespace {

/// Enough stops that those which threads have begun together are not all.
std::vector<double> many_references() {
    std::vector<double> references;
    for (int i = 10; i <= 30; ++i) references.push_back(i / 100.0);
    return references;
}

}  // namespace

TEST_CASE("what a stop or an observer throws ends the run and comes out of it", "[STUDY-148]") {
    const sweep::SweepPlan plan = small::plan(1, many_references());
    const auto numbers = study::team::order_of_work(plan.stops());
    std::size_t seen = 0;
    const auto full_disk = [&seen](const sweep::SweptStop&) {
        if (++seen == 2) throw std::runtime_error("no space left on device");
    };
    CHECK_THROWS_WITH(sweep::run(plan, numbers, {.threads = 3, .on_row = full_disk}), "no space left on device");
    CHECK(seen < plan.stops());
}

TEST_CASE("a sweep that is stopped or killed goes on: nothing twice, nothing lost, the same bytes", "[STUDY-148]") {
    const Scratch scratch;
    const auto part = scratch.path / "new" / "stops.part";
    const sweep::SweepPlan plan = small::plan(1, many_references());
    threads::Wire wire;
    threads::Member team(wire, 0, 1);
    std::atomic<bool> stop{false};
    sweep::Work work{.part = part, .threads = 2, .stop = &stop};
    work.progress = [&stop](std::size_t done, std::size_t all, std::size_t before) {
        CHECK(all == 88);
        CHECK(before == 0);
        if (done == 4) stop.store(true);
    };
    const auto first = sweep::run_together(plan, work, team);
    REQUIRE(first.size() >= 4);
    REQUIRE(first.size() < 88);

    // Killed in the middle of a line.
    std::ofstream(part, std::ios::app | std::ios::binary) << "11,threshold,0,3,dry_as";
    stop.store(false);
    std::size_t ran = 0;
    work.progress = [&](std::size_t, std::size_t, std::size_t before) {
        CHECK(before == first.size());
        ++ran;
    };
    const auto second = sweep::run_together(plan, work, team);
    CHECK(ran == 88 - first.size());
    const auto at_once = sweep::run(plan, study::team::order_of_work(plan.stops()), {.threads = 2});
    CHECK(csv_of(plan, second) == csv_of(plan, at_once));
    CHECK(sweep::read_stops(part).rows.size() == 88);

    // Killed before the first lines were whole.
    const std::string whole = text_of(part);
    std::ofstream(part, std::ios::trunc | std::ios::binary) << whole.substr(0, 30);
    CHECK(sweep::PartFile(part, plan).rows().empty());
    CHECK(whole.starts_with(text_of(part)));
}

TEST_CASE("what another sweep left is refused, and named; it is not touched", "[STUDY-148]") {
    const Scratch scratch;
    const auto part = scratch.path / "stops.part";
    const sweep::SweepPlan plan = small::plan();
    {
        sweep::PartFile file(part, plan);
        file.append(sweep::line(run_one(plan, 0)));
        CHECK_THROWS_WITH(sweep::PartFile(part, plan), ContainsSubstring("another sweep is at work on it"));
    }
    const std::string before = text_of(part);
    sweep::SweepPlan other = plan;
    other.seed = 2;
    CHECK_THROWS_WITH(sweep::PartFile(part, other), ContainsSubstring("seed 1 instead of 2"));
    other = plan;
    other.config_hash = "another";
    CHECK_THROWS_WITH(sweep::PartFile(part, other), ContainsSubstring("instead of another"));
    other = plan;
    other.version = "9";
    CHECK_THROWS_WITH(sweep::PartFile(part, other), ContainsSubstring("version"));
    other = plan;
    other.landings[0].sensor_seed += 1;
    CHECK_THROWS_WITH(sweep::PartFile(part, other), ContainsSubstring("is another stop"));
    CHECK(text_of(part) == before);
    std::ofstream(part, std::ios::trunc) << "notes of mine";
    CHECK_THROWS_AS(sweep::PartFile(part, plan), settings::Error);
    CHECK(text_of(part) == "notes of mine");
}

TEST_CASE("three processes give the bytes of one, and go on where one was stopped", "[STUDY-148]") {
    const Scratch scratch;
    const sweep::SweepPlan plan = small::plan();
    const auto part = scratch.path / "stops.part";
    {
        sweep::PartFile file(part, plan);
        file.append(sweep::line(run_one(plan, 5)));
    }
    threads::Wire wire;
    std::vector<sweep::SweptStop> rows;
    std::vector<std::size_t> others(3, 1);
    {
        std::vector<std::jthread> processes;
        for (std::size_t rank = 0; rank < 3; ++rank)
            processes.emplace_back([&, rank] {
                threads::Member member(wire, rank, 3);
                auto found = sweep::run_together(plan, {.part = part, .threads = 1}, member);
                if (rank == 0) rows = found;
                others[rank] = found.size();
            });
    }
    CHECK(others == std::vector<std::size_t>{12, 0, 0});
    CHECK(csv_of(plan, rows) == reference_csv());
}

TEST_CASE("a process with another plan than the leader's refuses to work", "[STUDY-148]") {
    threads::Wire wire;
    const sweep::SweepPlan plan = small::plan();
    wire.from_leader = csv_of(plan, {});
    sweep::SweepPlan other = plan;
    other.config_hash = "another";
    threads::Member member(wire, 1, 2);
    CHECK_THROWS_WITH(sweep::run_together(other, {}, member), ContainsSubstring("another sweep than the leading one"));
}
