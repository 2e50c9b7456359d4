/// The fault campaign: what its numbers mean, that nothing but them and the seed decides, and a sample of it.
#include "tests/catch.hpp"

#include <set>
#include <tuple>

#include "plant_sim/study/faults/report.hpp"

namespace {

faults::FaultPlan plan(std::vector<std::string> surfaces, std::size_t repetitions) {
    faults::FaultPlanOptions options;
    options.surfaces = std::move(surfaces);
    options.repetitions = repetitions;
    return faults::load_plan(options);
}

/// Every `step`-th run.
std::vector<std::size_t> every(const faults::FaultPlan& p, std::size_t step) {
    std::vector<std::size_t> numbers;
    for (std::size_t i = step / 2; i < p.runs(); i += step) numbers.push_back(i);
    return numbers;
}

}  // namespace

TEST_CASE("fault campaign: every fault in every phase on every surface, as often as asked for", "[RIG-700]") {
    const faults::FaultPlan p = plan({"dry_asphalt", "ice"}, 2);
    std::set<std::tuple<faults::Signal, faults::Kind, faults::StopPart, std::size_t, std::size_t>> seen;
    std::set<std::uint64_t> sensor_seeds;
    for (std::size_t i = 0; i < p.runs(); ++i) {
        const faults::Case c = p.at(i);
        CHECK(c.number == i);
        seen.insert({c.fault.what.signal, c.fault.what.kind, c.phase, c.surface, c.repetition});
        sensor_seeds.insert(c.sensor_seed);
    }
    CHECK(seen.size() == p.runs());
    CHECK(p.runs() == faults::catalogue().size() * 9 * 2 * 2);
    CHECK(sensor_seeds.size() == 4);
    CHECK(plan({"dry_asphalt", "wet_asphalt", "snow", "ice"}, 5).runs() >= 20'000);
}

TEST_CASE("fault campaign: the same bytes whatever the number of threads, and for a run alone", "[RIG-700]") {
    const faults::FaultPlan p = plan({"dry_asphalt"}, 1);
    const std::vector<std::size_t> numbers = every(p, 83);
    const auto one = faults::run_campaign(p, numbers, {.threads = 1});
    const auto three = faults::run_campaign(p, numbers, {.threads = 3});
    CHECK(faults::to_csv(p, one) == faults::to_csv(p, three));
    CHECK(faults::to_json(p, one) == faults::to_json(p, three));
    const faults::JudgedRun& row = one.at(3);
    const faults::Case again = p.at(row.run.number);
    CHECK(faults::run_one(p, again, faults::run_fault_free(p, again)).verdict == row.result.verdict);
}

TEST_CASE("fault campaign: a stop that was asked to end runs no more", "[RIG-700]") {
    const faults::FaultPlan p = plan({"dry_asphalt"}, 1);
    const std::atomic<bool> stop{true};
    CHECK(faults::run_campaign(p, every(p, 83), {.threads = 2, .stop = &stop}).empty());
}

TEST_CASE("fault campaign: a sample of it has nothing unsafe, and all the other outcomes", "[RIG-700]") {
    const faults::FaultPlan p = plan({"dry_asphalt", "wet_asphalt"}, 1);
    std::set<faults::Outcome> outcomes;
    for (const faults::JudgedRun& row : faults::run_campaign(p, every(p, 13), {.threads = 2})) {
        INFO(faults::describe(p, row.run) << ": " << faults::describe(row.result));
        CHECK(row.result.verdict.outcome != faults::Outcome::unsafe);
        outcomes.insert(row.result.verdict.outcome);
    }
    CHECK(outcomes.contains(faults::Outcome::handled));
    CHECK(outcomes.contains(faults::Outcome::safe));
}
