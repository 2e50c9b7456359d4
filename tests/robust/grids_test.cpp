/// Grids: every stop once, brought to the change at its speed, and counted right.
#include "plant_sim/study/robust/grids.hpp"

#include <cmath>
#include <set>
#include <tuple>

#include "firmware/host/settings/json.hpp"
#include "plant_sim/study/robust/brake_on_report.hpp"
#include "plant_sim/study/robust/changes_report.hpp"
#include "plant_sim/study/robust/report.hpp"
#include "tests/catch.hpp"

using namespace robust;

namespace {

RobustPlan grid(const std::string& family, std::vector<std::string> laws = {"slip"}) {
    RobustPlanOptions options;
    options.families = {family};
    options.laws = std::move(laws);
    return load_plan(options);
}

DrawnStop made_up(Family family, std::size_t number) {
    DrawnStop row;
    row.family = family;
    row.number = number;
    return row;
}

}  // namespace

TEST_CASE("a grid has every stop once, whatever the number of draws", "[STUDY-602]") {
    const RobustPlan plan = grid("changes");
    const Basis& basis = plan.basis;
    std::set<std::tuple<std::string, std::string, std::string, double>> changes;
    REQUIRE(plan.stops() == std::size_t{7} * 6 * 2 * 3);
    for (std::size_t i = 0; i < plan.stops(); ++i) {
        const SurfaceChange c = change_at(basis, i);
        CHECK(basis.landings[c.from].maneuver == basis.landings[c.to].maneuver);
        CHECK(basis.landings[c.from].surface != basis.landings[c.to].surface);
        changes.emplace(basis.landings[c.from].surface, basis.landings[c.to].surface, basis.landings[c.from].maneuver, c.speed_mps);
    }
    CHECK(changes.size() == plan.stops());

    std::set<std::pair<std::size_t, double>> brakings, first;
    const std::size_t stops = grid("brake_on").stops();
    REQUIRE(stops == std::size_t{7} * 7 * 2);
    for (std::size_t i = 0; i < stops; ++i) {
        const BrakeOn b = brake_on_at(basis, i);
        const Draw stop = draw(basis, Family::brake_on, 9, i);
        CHECK(stop.landing == b.landing);
        CHECK(stop.rig.brake_on_mps == b.speed_mps);
        CHECK(stop.rig.runway.patches.empty());
        brakings.emplace(b.landing, b.speed_mps);
        if (i < 7) first.emplace(0, b.speed_mps);
    }
    CHECK(brakings.size() == stops);
    CHECK(first.size() == 7);
}

TEST_CASE("the surface changes about at the speed of the grid, 1.5 s after brake-on", "[STUDY-602]") {
    RobustPlan plan = grid("changes");
    std::erase_if(plan.basis.landings, [](const NominalLanding& landing) {
        return landing.surface != "dry_asphalt" && landing.surface != "wet_cobblestone" && landing.surface != "snow";
    });
    REQUIRE(plan.stops() == std::size_t{3} * 2 * 2 * 3);
    const std::vector<DrawnStop> rows = run(plan, {.threads = 2});
    REQUIRE(rows.size() == plan.stops());
    for (const DrawnStop& row : rows) {
        INFO(describe(plan.basis, draw(plan.basis, row.family, plan.seed, row.number)));
        const double asked_mps = change_at(plan.basis, row.number).speed_mps;
        REQUIRE(row.regrip);
        // Not all of the friction is had before, pressure builds up: at most a third of the 1.5 s is lost.
        CHECK(row.regrip->speed_mps >= asked_mps - 0.5);
        CHECK(row.regrip->speed_mps <= asked_mps + 5.0);
        CHECK(row.regrip->measured());
        CHECK(row.regrip->judged_s <= RegripMeter::kLongest_s + 1e-9);
    }
}

TEST_CASE("a summary of changes counts what its rows say", "[STUDY-602]") {
    const RobustPlan plan = grid("changes");
    std::vector<DrawnStop> rows;
    for (std::size_t i = 0; i < plan.stops(); ++i) {
        DrawnStop row = made_up(Family::changes, i);
        // 0.001 to 0.1 s, but for four: 0.4 and 0.401 s, never, too brief to judge; and one that ended before its change.
        row.regrip = Regrip{.speed_mps = 40.0, .judged_s = 2.0, .regained_s = 1e-3 * static_cast<double>(i % 100 + 1)};
        if (i == 20) row.regrip->regained_s = 0.4;
        if (i == 21) row.regrip->regained_s = 0.401;
        if (i == 22) row.regrip->regained_s.reset();
        if (i == 23) row.regrip->judged_s = 0.4;
        if (i == 24) row.regrip.reset();
        rows.push_back(row);
    }
    const ChangesSummary all = summarise_changes(plan, rows).front();
    CHECK(all.of == "all");
    CHECK(all.changes == 252);
    CHECK(all.measured == 250);
    CHECK(all.in_time == 248);
    CHECK(all.never == 1);
    CHECK(all.median_s == Approx(0.044));  // 3 each up to 0.020 and from 0.026 on, 2 between: the 125th of 250
    CHECK(std::isinf(all.worst_s));
    CHECK(all.worst == 22);
    const auto json = settings::parse_json(settings::json_line(changes_json(plan, rows)));
    CHECK(json["summaries"][0]["worst_s"].is_null());
    CHECK(json["changes"][22]["regained_s"].is_null());
    CHECK(json["changes"][23]["measured"] == false);
    CHECK(json["changes"][24].contains("regained_s") == false);
    CHECK(json["changes"].size() == 252);
    // Of one speed, nothing measured: no figure at all.
    for (DrawnStop& row : rows)
        if (change_at(plan.basis, row.number).speed_mps == 25.0 && row.regrip) row.regrip->judged_s = 0.3;
    CHECK_THAT(changes_table(plan, rows), ContainsSubstring("| slip | at 25 m/s | 0 of 84 | not measured |"));
}

TEST_CASE("brake-on: shares of the held reference and of the fastest landing's travel", "[STUDY-602]") {
    const RobustPlan plan = grid("brake_on", {"slip", "peak_slip", "threshold"});
    std::vector<DrawnStop> rows;
    for (std::size_t law = 0; law < 3; ++law) {
        for (std::size_t i = 0; i < 98; ++i) {
            DrawnStop row = made_up(Family::brake_on, i);
            row.law = law;
            row.figures.j_mu = 0.9;
            row.figures.valve_travel_mAps = brake_on_at(plan.basis, i).speed_mps == 61.0 ? 50.0 : 100.0;
            rows.push_back(row);
        }
    }
    rows[98].figures.valve_travel_mAps = 200.0;  // the peak law, light at 12 m/s
    const std::vector<BrakeOnSummary> all = summarise_brake_on(plan, rows);
    REQUIRE(all.size() == 21);
    for (const BrakeOnSummary& s : all) {
        CHECK(s.stops == 14);
        CHECK(s.mean_j_mu == Approx(0.9));
        CHECK(s.min_share.has_value() == (s.law < 2));
        CHECK(s.max_travel_ratio == Approx(s.speed_mps == 61.0 ? 1.0 : s.law == 1 && s.speed_mps == 12.0 ? 4.0 : 2.0));
    }
    // Held at the peak at 61 m/s nearly everything is offered, less what the fall at low speed takes of the last metres.
    const BrakeOnShare fast = share_of(plan, rows, rows[98 + 6]);
    REQUIRE(brake_on_at(plan.basis, 6).speed_mps == 61.0);
    CHECK(*fast.held_j_mu > 0.97);
    CHECK(*fast.held_j_mu < 1.0);
    CHECK(asked_share(12.0) == 0.87);
    CHECK(asked_share(16.667) == 0.93);
    const auto json = brake_on_json(plan, rows);
    CHECK(json["stops"].size() == 294);
    CHECK(json["stops"][98]["travel_ratio"] == 4.0);
    CHECK(json["stops"][293]["held_j_mu"].is_null());
    CHECK_THAT(brake_on_table(plan, rows), ContainsSubstring("| threshold | 12.0 | 0 | 0.9000 | none is held | | |"));
}
