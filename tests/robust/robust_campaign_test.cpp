/// The campaign itself: the same rows whatever the threads, every law on the same plants, summaries that count right.
#include "plant_sim/study/robust/robust_campaign.hpp"

#include <thread>

#include "firmware/host/settings/json.hpp"
#include "plant_sim/study/robust/report.hpp"
#include "tests/catch.hpp"
#include "tests/study/team_of_threads.hpp"

using namespace robust;

TEST_CASE("rows do not depend on threads, and come in the order of the plan", "[STUDY-602]") {
    RobustPlanOptions options;
    options.families = {"ring", "speed"};
    options.laws = {"slip", "threshold"};
    options.draws = 2;
    const RobustPlan plan = load_plan(options);
    const std::vector<DrawnStop> one = run(plan, {.threads = 1});
    const std::vector<DrawnStop> three = run(plan, {.threads = 3});
    REQUIRE(one.size() == plan.stops());
    REQUIRE(three.size() == one.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        CHECK(one[i].family == plan.families[i / 4]);
        CHECK(one[i].law == i / 2 % 2);
        CHECK(one[i].number == i % 2);
        CHECK(one[i].figures == three[i].figures);
        CHECK(one[i].figures.valve_travel_mAps > 0.0);
    }
    CHECK(to_csv(plan, one) == to_csv(plan, three));
}

TEST_CASE("three processes give the rows of one; one with another plan refuses to work", "[STUDY-602]") {
    RobustPlanOptions options;
    options.families = {"speed"};
    options.laws = {"slip"};
    options.draws = 5;
    const RobustPlan plan = load_plan(options);
    threads::Wire wire;
    std::vector<std::vector<DrawnStop>> rows(3);
    std::size_t last = 0;
    {
        std::vector<std::jthread> processes;
        for (std::size_t rank = 0; rank < 3; ++rank)
            processes.emplace_back([&, rank] {
                threads::Member member(wire, rank, 3);
                RunOptions run_options;
                if (rank == 0) run_options.progress = [&last](std::size_t done) { last = done; };
                rows[rank] = run(plan, run_options, member);
            });
    }
    CHECK(last == 5);
    CHECK(rows[1].empty());
    CHECK(rows[2].empty());
    CHECK(to_csv(plan, rows[0]) == to_csv(plan, run(plan, {})));

    RobustPlan other = plan;
    other.seed = 2;
    threads::Member member(wire, 1, 3);  // the leader has spoken
    CHECK_THROWS_WITH(run(other, {}, member), ContainsSubstring("other stops than the leading one"));
}

TEST_CASE("a summary counts what its rows say", "[STUDY-602]") {
    RobustPlanOptions options;
    options.families = {"paper"};
    options.laws = {"slip"};
    options.draws = 200;
    const RobustPlan plan = load_plan(options);
    std::vector<DrawnStop> rows;
    for (std::size_t i = 0; i < 200; ++i) {
        DrawnStop row;
        row.number = i;
        row.figures.j_mu = 0.5 + static_cast<double>((i * 7) % 200) * 1e-3;
        row.figures.longest_lock_s = i < 3 ? 0.051 : 0.05;
        if (i % 50 == 0) row.faults.insert(antiskid::control::Fault::lock_persists);
        row.figures.valve_travel_mAps = 10.0;
        rows.push_back(row);
    }
    const std::vector<Summary> all = summarise(plan, rows);
    REQUIRE(all.size() == 1);
    CHECK(all[0].stops == 200);
    CHECK(all[0].brakes_released == 4);
    CHECK(all[0].locked == 3);
    CHECK(all[0].mean_j_mu == Approx(0.5 + 0.0995));
    CHECK(all[0].percentile_j_mu == Approx(0.501));
    CHECK(all[0].worst_j_mu == Approx(0.5));
    CHECK(all[0].worst == 0);
    CHECK_THAT(to_table(plan, rows, all), ContainsSubstring("paper, slip: worst: draw 0 (light "));
    CHECK(all[0].mean_travel_mAps == Approx(10.0));
    const auto json = settings::parse_json(to_json(plan, rows, all));
    CHECK(json["families"][0]["ended_safe"] == 4);
    CHECK_THAT(to_table(plan, rows, all), ContainsSubstring("| paper | slip | 200 | 4 | 3 |"));
}

TEST_CASE("families and laws that are not there are named", "[STUDY-602]") {
    RobustPlanOptions options;
    options.families = {"rings"};
    CHECK_THROWS_WITH(load_plan(options), ContainsSubstring("relaxation"));
    options.families = {"ring"};
    options.laws = {"bang"};
    CHECK_THROWS_WITH(load_plan(options), ContainsSubstring("threshold, pressure_bias"));
}
