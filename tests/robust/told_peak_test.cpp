/// The slip law told where the peak is: on one surface the slip law with that number, on a runway of patches with the number of each.
#include <cmath>
#include <set>

#include "firmware/host/settings/json.hpp"
#include "plant_sim/study/in_process.hpp"
#include "plant_sim/study/robust/report.hpp"
#include "tests/catch.hpp"

using namespace robust;

namespace {

RobustPlan told(const std::string& family, std::vector<std::string> laws = {"told_peak"}) {
    RobustPlanOptions options;
    options.families = {family};
    options.laws = std::move(laws);
    options.draws = 14;
    return load_plan(options);
}

double peak_of(const rig::Surface& s) {
    return std::log(s.c1 * s.c2 / s.c3) / s.c2;
}

}  // namespace

TEST_CASE("on one surface it is the slip law with that number, bit for bit", "[STUDY-602]") {
    for (const char* family : {"paper", "ring"}) {
        RobustPlan plan = told(family);
        if (plan.families.front() == Family::ring) plan.draws = 4;
        const std::vector<DrawnStop> rows = run(plan, {.threads = 2});
        REQUIRE(rows.size() == plan.draws);
        for (const DrawnStop& row : rows) {
            const Draw d = draw(plan.basis, row.family, plan.seed, row.number);
            INFO(describe(plan.basis, d));
            study::SessionOptions number = session(plan, {.name = "slip", .law = antiskid::control::Law::wheel_slip}, row.number);
            number.plan.slip_reference = rig::peak(d.rig.surface).slip;
            CHECK(number.plan.slip_reference == Approx(peak_of(d.rig.surface)).epsilon(1e-12));
            const auto stop = [&](const study::SessionOptions& options, study::Link link) {
                return study::run_in_process(plan.controller, plan.layout, d.rig, options, link);
            };
            CHECK(stop(number, study::Link::rounded).figures == row.figures);
            if (row.number > 1) continue;
            study::SessionOptions follows = session(plan, plan.laws.front(), row.number);
            follows.plan.slip_reference = 0.07;  // not used
            CHECK(stop(follows, study::Link::frames) == stop(number, study::Link::frames));
        }
    }
}

TEST_CASE("on patches the pilot gives the peak of the surface under the wheel, at every period", "[STUDY-602]") {
    const RobustPlan plan = told("patches");
    const Draw d = draw(plan.basis, Family::patches, plan.seed, 12);
    std::size_t periods = 0, wrong = 0;
    std::set<float> given;
    const auto watch = [&](const study::RigSession& session, const antiskid::can::ControllerView&, double) {
        const float now = session.sample().maneuver.slip_reference;
        wrong += std::abs(static_cast<double>(now) - peak_of(session.rig().surface())) > 1e-6 ? 1U : 0U;
        ++periods;
        given.insert(now);
    };
    const auto run = study::run_in_process(plan.controller, plan.layout, d.rig, session(plan, plan.laws.front(), 12), study::Link::rounded, watch);
    CHECK(run.figures.standstill);
    CHECK(periods > 3000);
    CHECK(wrong == 0);
    CHECK(given.size() >= 3);
}

TEST_CASE("no other law is told", "[STUDY-602]") {
    const RobustPlan plan = told("patches", {"slip", "peak_slip", "threshold", "pressure_bias"});
    for (const ComparedLaw& law : plan.laws) CHECK_FALSE(session(plan, law, 0).slip_reference);
}

TEST_CASE("distances are compared draw by draw; what did not come to rest is outside of 3 %", "[STUDY-602]") {
    RobustPlan plan = told("paper", {"peak_slip", "told_peak"});
    plan.draws = 100;
    std::vector<DrawnStop> rows;
    for (std::size_t law = 0; law < 2; ++law) {
        for (std::size_t i = 0; i < 100; ++i) {
            DrawnStop row;
            row.law = law;
            row.number = i;
            row.figures.standstill = true;
            row.figures.stop_distance_m = 100.0 + static_cast<double>(i);
            // 0.1 % longer from draw to draw, from the told one's own to 9.8 %; draw 99 gives up.
            if (law == 0) row.figures.stop_distance_m *= 1.0 + 1e-3 * static_cast<double>(i);
            if (law == 0 && i == 99) row.figures = {};
            rows.push_back(row);
        }
    }
    auto summaries = summarise(plan, rows);
    REQUIRE(summaries.size() == 2);
    const AgainstToldPeak ours = *summaries[0].against_told_peak, itself = *summaries[1].against_told_peak;
    CHECK(ours.draws == 100);
    CHECK(ours.within == Approx(0.30).margin(0.0101));  // 1.030 itself is a matter of rounding
    CHECK(ours.mean == Approx(1.0 + 1e-3 * 49.0));
    CHECK(ours.percentile_90 == Approx(1.089));
    CHECK(ours.percentile_99 == Approx(1.098));
    CHECK(itself.mean == 1.0);
    CHECK(itself.percentile_99 == 1.0);
    CHECK(itself.within == 1.0);
    auto json = settings::parse_json(to_json(plan, rows, summaries));
    CHECK(json["families"][0]["distance_over_told_peak"]["within_3_percent"] == ours.within);

    rows[98].figures.standstill = false;
    rows[100 + 50].figures.standstill = false;  // the told one gives up: nothing to compare with
    summaries = summarise(plan, rows);
    CHECK(summaries[0].against_told_peak->draws == 99);
    CHECK(std::isinf(summaries[0].against_told_peak->percentile_99));
    json = settings::parse_json(to_json(plan, rows, summaries));
    CHECK(json["families"][0]["distance_over_told_peak"]["percentile_99"].is_null());
    CHECK_THAT(to_table(plan, rows, summaries), ContainsSubstring("no stop"));

    plan.laws.pop_back();
    rows.resize(100);
    CHECK_FALSE(summarise(plan, rows)[0].against_told_peak);
}
