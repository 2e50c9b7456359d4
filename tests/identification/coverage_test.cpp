/// How often the truth of the virtual rig lies in the 95 % intervals. A few seeds everywhere; 50 without sanitizers, as identification_fifty.
#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "plant_sim/study/identification/identified.hpp"
#include "rig_bridge/rig/random.hpp"
#include "tests/catch.hpp"
#include "tests/identification/experiments.hpp"

using identification::Estimate;
using identification::Run;

namespace {

struct Hits {
    int hits = 0, all = 0;
    double sum = 0.0;  // of errors over deviations
};
using Coverage = std::map<std::string, Hits>;

/// Every experiment with noise of its own.
std::vector<Run> runs(std::uint64_t seed) {
    std::vector<Run> all;
    for (const char* name : {"ramp", "step", "sweep", "slow_braking", "heavy"}) {
        const endurance::EnduranceSetup s = identification_test::setup(name);
        all.push_back({.recording = identification_test::record(s, 10 * seed + all.size()),
                       .rig = identification_test::known(s),
                       .surface = s.scenario.choice.surface,
                       .friction_class = s.scenario.choice.maneuver});
    }
    return all;
}

/// Landings with such a brake.
std::vector<Run> stops(const rig::Clamping& clamping, std::uint64_t seed) {
    std::vector<Run> all;
    for (const char* name : {"slow_braking", "heavy"}) {
        endurance::EnduranceSetup s = identification_test::setup(name);
        s.scenario.rig.rig.clamping = clamping;
        all.push_back({.recording = identification_test::record(s, 10 * seed + all.size()),
                       .rig = identification_test::known(s),
                       .surface = s.scenario.choice.surface,
                       .friction_class = s.scenario.choice.maneuver});
    }
    return all;
}

void count(Coverage& coverage, const std::string& name, const Estimate& e, double truth) {
    Hits& h = coverage[name];
    h.hits += e.contains(truth) ? 1 : 0;
    h.sum += (e.value - truth) / e.deviation;
    ++h.all;
}

void add_seed(Coverage& coverage, std::uint64_t seed) {
    const std::vector<Run> all = runs(seed);
    std::vector<identification::Recording> recordings;
    recordings.reserve(all.size());
    for (const Run& run : all) recordings.push_back(run.recording);
    const rig::RigParameters truth = identification_test::setup("heavy").scenario.rig.rig;

    const auto valve = identification::fit_valve(recordings, all.front().rig);
    count(coverage, "dead zone", valve.dead_zone_mA, truth.pressure_map.points()[0].current_mA);
    for (std::size_t i = 0; i < valve.pressure_Pa.size(); ++i)
        count(coverage, "map " + std::to_string(i + 1), valve.pressure_Pa[i], truth.pressure_map.points()[i + 1].pressure_Pa);
    count(coverage, "hysteresis", valve.hysteresis_mA, 0.0);
    count(coverage, "omega_n", valve.natural_frequency_Hz, 20.0);
    count(coverage, "xi", valve.damping, truth.valve.damping);
    count(coverage, "tau", valve.delay_s, truth.valve.delay_s);

    const auto wheel = identification::fit_wheel(all, "heavy");
    count(coverage, "J_w", wheel.inertia_kgm2, truth.wheel.inertia_kgm2);
    CHECK_FALSE(wheel.contact_Pa.has_value());
    CHECK_FALSE(wheel.piston_friction.has_value());
    count(coverage, "k_b", wheel.gain_m3, truth.mean_friction * truth.brake.gain_m3());

    const auto road = identification::fit_friction(all, "dry_asphalt");
    count(coverage, "c1", road.of("c1"), truth.surface.c1);
    count(coverage, "c2", road.of("c2"), truth.surface.c2);
    count(coverage, "c3", road.of("c3"), truth.surface.c3);
    // And they say something.
    CHECK(wheel.inertia_kgm2.deviation < 0.003 * truth.wheel.inertia_kgm2);
    CHECK(wheel.friction.deviation < 0.001 * truth.mean_friction);
    CHECK(road.of("c1").deviation < 0.01);
    CHECK(road.of("c2").deviation < 0.2);
    CHECK(road.of("c3").deviation < 0.03);
}

}  // namespace

TEST_CASE("the truth lies in the intervals, for valve, wheel, brake and road", "[STUDY-100]") {
    Coverage coverage;
    constexpr int kSeeds = 4;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) add_seed(coverage, seed);
    int hits = 0;
    int all = 0;
    for (const auto& [name, h] : coverage) {
        CAPTURE(name, h.hits, h.sum);
        CHECK(h.hits >= kSeeds / 2);
        CHECK(std::abs(h.sum) < 2.2 * kSeeds);
        hits += h.hits;
        all += h.all;
    }
    CHECK(hits >= 0.9 * all);
}

TEST_CASE("the truth lies in the interval of each parameter for 45 of 50 seeds or more, of k_b for 40", "[.fifty][STUDY-100]") {
    Coverage coverage;
    for (std::uint64_t seed = 1; seed <= 50; ++seed) add_seed(coverage, seed);
    for (const auto& [name, h] : coverage) {
        std::printf("%-12s %d of %d, mean error %+.2f deviations\n", name.c_str(), h.hits, h.all, h.sum / h.all);
        CAPTURE(name);
        // Found within 0.003 %, k_b scatters by 1.3 times its deviation. Why is not known; docs/engineering/identification.md.
        CHECK(h.hits >= (name == "k_b" ? 40 : 45));
    }
}

TEST_CASE("a magic formula's curve is found within 1 % of its peak, far beyond the slip that was held, for 50 seeds", "[.fifty][STUDY-100]") {
    Coverage coverage;
    double worst = 0.0;
    // None of them is a road of road_test.cpp, on which the fit's starts were chosen.
    const std::array<rig::MagicFormula, 5> roads{
        rig::magic_formula_with_peak(0.06, 0.9, 1.5, 0.2), rig::magic_formula_with_peak(0.10, 0.6, 1.7, -0.3),
        rig::magic_formula_with_peak(0.15, 0.8, 1.45, 0.5), rig::magic_formula_with_peak(0.20, 1.1, 1.6, -1.0),
        rig::magic_formula_with_peak(0.08, 0.4, 1.8, 0.7)};
    for (std::uint64_t seed = 51; seed <= 100; ++seed) {
        const rig::MagicFormula& road = roads.at(seed % roads.size());
        std::vector<Run> all;
        for (const char* name : {"slow_braking", "heavy"}) {
            endurance::EnduranceSetup s = identification_test::setup(name);
            s.scenario.rig.rig.surface.magic = road;
            all.push_back({.recording = identification_test::record(s, 10 * seed + all.size()),
                           .rig = identification_test::known(s),
                           .surface = s.scenario.choice.surface,
                           .friction_class = s.scenario.choice.maneuver});
        }
        const auto found = identification::fit_friction(all, "dry_asphalt");
        for (double slip = 0.005; slip < 0.5; slip += 0.005)
            worst = std::max(worst, std::abs(rig::friction(found.curve, slip).mu - rig::friction(road, slip).mu) / road.D);
        count(coverage, "B", found.of("B"), road.B);
        count(coverage, "C", found.of("C"), road.C);
        count(coverage, "D", found.of("D"), road.D);
        count(coverage, "E", found.of("E"), road.E);
    }
    // Their intervals are too narrow; docs/engineering/identification.md.
    for (const auto& [name, h] : coverage) std::printf("%-12s %d of %d, mean error %+.2f deviations\n", name.c_str(), h.hits, h.all, h.sum / h.all);
    std::printf("largest error of the curve up to slip 0.5: %.4f of its peak\n", worst);
    CHECK(worst < 0.01);
}

TEST_CASE("what springs and pistons take off the pressure is found with the brake's friction", "[STUDY-100]") {
    const rig::Clamping truth = GENERATE(rig::Clamping{.contact_Pa = 0.2e6}, rig::Clamping{.contact_Pa = 1.5e6},
                                         rig::Clamping{.piston_friction = 0.02}, rig::Clamping{.contact_Pa = 0.8e6, .piston_friction = 0.05});
    const auto wheel = identification::fit_wheel(stops(truth, 7), "heavy");
    CAPTURE(truth.contact_Pa, truth.piston_friction, wheel.friction.value, wheel.inertia_kgm2.value, wheel.misfit);
    const double contact_Pa = wheel.contact_Pa.value_or(Estimate{}).value, piston_friction = wheel.piston_friction.value_or(Estimate{}).value;
    CHECK(contact_Pa == Approx(truth.contact_Pa).margin(0.03e6));
    CHECK(piston_friction == Approx(truth.piston_friction).margin(0.004));
    CHECK(wheel.contact_Pa.has_value() == (truth.contact_Pa > 0.0));
    CHECK(wheel.piston_friction.has_value() == (truth.piston_friction > 0.0));
    const rig::RigParameters rig = identification_test::setup("heavy").scenario.rig.rig;
    CHECK(wheel.friction.value == Approx(rig.mean_friction).epsilon(0.003));
    CHECK(wheel.inertia_kgm2.value == Approx(rig.wheel.inertia_kgm2).epsilon(0.005));
    CHECK(wheel.misfit < identification::kMaxMisfit);
}

TEST_CASE("one landing alone shows the contact pressure, too", "[STUDY-100]") {
    // Its pressure goes from 0 to that of the landing, and follows friction over speed after that.
    const std::vector<Run> all = stops({.contact_Pa = 1e6}, 9);
    for (const Run& one : all) {
        const auto wheel = identification::fit_wheel({&one, 1}, "heavy");
        CAPTURE(one.recording.name, wheel.friction.value, wheel.friction.deviation, wheel.misfit);
        REQUIRE(wheel.contact_Pa);
        CHECK(wheel.contact_Pa->value == Approx(1e6).margin(0.05e6));
        CHECK(wheel.friction.value == Approx(0.30).epsilon(0.01));
    }
}

TEST_CASE("of discs that are not true the program reports that pressure does not explain their torque", "[STUDY-100]") {
    identification::Identified found;
    found.wheel = identification::fit_wheel(stops({.run_out = 0.05}, 8), "heavy");
    CHECK(found.wheel->misfit > identification::kMaxMisfit);
    CHECK_THAT(identification::to_table(found), ContainsSubstring("warning: brake: the wheel's balance is off"));
}

TEST_CASE("friction is found within 1 %, whatever springs and pistons take off the pressure, for 20 brakes", "[.fifty][STUDY-100]") {
    Coverage coverage;
    rig::Random random(2026);
    double friction = 0.0, contact_Pa = 0.0, piston = 0.0, misfit = 0.0;
    const rig::RigParameters rig = identification_test::setup("heavy").scenario.rig.rig;
    for (std::uint64_t seed = 101; seed <= 120; ++seed) {
        const rig::Clamping truth{.contact_Pa = 1.5e6 * random.uniform(), .piston_friction = 0.06 * random.uniform()};
        const auto wheel = identification::fit_wheel(stops(truth, seed), "heavy");
        friction = std::max(friction, std::abs(wheel.friction.value / rig.mean_friction - 1.0));
        contact_Pa = std::max(contact_Pa, std::abs(wheel.contact_Pa.value_or(Estimate{}).value - truth.contact_Pa));
        piston = std::max(piston, std::abs(wheel.piston_friction.value_or(Estimate{}).value - truth.piston_friction));
        misfit = std::max(misfit, wheel.misfit);
        count(coverage, "J_w", wheel.inertia_kgm2, rig.wheel.inertia_kgm2);
        count(coverage, "k_b", wheel.gain_m3, rig.mean_friction * rig.brake.gain_m3());
        if (wheel.contact_Pa) count(coverage, "contact", *wheel.contact_Pa, truth.contact_Pa);
        if (wheel.piston_friction) count(coverage, "pistons", *wheel.piston_friction, truth.piston_friction);
    }
    for (const auto& [name, h] : coverage) std::printf("%-12s %d of %d, mean error %+.2f deviations\n", name.c_str(), h.hits, h.all, h.sum / h.all);
    std::printf("largest error: friction %.4f of it, contact pressure %.0f Pa, piston friction %.4f; misfit up to %.2f\n", friction, contact_Pa,
                piston, misfit);
    CHECK(friction < 0.01);
}

TEST_CASE("intervals count correlated residuals", "[STUDY-100]") {
    // A straight line under first-order autoregressive noise: an interval that took residuals for independent would be less than half as wide.
    constexpr int kTrials = 400;
    constexpr Eigen::Index kRows = 400;
    constexpr double kCorrelation = 0.7;
    const double slope = 0.02;
    rig::Random random(5);
    const std::vector<std::string> names{"offset", "slope"};
    int hits = 0;
    double deviation = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {
        Eigen::VectorXd y(kRows);
        double noise = random.noise() / std::sqrt(1.0 - kCorrelation * kCorrelation);
        for (Eigen::Index i = 0; i < kRows; ++i) {
            y[i] = 3.0 + slope * static_cast<double>(i) + noise;
            noise = kCorrelation * noise + random.noise();
        }
        identification::LeastSquares problem;
        problem.start = Eigen::Vector2d::Zero();
        problem.scale = Eigen::Vector2d(1.0, 0.01);
        problem.min = Eigen::Vector2d::Constant(-100.0);
        problem.max = Eigen::Vector2d::Constant(100.0);
        const auto fit = identification::fit(problem, names, [&y](const Eigen::VectorXd& theta, Eigen::VectorXd& r) {
            r.resize(kRows);
            for (Eigen::Index i = 0; i < kRows; ++i) r[i] = y[i] - theta[0] - theta[1] * static_cast<double>(i);
        });
        hits += fit.estimate(1).contains(slope) ? 1 : 0;
        deviation += fit.estimate(1).deviation / kTrials;
    }
    CHECK(hits >= 0.90 * kTrials);
    CHECK(hits <= 0.99 * kTrials);
    // The closed form for long records: white noise's deviation times 1 / (1 - correlation).
    const double white = std::sqrt(12.0 / (static_cast<double>(kRows) * kRows * kRows));
    CHECK(deviation == Approx(white / (1.0 - kCorrelation)).epsilon(0.2));
}

TEST_CASE("where few readings decide, intervals of whitened residuals hold", "[STUDY-100]") {
    // A step that the last 25 of 1,000 readings show, under white noise of a size that is found from all of them. Scores by themselves see 25.
    constexpr int kTrials = 1000;
    constexpr Eigen::Index kRows = 1000;
    constexpr Eigen::Index kLast = 25;
    rig::Random random(7);
    const std::vector<std::string> names{"step"};
    int hits = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        Eigen::VectorXd y(kRows);
        for (Eigen::Index i = 0; i < kRows; ++i) y[i] = (i < kRows - kLast ? 0.0 : 2.0) + random.noise();
        identification::LeastSquares problem;
        problem.start = Eigen::VectorXd::Zero(1);
        problem.scale = Eigen::VectorXd::Ones(1);
        problem.min = Eigen::VectorXd::Constant(1, -100.0);
        problem.max = Eigen::VectorXd::Constant(1, 100.0);
        problem.whitened = true;
        const auto fit = identification::fit(problem, names, [&y](const Eigen::VectorXd& theta, Eigen::VectorXd& r) {
            r = y;
            r.tail(kLast).array() -= theta[0];
        });
        hits += fit.estimate(0).contains(2.0) ? 1 : 0;
    }
    // 95 % with a standard deviation of 0.7 %; scores by themselves give 85 %.
    CHECK(hits >= 0.93 * kTrials);
    CHECK(hits <= 0.97 * kTrials);
}

TEST_CASE("what a landing does not show is refused with the landing that is missing", "[STUDY-100]") {
    const std::vector<Run> all = runs(9);
    const auto rejection = [](const auto& fit) -> std::string {
        try {
            fit();
        } catch (const identification::NotIdentifiable& e) {
            return e.what();
        }
        return "";
    };
    const std::vector<Run> valve_only{all[0], all[1]};
    CHECK_THAT(rejection([&] { (void)identification::fit_wheel(valve_only, "heavy"); }),
               ContainsSubstring("heavy.toml") && ContainsSubstring("touchdown"));
    CHECK_THAT(rejection([&] { (void)identification::fit_friction(valve_only, "snow"); }),
               ContainsSubstring("snow") && ContainsSubstring("load cells"));
    const std::vector<Run> below_peak{all[3]};
    CHECK_THAT(rejection([&] { (void)identification::fit_friction(below_peak, "dry_asphalt"); }), ContainsSubstring("beyond the peak"));
}
