/// Tables of stops: exact, and nothing else is taken for one.
#include "plant_sim/study/sweep/stops_table.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"
#include "tests/sweep/small_plan.hpp"

namespace {

/// Figures that only the shortest exact decimal brings back.
sweep::SweptStop made_up(const sweep::SweepPlan& plan, std::size_t number) {
    sweep::SweptStop row{.stop = plan.stop(number), .figures = {}, .faults = {}};
    row.figures.j_mu = 0.1 + 0.2;
    row.figures.stop_distance_m = 1.0 / 3.0 + static_cast<double>(number);
    row.figures.energy_residual = -1.1e-300;
    row.figures.standstill = number % 2 == 0;
    if (number == 2) row.figures.tracked_share = 2.0 / 3.0;  // the others: not measured
    if (number == 1) {
        row.faults.insert(antiskid::control::Fault::wheel_lost);
        row.faults.insert(antiskid::control::Fault::self_test_failed);
    }
    return row;
}

std::string csv() {
    const sweep::SweepPlan plan = small::plan();
    std::vector<sweep::SweptStop> rows;
    for (std::size_t i = 0; i < 3; ++i) rows.push_back(made_up(plan, i));
    return sweep::to_csv(sweep::identity_of(plan), rows);
}

}  // namespace

TEST_CASE("a table reads back to the last bit", "[STUDY-148]") {
    const sweep::StopsTable table = sweep::parse_stops("t", csv());
    const sweep::SweepPlan plan = small::plan();
    CHECK(table.identity == sweep::identity_of(plan));
    REQUIRE(table.rows.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        const sweep::SweptStop wanted = made_up(plan, i);
        CHECK(table.rows[i].stop == wanted.stop);
        CHECK(table.rows[i].figures.j_mu == wanted.figures.j_mu);
        CHECK(table.rows[i].figures.stop_distance_m == wanted.figures.stop_distance_m);
        CHECK(table.rows[i].figures.energy_residual == wanted.figures.energy_residual);
        CHECK(table.rows[i].figures.tracked_share == wanted.figures.tracked_share);
        CHECK(table.rows[i].figures.standstill == wanted.figures.standstill);
        CHECK(table.rows[i].faults == wanted.faults);
    }
    CHECK(sweep::to_csv(table.identity, table.rows) == csv());
}

TEST_CASE("a line without an end is passed over; anything else that is wrong is named by line and column", "[STUDY-148]") {
    const std::string good = csv();
    const auto cut = sweep::parse_stops("t", good.substr(0, good.size() - 5));
    CHECK(cut.rows.size() == 2);
    CHECK(good.substr(0, cut.whole).back() == '\n');
    const auto rejects = [](const std::string& text, const std::string& says) {
        CHECK_THROWS_WITH(sweep::parse_stops("t.csv", text), ContainsSubstring(says));
    };
    rejects("", "first two lines are not whole");
    rejects("time,speed\n1,2\n", "t.csv:1: this is no table of a sweep's stops");
    rejects(replaced(good, "# antiskid sweep 1", "# antiskid sweep 2"), "t.csv:1: this is no table");
    rejects(replaced(good, "\"seed\":1,", ""), "t.csv:1: damaged first line");
    rejects(replaced(good, "\"landings\":4", "\"landings\":0"), "t.csv:1: references");
    rejects(replaced(good, "energy_brake_J", "energy_brake_MJ"), "t.csv:2: other columns");
    rejects(replaced(good, "\n0,slip", "\n0,glide"), "t.csv:3: law: 'glide': expected threshold or slip");
    rejects(replaced(good, "\n0,slip", "\nzero,slip"), "t.csv:3: stop: 'zero': expected a number");
    rejects(replaced(good, "0.30000000000000004", "nan"), "t.csv:3: j_mu: 'nan': expected a number");
    rejects(replaced(good, "wheel_lost", "wheel_stolen"), "t.csv:4: faults");
    rejects(replaced(good, "\n1,slip", "\n0,slip"), "t.csv:4: stop: 0 stands in the table twice");
    rejects(replaced(good, "\n1,slip", "\n99,slip"), "t.csv:4: stop: 99 stands in the table twice, or is not");
    rejects(replaced(good, "\n1,slip,0.1", "\n1,slip,0.2"), "t.csv:4: stop: 1 has another law, reference or landing");
    rejects(good + "3,slip,0.1\n", "t.csv:6: landing: the line ends before it");
    rejects(replaced(good, "\n1,slip", ",7\n1,slip"), "t.csv:3: the line has more fields");
}
