/// Means against sums by hand, and checks that fail when they should.
#include "plant_sim/study/sweep/summary.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/host/settings/json.hpp"
#include "tests/catch.hpp"
#include "tests/sweep/made_up_sweep.hpp"

namespace {

/// The one check of that name.
const sweep::Check& named(const sweep::Summary& summary, const std::string& name) {
    const auto found = std::find_if(summary.checks.begin(), summary.checks.end(), [&name](const sweep::Check& check) { return check.name == name; });
    REQUIRE(found != summary.checks.end());
    return *found;
}

template <typename Change>
sweep::Summary with(const Change& change) {
    auto table = made_up::table(sweep::paper_references(), 40, made_up::like_the_paper);
    for (sweep::SweptStop& row : table.rows) change(row);
    return sweep::summarised(table.identity, table.rows);
}

/// Fails `name` and nothing else.
void fails_alone(const sweep::Summary& summary, const std::string& name) {
    INFO(name);
    for (const sweep::Check& check : summary.checks) {
        INFO(check.name << ": " << check.measured);
        CHECK(check.passed == (check.name != name));
    }
    CHECK_FALSE(summary.passed());
    CHECK(sweep::to_table(summary).find("FAILED") != std::string::npos);
}

}  // namespace

TEST_CASE("means and standard error over the landings, law by law", "[STUDY-148]") {
    const auto figures = [](double reference, std::size_t landing) {
        study::StopFigures f;
        f.j_mu = (reference > 0.0 ? 0.9 : 0.8) + 0.01 * static_cast<double>(landing);
        f.stop_distance_m = 100.0 + static_cast<double>(landing);
        f.energy_brake_J = landing == 0 ? 4e6 : 1e6;
        f.energy_tyre_J = 1e6;
        f.longest_lock_s = 0.01 * static_cast<double>(landing);
        f.tracked_share = landing == 2 ? 0.94 : 0.96;
        f.tracked_tyre_share = landing == 2 ? 0.7 : 0.25;
        return f;
    };
    const auto table = made_up::table({0.24}, 3, figures);
    const sweep::Summary s = sweep::summarised(table.identity, table.rows);
    REQUIRE(s.references.size() == 1);
    REQUIRE(s.threshold.has_value());
    CHECK(s.references[0].j_mu == Approx(0.91).epsilon(1e-14));
    CHECK(s.references[0].j_mu_error == Approx(0.01 / std::sqrt(3.0)).epsilon(1e-12));
    CHECK(s.references[0].min_j_mu == 0.9);
    CHECK(s.references[0].stop_distance_m == Approx(101.0));
    CHECK(s.references[0].energy_brake_J == Approx(2e6));
    CHECK(s.references[0].tyre_share == Approx(1.0 / 3.0));
    CHECK(s.references[0].longest_lock_s == 0.02);
    CHECK(s.references[0].lock_s == Approx(0.01));
    CHECK(s.references[0].tracked_landings == 2);
    CHECK(s.references[0].tracked_tyre_share == Approx(0.25));
    CHECK(s.threshold->j_mu == Approx(0.81).epsilon(1e-14));
    const auto json = settings::parse_json(sweep::to_json(s));
    for (const char* key : {"study", "version", "config_hash", "seed", "landings", "stops", "checks", "passed"}) CHECK(json.contains(key));
    CHECK(json["references"][0]["j_mu"] == s.references[0].j_mu);
    CHECK(json["threshold"]["j_mu"] == s.threshold->j_mu);
}

TEST_CASE("what the paper shows passes; each thing that is not so fails by its name", "[STUDY-148]") {
    CHECK(with([](sweep::SweptStop&) {}).passed());
    fails_alone(with([](sweep::SweptStop& r) { r.figures.j_mu -= 0.01; }), "j_mu");
    fails_alone(with([](sweep::SweptStop& r) {
                    if (r.stop.slip_reference == 0.22) r.figures.j_mu += 0.003;
                }),
                "near_best");
    fails_alone(with([](sweep::SweptStop& r) {
                    if (r.stop.slip_reference == 0.35) r.figures.j_mu += 0.008;
                }),
                "j_mu_trend");
    fails_alone(with([](sweep::SweptStop& r) {
                    if (r.stop.slip_reference == 0.1) r.figures.stop_distance_m += 50.0;
                }),
                "distance_trend");
    fails_alone(with([](sweep::SweptStop& r) {
                    r.figures.energy_brake_J *= 0.8;
                    r.figures.energy_tyre_J *= 1.25;
                }),
                "brake_above_tyre");
    fails_alone(with([](sweep::SweptStop& r) {
                    if (r.stop.slip_reference == 0.3) r.figures.energy_tyre_J *= 0.96;
                }),
                "energy_monotone");
    fails_alone(with([](sweep::SweptStop& r) {
                    if (r.stop.slip_reference == 0.4) *r.figures.tracked_tyre_share -= 0.02;
                }),
                "tyre_share");
    fails_alone(with([](sweep::SweptStop& r) {
                    if (r.stop.number == 17) r.faults.insert(antiskid::control::Fault::wheel_lost);
                }),
                "all_stop");
    fails_alone(with([](sweep::SweptStop& r) {
                    if (r.stop.threshold) r.figures.standstill = false;
                }),
                "all_stop");
    CHECK_FALSE(named(with([](sweep::SweptStop& r) { r.figures.j_mu = 1.0 - r.figures.j_mu; }), "j_mu_trend").passed);
}

TEST_CASE("what few landings cannot show is said, not passed and not failed", "[STUDY-148]") {
    auto table = made_up::table(sweep::paper_references(), 16, made_up::like_the_paper);
    for (sweep::SweptStop& row : table.rows) row.figures.j_mu -= 0.01;  // would fail with more
    const sweep::Summary few = sweep::summarised(table.identity, table.rows);
    CHECK(few.passed());
    CHECK(few.unchecked.size() == 5);
    CHECK(named(few, "energy_monotone").passed);
    for (sweep::SweptStop& row : table.rows) row.figures.energy_tyre_J = 1e6;  // this is no matter of how many
    CHECK_FALSE(sweep::summarised(table.identity, table.rows).passed());
}

TEST_CASE("what the references of a smaller sweep cannot show is said, not passed", "[STUDY-148]") {
    const auto table = made_up::table({0.2, 0.3}, 4, made_up::like_the_paper, false);
    const sweep::Summary s = sweep::summarised(table.identity, table.rows);
    CHECK(s.passed());
    CHECK(s.unchecked.size() == 5);
    for (const sweep::Check& check : s.checks) CHECK(check.name != "j_mu");
    CHECK(sweep::to_table(s).find("not judged with so few") != std::string::npos);
}
