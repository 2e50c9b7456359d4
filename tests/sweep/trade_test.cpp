/// The cheapest reference against closed forms.
#include "plant_sim/study/sweep/trade.hpp"

#include <cmath>

#include "firmware/host/settings/json.hpp"
#include "rig_bridge/wear/draw.hpp"
#include "tests/catch.hpp"
#include "tests/sweep/made_up_sweep.hpp"

using sweep::BindingLimit;
using sweep::Lives;
using sweep::Prices;
using sweep::Trade;

namespace {

sweep::StopsTable paper() {
    return made_up::table(sweep::paper_references(), 12, made_up::like_the_paper);
}

Trade trade(const sweep::StopsTable& table, const sweep::Tariff& tariff, const sweep::Bounds& bounds = {}) {
    return sweep::traded(table, {.tariff = tariff, .bounds = bounds, .resamples = 400, .seed = 3});
}

constexpr double kMean_MJ = 6.0;  // of 4 MJ times 1, 1.5 and 2

}  // namespace

TEST_CASE("a floor on J_mu: the dear part is spared up to where the floor is", "[STUDY-148]") {
    constexpr double kFloor = 0.95;
    const Trade dear_brake = trade(paper(), Prices{3.0, 1.0}, {.min_j_mu = kFloor});
    REQUIRE(dear_brake.best.has_value());
    const double up = 0.22 + std::sqrt((0.966 - kFloor) / 1.5);
    CHECK(dear_brake.best->slip_reference == Approx(up).margin(1.01 * Trade::kStep));
    CHECK(dear_brake.best->slip_reference <= up + 1e-9);
    CHECK(dear_brake.decides == BindingLimit::min_j_mu);
    CHECK(dear_brake.best->cost == Approx(kMean_MJ * (3.0 - 2.0 * dear_brake.best->slip_reference)).epsilon(1e-9));

    const Trade dear_tyre = trade(paper(), Prices{1.0, 3.0}, {.min_j_mu = kFloor});
    REQUIRE(dear_tyre.best.has_value());
    CHECK(dear_tyre.best->slip_reference == Approx(0.22 - std::sqrt((0.966 - kFloor) / 7.0)).margin(1.5 * Trade::kStep));
    // Against 0.24 and the threshold law's 0.16: cost is 6 (1 + 2 slip).
    REQUIRE(dear_tyre.against_paper.has_value());
    CHECK(dear_tyre.against_paper->share == Approx(1.0 - (1.0 + 2.0 * dear_tyre.best->slip_reference) / 1.48).epsilon(1e-9));
    REQUIRE(dear_tyre.against_threshold.has_value());
    CHECK(dear_tyre.against_threshold->share == Approx(1.0 - (1.0 + 2.0 * dear_tyre.best->slip_reference) / 1.32).epsilon(1e-9));
}

TEST_CASE("a ceiling on distance is the same floor by another name", "[STUDY-148]") {
    const Trade by_distance = trade(paper(), Prices{3.0, 1.0}, {.max_distance_m = 480.0 / 0.95});
    const Trade by_j_mu = trade(paper(), Prices{3.0, 1.0}, {.min_j_mu = 0.95});
    REQUIRE(by_distance.best.has_value());
    CHECK(by_distance.best->slip_reference == Approx(by_j_mu.best->slip_reference).margin(1.01 * Trade::kStep));
    CHECK(by_distance.decides == BindingLimit::max_distance);
}

TEST_CASE("lives: brake and tyre are worn out together where that can be", "[STUDY-148]") {
    // E_b / L_b = E_t / L_t at slip = L_t / (L_b + L_t).
    const Trade together = trade(paper(), Lives{700.0, 300.0});
    REQUIRE(together.best.has_value());
    CHECK(together.best->slip_reference == Approx(0.3).margin(1e-9));
    CHECK(together.decides == BindingLimit::nothing);
    CHECK(1.0 / together.best->cost == Approx(1000.0 / kMean_MJ).epsilon(1e-9));
    // The landings differ in size, not in ratio, and are the same for every reference: no doubt about the reference.
    CHECK(together.best_interval.low == Approx(0.3).margin(1e-9));
    CHECK(together.best_interval.high == Approx(0.3).margin(1e-9));
    CHECK(together.against_paper->interval.high - together.against_paper->interval.low < 1e-9);

    const Trade tyre_outlasts = trade(paper(), Lives{100.0, 900.0});
    CHECK(tyre_outlasts.best->slip_reference == 0.5);
    CHECK(tyre_outlasts.decides == BindingLimit::end_of_references);
}

TEST_CASE("no reference within the bounds, nothing that costs, all on one side: plain answers", "[STUDY-148]") {
    const sweep::TradeOptions options{.tariff = Prices{1.0, 2.0}, .bounds = {.min_j_mu = 0.97}, .resamples = 50};
    const Trade none = sweep::traded(paper(), options);
    CHECK_FALSE(none.best.has_value());
    CHECK(none.feasible_share == 0.0);
    CHECK(none.greatest_j_mu.slip_reference == Approx(0.22));
    const std::string text = sweep::to_text(none, options);
    CHECK(text.find("No fixed slip reference is within them: mean J_mu is at most 0.9660 (at 0.220)") != std::string::npos);
    const auto json = settings::parse_json(sweep::to_json(none, paper(), options));
    CHECK(json["feasible"] == false);
    CHECK_FALSE(json.contains("best"));

    const Trade free = trade(paper(), Prices{0.0, 0.0});
    CHECK(free.best->slip_reference == Approx(0.22));
    CHECK(free.decides == BindingLimit::no_cost);
    CHECK(free.against_paper->share == 0.0);

    const Trade free_brake = trade(paper(), Prices{0.0, 1.0});
    CHECK(free_brake.best->slip_reference == 0.06);
    CHECK(free_brake.decides == BindingLimit::end_of_references);
    const Trade free_tyre = trade(paper(), Prices{1.0, 0.0});
    CHECK(free_tyre.best->slip_reference == 0.5);
    CHECK(free_tyre.decides == BindingLimit::end_of_references);

    // Brake and tyre together take the same energy at every reference: with one price all cost the same, and J_mu decides.
    const Trade same = trade(paper(), Prices{2.0, 2.0});
    CHECK(same.best->slip_reference == Approx(0.22));
}

TEST_CASE("the interval is that of the scatter: 1.96 standard errors over the slope", "[STUDY-148]") {
    // J_mu = 1 - slip / 2 plus a part of the landing's own, the same for every reference; with the floor 0.85 and a dear brake the
    // best reference is 2 (mean - 0.85).
    constexpr std::size_t kLandings = 200;
    constexpr double kDeviation = 0.06;
    std::vector<double> own(kLandings);
    wear::Generator generator = wear::generator_of(5, 0);
    for (double& value : own) value = kDeviation * wear::normal(generator);
    const auto figures = [&own](double reference, std::size_t landing) {
        study::StopFigures f;
        f.j_mu = 1.0 - 0.5 * reference + own[landing];
        f.stop_distance_m = 500.0;
        f.energy_brake_J = 4e6 * (1.0 - reference);
        f.energy_tyre_J = 4e6 * reference;
        return f;
    };
    const auto table = made_up::table(sweep::paper_references(), kLandings, figures, false);
    const Trade t = sweep::traded(table, {.tariff = Prices{1.0, 0.0}, .bounds = {.min_j_mu = 0.85}, .resamples = 2000, .seed = 1});
    double mean = 0.0;
    double squares = 0.0;
    for (const double value : own) mean += value / kLandings;
    for (const double value : own) squares += (value - mean) * (value - mean);
    const double error = std::sqrt(squares / kLandings / kLandings);
    REQUIRE(t.best.has_value());
    CHECK(t.best->slip_reference == Approx(2.0 * (0.15 + mean)).margin(1.01 * Trade::kStep));
    CHECK(t.best_interval.high - t.best_interval.low == Approx(2.0 * 1.96 * error / 0.5).epsilon(0.1));
    CHECK_FALSE(t.threshold.has_value());
}

TEST_CASE("the same seed gives the same answer, to the byte", "[STUDY-148]") {
    const sweep::TradeOptions options{.tariff = Prices{1.0, 2.0}, .bounds = {.min_j_mu = 0.95}, .resamples = 100};
    CHECK(sweep::to_json(sweep::traded(paper(), options), paper(), options) == sweep::to_json(sweep::traded(paper(), options), paper(), options));
}

TEST_CASE("tariffs, bounds and sweeps that cannot be are refused", "[STUDY-148]") {
    CHECK_THROWS_WITH(trade(paper(), Prices{-1.0, 1.0}), ContainsSubstring("not negative"));
    CHECK_THROWS_WITH(trade(paper(), Prices{NAN, 1.0}), ContainsSubstring("finite"));
    CHECK_THROWS_WITH(trade(paper(), Lives{0.0, 1.0}), ContainsSubstring("above 0"));
    auto table = paper();
    table.rows.pop_back();
    CHECK_THROWS_WITH(trade(table, Prices{1.0, 1.0}), ContainsSubstring("made up has 551 of 552 stops"));
    const auto one = made_up::table({0.24}, 3, made_up::like_the_paper);
    CHECK_THROWS_WITH(trade(one, Prices{1.0, 1.0}), ContainsSubstring("at least two slip references"));
}
