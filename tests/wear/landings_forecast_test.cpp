#include "rig_bridge/wear/landings_forecast.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "plant_sim/wear/rival_laws.hpp"
#include "rig_bridge/wear/learn_population.hpp"
#include "tests/catch.hpp"

namespace {

using wear::arena::Law;

const wear::arena::Settings& lives_of() {
    static const wear::arena::Settings s = wear::arena::load_settings("config/wear_arena.toml");
    return s;
}

const wear::Population& learnt_of_oxidation() {
    static const wear::Population p = [] {
        std::vector<wear::Campaign> lives;
        for (std::uint64_t k = 0; k < 6; ++k) lives.push_back(wear::arena::live(Law::oxidation, lives_of(), lives_of().training + k).campaign);
        wear::LearnSettings learn;
        learn.fit.max_components = 4;
        learn.fit.starts = 3;
        learn.limit = lives_of().limit;
        return wear::learn_population(lives, learn);
    }();
    return p;
}

/// Mean probability, over five brakes at half of their life, that the brake is of the population's kind.
double population_probability(Law law) {
    double sum = 0.0;
    for (std::uint64_t k = 0; k < 5; ++k) {
        const wear::arena::Life life = wear::arena::live(law, lives_of(), lives_of().tuning + k);
        wear::LandingsForecast brake(learnt_of_oxidation());
        for (std::size_t i = 0; i < life.landings() / 2; ++i) brake.learn(life.campaign.points[i]);
        sum += brake.population_probability() / 5.0;
    }
    return sum;
}

std::vector<double> ramp(double begin, double step) {
    std::vector<double> out(100);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = begin + step * static_cast<double>(i);
    return out;
}

}  // namespace

TEST_CASE("past lives are Student's t of the logarithm, of brakes that are not worn out yet", "[WEAR-072]") {
    wear::Population p = learnt_of_oxidation();
    const wear::PastLives past(p, lives_of().limit);
    REQUIRE(past.known());
    std::vector<double> logs;
    for (const wear::MeanCurve& c : p.members) logs.push_back(std::log(wear::crossing_J(c, lives_of().limit, c.last_J() / 500.0, 1.1 * c.last_J())));
    const double n = static_cast<double>(logs.size());
    const double mean = std::accumulate(logs.begin(), logs.end(), 0.0) / n;
    double squares = 0.0;
    for (const double x : logs) squares += (x - mean) * (x - mean);
    CHECK(std::log(past.life_J(0.0, 0.5)) == Approx(mean).margin(1e-9));
    // Student's t with 5 degrees of freedom: 90 % are below 1.4759.
    CHECK(std::log(past.life_J(0.0, 0.9)) == Approx(mean + 1.4759 * std::sqrt(squares / (n - 1.0) * (1.0 + 1.0 / n))).margin(1e-4));
    const double late_J = past.life_J(0.0, 0.9);
    CHECK(past.life_J(late_J, 0.5) == Approx(past.life_J(0.0, 0.95)).epsilon(1e-9));
    CHECK(past.life_J(1e12, 0.1) >= 1e12);
    CHECK_FALSE(wear::PastLives(p, 0.05).known());                                   // no brake got there
    CHECK(wear::PastLives(p, 0.9).life_J(0.0, 0.9) < 0.01 * past.life_J(0.0, 0.5));  // all began below
    p.members.resize(1, p.members.front());
    CHECK_FALSE(wear::PastLives(p, lives_of().limit).known());
}

TEST_CASE("a brake of another kind is known by how it goes, and is given past lives", "[WEAR-072]") {
    CHECK(population_probability(Law::oxidation) > 0.8);
    CHECK(population_probability(Law::ostermeyer) < 0.2);
    const wear::arena::Life life = wear::arena::live(Law::ostermeyer, lives_of(), lives_of().tuning);
    wear::LandingsForecast brake(learnt_of_oxidation());
    for (std::size_t i = 0; i < life.landings() / 2; ++i) brake.learn(life.campaign.points[i]);
    wear::ForecastSettings ask;
    ask.limit = lives_of().limit;
    ask.draws = 200;
    ask.horizon = 2000;
    const wear::Forecast f = brake.forecast(lives_of().mix, ask);
    const double c_e_J = life.campaign.points[life.landings() / 2 - 1].c_e_J;
    const wear::PastLives past(learnt_of_oxidation(), ask.limit);
    const double left = (past.life_J(c_e_J, 0.5) - c_e_J) / lives_of().mean_energy_J();
    CHECK(f.landings_left[1].value() == Approx(left).epsilon(0.25));
    CHECK(f.population_probability == brake.population_probability());
    CHECK(std::is_sorted(f.landings.begin(), f.landings.end()));
    CHECK(brake.forecast(lives_of().mix, ask).landings == f.landings);
}

TEST_CASE("a brake whose friction is below the limit has no landing left, of whatever kind it is", "[WEAR-072]") {
    for (const Law law : {Law::oxidation, Law::ostermeyer}) {
        CAPTURE(law);
        const wear::arena::Life life = wear::arena::live(law, lives_of(), lives_of().tuning);
        wear::LandingsForecast brake(learnt_of_oxidation());
        for (const wear::Point& point : life.campaign.points) brake.learn(point);
        double c_e_J = life.campaign.points.back().c_e_J;
        for (int i = 0; i < 40; ++i) brake.learn({c_e_J += lives_of().mean_energy_J(), 0.9 * lives_of().limit});
        wear::ForecastSettings ask;
        ask.limit = lives_of().limit;
        ask.draws = 200;
        const wear::Forecast f = brake.forecast(lives_of().mix, ask);
        CHECK(f.crossed_now > 0.95);
        CHECK(f.landings[100] == 0.0);
    }
}

TEST_CASE("a campaign's readings are taken between its maneuvers, and narrow the landings left of either kind of brake", "[WEAR-074]") {
    REQUIRE(learnt_of_oxidation().curves.lining.lives == 6);
    for (const Law law : {Law::oxidation, Law::archard}) {
        CAPTURE(law);
        wear::arena::Life life = wear::arena::live(law, lives_of(), lives_of().tuning);
        wear::Campaign& so_far = life.campaign;
        so_far.points.resize(life.landings() * 7 / 10);
        std::erase_if(so_far.readings, [&](const wear::LiningReading& r) { return r.c_e_J > so_far.points.back().c_e_J; });
        wear::LandingsForecast at_once(learnt_of_oxidation()), one_by_one(learnt_of_oxidation()), by_friction(learnt_of_oxidation());
        at_once.learn(so_far);
        std::size_t read = 0;
        for (const wear::Point& point : so_far.points) {
            one_by_one.learn(point);
            by_friction.learn(point);
            if (read < so_far.readings.size() && so_far.readings[read].c_e_J == point.c_e_J) one_by_one.read(so_far.readings[read++]);
        }
        CHECK(read == so_far.readings.size());
        wear::ForecastSettings ask;
        ask.limit = lives_of().limit;
        ask.draws = 200;
        const auto width = [&](const wear::LandingsForecast& brake) {
            const wear::Forecast f = brake.forecast(lives_of().mix, ask);
            return f.landings[180] - f.landings[20];
        };
        CHECK(at_once.forecast(lives_of().mix, ask).landings == one_by_one.forecast(lives_of().mix, ask).landings);
        CHECK(width(at_once) < 0.9 * width(by_friction));
    }
}

TEST_CASE("two distributions become their mixture", "[WEAR-072]") {
    const std::vector<double> life = ramp(100.0, 1.0), past = ramp(50.0, 4.0);
    CHECK(wear::pooled(life, past, 1.0) == life);
    CHECK(wear::pooled(life, past, 0.0) == past);
    // Of 0 to 99 and 1000 to 1099, a quarter the first: 25 values below 100, 75 above 1000.
    const std::vector<double> apart = wear::pooled(ramp(0.0, 1.0), ramp(1000.0, 1.0), 0.25);
    CHECK(std::count_if(apart.begin(), apart.end(), [](double x) { return x < 100.0; }) == 25);
    CHECK(std::is_sorted(apart.begin(), apart.end()));
}

TEST_CASE("the score of draws is that of their distribution function", "[WEAR-072]") {
    CHECK(wear::crps({3.0}, 5.0) == 2.0);
    // Two values, 0 and 2, truth 1: the integral of (F - step)^2 is 1/4 on either side.
    CHECK(wear::crps({0.0, 2.0}, 1.0) == Approx(0.5));
}
