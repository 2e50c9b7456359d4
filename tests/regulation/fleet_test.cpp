#include "plant_sim/study/regulation/fleet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "plant_sim/study/regulation/fleet_study.hpp"
#include "tests/catch.hpp"

using regulation::Aircraft;
using regulation::AircraftKind;
using regulation::Choice;
using regulation::Choices;
using regulation::Costs;
using regulation::Economy;
using regulation::FleetPolicy;
using regulation::FleetResult;
using regulation::FleetRules;
using regulation::Pair;
using regulation::Shop;
using regulation::Visit;
using regulation::Visits;

namespace {

/// One surface on which the tyre takes as much as the slip, and the stop is shortest at 0.2.
wear::SurfaceTable one_surface() {
    wear::SurfaceTable table{.reference = {0.1, 0.2, 0.3, 0.4}, .rows = {}};
    table.rows.push_back({"dry", {0.9, 0.95, 0.9, 0.9}, {0.1, 0.2, 0.3, 0.4}, {210.0, 200.0, 210.0, 220.0}});
    return table;
}

/// Lives of 400 landings for the brake and 100 for the tyre at share 0.2; the scatter is that of the shipped configuration, or none.
AircraftKind kind_of(bool scatter, wear::arena::Law law = wear::arena::Law::archard) {
    AircraftKind kind{.landing_J = {5e6},
                      .law = law,
                      .brakes = wear::arena::load_settings("config/wear_arena.toml"),
                      .past = {},
                      .tyre_life_J = 100e6,
                      .deviations = {.brake = 0.12, .tyre = 0.10, .inspection = 0.02},
                      .inspection_landings = 32};
    kind.brakes.mix = {{.name = "landing", .share = 1.0, .energy_J = 4e6, .deviation_J = 0.0}};
    kind.brakes.life_landings = 400;
    if (!scatter) {
        kind.deviations = {.brake = 1e-3, .tyre = 0.0, .inspection = 0.0};
        kind.brakes.life_scatter = 0.0;
    }
    kind.past = past_brakes(kind, 100'000, 5);
    return kind;
}

Costs costs_of(const AircraftKind& kind, double visit) {
    return {.brake_per_J = 20000.0 / kind.past.life_J,
            .tyre_per_J = 1500.0 / kind.tyre_life_J,
            .visit = visit,
            .metre = 0.02,
            .planned = {.brake_J = kind.past.life_J, .tyre_J = kind.tyre_life_J}};
}

FleetRules rules_of(int bays, double ground_day) {
    return {.shop = {.bays = bays, .visit_days = 2},
            .landings_a_day = 4,
            .days = 700,
            .ground_day = ground_day,
            .prices = {.brake = 20000.0, .tyre = 1500.0, .visit = 800.0, .metre = 0.02}};
}

std::vector<std::uint64_t> seeds_of(std::size_t count, std::uint64_t first = 500'000) {
    std::vector<std::uint64_t> seeds(count);
    std::iota(seeds.begin(), seeds.end(), first);
    return seeds;
}

const Choices& choices() {
    static const Choices kAll(one_surface(), 0.85, 0.2);
    return kAll;
}

std::vector<FleetPolicy> all_policies() {
    std::vector<FleetPolicy> all;
    for (const bool together : {false, true})
        for (const Visits visits : {Visits::at_limit, Visits::earliest_due, Visits::spread})
            all.push_back(
                {.share = &choices().at(0.2), .together = together, .visits = visits, .margin_days = visits == Visits::at_limit ? 0.0 : 1.0});
    return all;
}

}  // namespace

TEST_CASE("latest starts and turns in the shop are those of a calculation by hand", "[STUDY-171]") {
    const Shop one{.bays = 1, .visit_days = 2};
    // Due on days 5, 6 and 7: the last on 7, the one before it on 5, the first on 3.
    CHECK(one.latest_starts(std::vector{5.0, 6.0, 7.0}) == std::vector{3.0, 5.0, 7.0});
    CHECK(one.latest_starts(std::vector{5.0, 6.0, 9.5}) == std::vector{4.0, 6.0, 9.5});
    CHECK(one.first_come(std::vector{5.0, 6.0, 7.0}, {}) == std::vector{5.0, 7.0, 9.0});
    CHECK(one.first_come(std::vector{-3.0, 0.0}, std::vector{1.0}) == std::vector{1.0, 3.0});
    const Shop two{.bays = 2, .visit_days = 3};
    CHECK(two.latest_starts(std::vector{4.0, 4.0, 5.0, 5.0}) == std::vector{2.0, 2.0, 5.0, 5.0});
    CHECK(two.first_come(std::vector{4.0, 4.0, 5.0, 5.0}, std::vector{1.0}) == std::vector{4.0, 4.0, 7.0, 7.0});
}

TEST_CASE("latest starts keep every due day that any order keeps", "[STUDY-171]") {
    wear::Generator generator = wear::generator_of(3, 1);
    for (int trial = 0; trial < 200; ++trial) {
        const Shop shop{.bays = 1 + trial % 2, .visit_days = 2};
        std::vector<double> due(5);
        for (double& day : due) day = std::floor(wear::uniform(generator) * 12.0);
        // Whether some order of the visits, each as soon as a bay is free from day 0 on, keeps all due days.
        std::vector<double> order = due;
        std::sort(order.begin(), order.end());
        const std::vector<double> sorted = order;
        bool possible = false;
        do {
            const std::vector<double> now(order.size(), 0.0);
            const std::vector<double> begin = shop.first_come(now, {});
            possible = possible || std::equal(begin.begin(), begin.end(), order.begin(), std::less_equal<>());
        } while (std::next_permutation(order.begin(), order.end()));
        const std::vector<double> latest = shop.latest_starts(sorted);
        CAPTURE(trial);
        CHECK((*std::min_element(latest.begin(), latest.end()) >= 0.0) == possible);
    }
}

TEST_CASE("of two aircraft that are due on the same day one waits for as long as the visit of the other takes", "[STUDY-171]") {
    const AircraftKind kind = kind_of(true);
    const Economy economy(choices(), costs_of(kind, 800.0), 5e6);
    const FleetPolicy at_limit{.share = &choices().at(0.2)};
    // The same seed is the same aircraft: both reach each limit on the same day.
    const std::vector<std::uint64_t> twins{500'003, 500'003};
    FleetRules rules = rules_of(2, 1000.0);
    const FleetResult apart = run_fleet(kind, rules, economy, at_limit, twins);
    REQUIRE(apart.visits.size() >= 2);
    const int first = apart.visits.front().begin;
    CHECK(apart.visits[1].begin == first);
    CHECK(apart.waiting_days == 0.0);
    rules.shop.bays = 1;
    rules.days = first + 4;  // both visits, and no further
    const FleetResult one_bay = run_fleet(kind, rules, economy, at_limit, twins);
    REQUIRE(one_bay.visits.size() == 2);
    CHECK(one_bay.visits[0].begin == first);
    CHECK(one_bay.visits[1].grounded == first);
    CHECK(one_bay.visits[1].begin == first + 2);
    CHECK(one_bay.waiting_days == 2.0);
    // Two days in the shop each, two of waiting, and what was left of the day before, twice.
    const double broken = (one_bay.ground_days - 6.0) / 2.0 * 4.0;
    CHECK(broken == Approx(std::round(broken)).margin(1e-9));
    CHECK(broken >= 0.0);
    CHECK(broken <= 3.0);
    CHECK(one_bay.money.ground == Approx(1000.0 * one_bay.ground_days));
    // Booked, one of them goes early enough for the other.
    const FleetResult booked =
        run_fleet(kind, rules, economy, {.share = &choices().at(0.2), .visits = Visits::earliest_due, .margin_days = 2.0}, twins);
    REQUIRE(booked.visits.size() == 2);
    CHECK(booked.visits[0].begin == booked.visits[1].begin - 2);
    CHECK(booked.waiting_days == 0.0);
}

TEST_CASE("with a bay for each aircraft a fleet is its aircraft one by one", "[STUDY-171]") {
    const AircraftKind kind = kind_of(true, wear::arena::Law::step_faults);
    for (const double ground_day : {0.0, 2000.0}) {
        const Economy economy(choices(), costs_of(kind, 800.0 + 2.0 * ground_day), 5e6);
        for (const FleetPolicy& policy : all_policies()) {
            const auto seeds = seeds_of(5);
            const FleetResult fleet = run_fleet(kind, rules_of(5, ground_day), economy, policy, seeds);
            FleetResult sum;
            double money = 0.0;
            for (const std::uint64_t seed : seeds) {
                const FleetResult one = run_fleet(kind, rules_of(1, ground_day), economy, policy, std::vector{seed});
                sum.landings += one.landings;
                sum.visits.insert(sum.visits.end(), one.visits.begin(), one.visits.end());
                sum.ground_days += one.ground_days;
                money += one.money.all();
            }
            CHECK(fleet.landings == sum.landings);
            CHECK(fleet.visits.size() == sum.visits.size());
            CHECK(fleet.ground_days == Approx(sum.ground_days));
            CHECK(fleet.money.all() == Approx(money));
            CHECK(fleet.waiting_days == 0.0);
        }
    }
}

TEST_CASE("one aircraft without scatter costs what its lives say", "[STUDY-171]") {
    AircraftKind kind = kind_of(false);
    const Economy economy(choices(), costs_of(kind, 800.0), 5e6);
    FleetRules rules = rules_of(1, 0.0);
    rules.days = 40'000;
    const FleetResult one = run_fleet(kind, rules, economy, {.share = &choices().at(0.2)}, seeds_of(1));
    const auto landings = static_cast<double>(one.landings);
    // 1 MJ of each landing wears a tyre of 100 MJ; 4 MJ wear the brake. What is thrown away early comes on top.
    CHECK(one.money.tyre / landings >= 15.0);
    CHECK(one.money.tyre / landings < 15.0 * 1.15);
    const double brake = 20000.0 * 4e6 / kind.past.life_J;
    CHECK(one.money.brake / landings > 0.97 * brake);
    CHECK(one.money.brake / landings < 1.05 * brake);
    CHECK(one.money.distance / landings == Approx(0.02 * 200.0));
    const auto brakes = std::count_if(one.visits.begin(), one.visits.end(), [](const Visit& v) { return v.brake; });
    CHECK(static_cast<double>(brakes) == Approx(landings * 4e6 / kind.past.life_J).epsilon(0.05));
}

TEST_CASE("days, landings, visits and money add up under every policy, in a shop that is too small", "[STUDY-171]") {
    const AircraftKind kind = kind_of(true, wear::arena::Law::oxidation);
    const FleetRules rules = rules_of(1, 500.0);
    const Economy economy(choices(), costs_of(kind, 1800.0), 5e6);
    constexpr std::size_t kAircraft = 10;
    for (const FleetPolicy& policy : all_policies()) {
        const FleetResult r = run_fleet(kind, rules, economy, policy, seeds_of(kAircraft));
        // Every day of an aircraft is flown or spent on the ground.
        CHECK(static_cast<double>(r.landings) / rules.landings_a_day + r.ground_days == Approx(1.0 * kAircraft * rules.days));
        double in_shop = 0.0, waited = 0.0;
        std::vector<int> begins;
        begins.reserve(r.visits.size());
        for (const Visit& v : r.visits) {
            CHECK((v.brake || v.tyre));
            CHECK(v.grounded <= v.begin);
            in_shop += std::min(rules.shop.visit_days, rules.days - v.begin);
            waited += v.begin - v.grounded;
            begins.push_back(v.begin);
        }
        CHECK(std::is_sorted(begins.begin(), begins.end()));
        for (std::size_t i = 1; i < begins.size(); ++i) CHECK(begins[i] >= begins[i - 1] + rules.shop.visit_days);  // one bay
        CHECK(r.waiting_days >= waited);                                                                            // some still wait at the end
        CHECK(r.waiting_days < waited + static_cast<double>(kAircraft * 30));
        CHECK(r.ground_days >= in_shop + r.waiting_days);
        CHECK(r.money.visit == Approx(800.0 * static_cast<double>(r.visits.size())));
        CHECK(r.money.ground == Approx(500.0 * r.ground_days));
        CHECK(r.money.distance == Approx(0.02 * r.distance_m));
        CHECK(r.money.all() == Approx(r.money.brake + r.money.tyre + r.money.visit + r.money.ground + r.money.distance));
        // Parts that were bought, but for what was new of them at the beginning or at the end.
        const auto bought = static_cast<double>(std::count_if(r.visits.begin(), r.visits.end(), [](const Visit& v) { return v.brake; }));
        CHECK(std::abs(r.money.brake / 20000.0 - bought) <= 1.0 * kAircraft);
    }
}

TEST_CASE("estimates of what is left come from inspections, within their errors", "[STUDY-171]") {
    const AircraftKind kind = kind_of(true);
    double brake_off = 0.0, tyre_off = 0.0;
    constexpr int kAircraft = 40;
    for (const std::uint64_t seed : seeds_of(kAircraft)) {
        Aircraft aircraft(kind, seed);
        while (!aircraft.tyre_worn_out()) aircraft.land(choices().at(0.2));
        CHECK(aircraft.left().tyre_J == 0.0);
        aircraft.change_tyre();
        for (int i = 0; i < 64; ++i) aircraft.land(choices().at(0.2));
        const Pair left = aircraft.left();
        tyre_off += std::pow(left.tyre_J / kind.tyre_life_J - aircraft.tyre_unworn(), 2) / kAircraft;
        brake_off += std::pow(left.brake_J / kind.past.life_J - aircraft.brake_unworn(), 2) / kAircraft;
    }
    // Two readings of 2 % at a third and two thirds of a tyre's life leave 2.7 % of it unknown; without them 10 % would be.
    CHECK(std::sqrt(tyre_off) < 0.05);
    CHECK(std::sqrt(brake_off) < 0.05);
}

TEST_CASE("shares are chosen as the prices say", "[STUDY-171]") {
    const AircraftKind kind = kind_of(false);
    const Costs costs = costs_of(kind, 4800.0);
    const Economy economy(choices(), costs, 5e6);
    const Choice& fifth = choices().at(0.2);
    CHECK(fifth.mean_share == Approx(0.2).margin(1e-3));
    const Pair equal{.brake_J = 80e6, .tyre_J = 20e6};
    CHECK(economy.landings_left(equal, fifth) == Approx(20.0).epsilon(0.01));
    // Both last equally long: 25 of 100 MJ are the tyre's, 125 of 425 with the next one, 225 of 525 with two.
    CHECK(economy.together({.brake_J = 75e6, .tyre_J = 25e6}, fifth).mean_share == Approx(0.25).margin(1e-3));
    CHECK(economy.together({.brake_J = 300e6, .tyre_J = 25e6}, fifth).mean_share == Approx(125.0 / 425.0).margin(1e-3));
    CHECK(economy.together({.brake_J = 300e6, .tyre_J = 25e6}, choices().at(0.13)).mean_share ==
          Approx(0.1).margin(1e-3));                                                                                        // 25 of 325, out of range
    CHECK(economy.together({.brake_J = 300e6, .tyre_J = 25e6}, choices().at(0.4)).mean_share == Approx(0.4).margin(1e-3));  // 225 of 525
    // A landing of 5 MJ; the tyre shall last for 25 instead of 20: 0.16 of it.
    CHECK(economy.lasting(equal, fifth, 25.0).mean_share == Approx(0.2).margin(1e-3));  // but the brake cannot, and they end together
    CHECK(economy.lasting({.brake_J = 200e6, .tyre_J = 20e6}, fifth, 25.0).mean_share == Approx(0.16).margin(1e-3));
    CHECK(economy.lasting({.brake_J = 80e6, .tyre_J = 60e6}, fifth, 25.0).mean_share == Approx(0.36).margin(1e-3));
    CHECK(&economy.lasting({.brake_J = 200e6, .tyre_J = 60e6}, fifth, 25.0) == &fifth);
    // 20,000 x = 4,800 (1 - x) at x = 0.194 of a brake, 1,500 x = 4,800 (1 - x) at 0.762 of a tyre.
    CHECK(economy.brake_worth_changing(0.19 * kind.past.life_J));
    CHECK_FALSE(economy.brake_worth_changing(0.20 * kind.past.life_J));
    CHECK(economy.tyre_worth_changing(0.76 * kind.tyre_life_J));
    CHECK_FALSE(economy.tyre_worth_changing(0.77 * kind.tyre_life_J));
}

TEST_CASE("the study gives the same on any number of threads, and a saving is a paired difference", "[STUDY-171]") {
    regulation::FleetConfig config = regulation::load_fleet_config("config/fleet.toml");
    config.aircraft = 2;
    config.rules.days = 200;
    config.rules.prices = {.brake = 20000.0, .tyre = 1500.0, .visit = 800.0, .metre = 0.02};
    config.tuning.fleets = config.held_out.fleets = 2;
    const AircraftKind kind = kind_of(true);
    regulation::FleetStudy study{.kind = kind, .choices = choices(), .costs = costs_of(kind, 4800.0), .config = config, .training_seed = 100'000};
    const std::vector<Choice> references{regulation::choice_of(one_surface(), 0.2), regulation::choice_of(one_surface(), 0.3)};
    std::vector<std::size_t> told;
    study.on_fleets = [&](std::size_t fleets) { told.push_back(fleets); };
    const auto entrants = regulation::entrants(study, references);
    const auto one = judge(study, entrants);
    CHECK(told.back() == 12);
    study.threads = 2;
    study.on_fleets = nullptr;
    const auto two = judge(study, entrants);
    REQUIRE(one.size() == entrants.size());
    for (std::size_t p = 0; p < one.size(); ++p) {
        CHECK(one[p].policy.share == two[p].policy.share);
        CHECK(one[p].policy.margin_days == two[p].policy.margin_days);
        REQUIRE(one[p].fleets.size() == 6);
        for (std::size_t f = 0; f < 6; ++f) {
            CHECK(one[p].fleets[f].money.all() == two[p].fleets[f].money.all());
            CHECK(one[p].fleets[f].landings == two[p].fleets[f].landings);
        }
    }
    const regulation::Saving none = saving(one[0], one[0]);
    CHECK(none.per_landing == 0.0);
    CHECK(none.standard_error == 0.0);
    double mean = 0.0;
    for (std::size_t f = 0; f < 6; ++f) mean += (one[0].fleets[f].per_landing() - one[1].fleets[f].per_landing()) / 6.0;
    CHECK(saving(one[1], one[0]).per_landing == Approx(mean));
    const std::atomic<bool> stop{true};
    study.stop = &stop;
    CHECK(judge(study, entrants).empty());
}
