/// The readings behind Burckhardt's coefficients: their errors are as large, and hang together, as the fit takes them to be.
#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "plant_sim/study/identification/friction_fit.hpp"
#include "plant_sim/study/identification/friction_readings.hpp"
#include "plant_sim/study/identification/identified.hpp"
#include "tests/catch.hpp"
#include "tests/identification/experiments.hpp"

using identification::FrictionReadings;
using identification::Motion;
using identification::Run;

namespace {

constexpr double kAge_s = 1e-3;  // the cells are read at the end of a PLC scan, one period before their frame

Run run(const endurance::EnduranceSetup& setup, std::uint64_t seed) {
    return {.recording = identification_test::record(setup, seed),
            .rig = identification_test::known(setup),
            .surface = setup.scenario.choice.surface,
            .friction_class = setup.scenario.choice.maneuver};
}

}  // namespace

TEST_CASE("divided by their expected covariance, errors of friction readings are white and of unit size", "[STUDY-100]") {
    const char* name = GENERATE("slow_braking", "heavy");
    const endurance::EnduranceSetup setup = identification_test::setup(name);
    const rig::Surface& truth = setup.scenario.rig.rig.surface;
    constexpr int kSeeds = 3;
    double square = 0.0;
    double neighbours = 0.0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const auto readings = FrictionReadings::of(run(setup, seed), kAge_s);
        REQUIRE(readings);
        REQUIRE(readings->all().size() > 500);
        const auto n = static_cast<Eigen::Index>(readings->all().size());
        Eigen::VectorXd error(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const auto& r = readings->all()[static_cast<std::size_t>(i)];
            error[i] = r.mu - rig::friction(truth, r.slip).mu;
        }
        const auto v = readings->covariance(truth, setup.machinery.machinery.gauges.force.noise);
        const Eigen::MatrixXd whole = v.own.toDense() + v.common * v.common.transpose();
        Eigen::LLT<Eigen::MatrixXd>(whole).matrixL().solveInPlace(error);
        square += error.squaredNorm() / static_cast<double>(n) / kSeeds;
        neighbours += error.head(n - 1).dot(error.tail(n - 1)) / error.squaredNorm() / kSeeds;
    }
    // Some 2,000 readings: 3 % and 0.02 are one standard deviation.
    CAPTURE(name);
    CHECK(square == Approx(1.0).margin(0.12));
    CHECK(std::abs(neighbours) < 0.08);
}

TEST_CASE("a wheel that locks while its road is identified shows no slip between two edges", "[STUDY-100]") {
    // Far beyond an early peak the reference of the heavy landing cannot be held from the first moment on.
    std::vector<Run> runs;
    for (const char* name : {"slow_braking", "heavy"}) {
        endurance::EnduranceSetup setup = identification_test::setup(name);
        rig::Surface& surface = setup.scenario.rig.rig.surface;
        surface.c2 = 110.0;
        surface.c3 = 0.6;
        runs.push_back(run(setup, 1));
    }
    const auto motion = Motion::of(runs.back(), kAge_s);
    REQUIRE(motion);
    double max_slip = 0.0;
    for (double t = motion->brake_on_s() + 0.02; motion->v_mps(t - 5e-3, t + 5e-3) > FrictionReadings::kSlowest_mps; t += 1e-3)
        max_slip = std::max(max_slip, motion->slip(t - 5e-3, t + 5e-3));
    REQUIRE(max_slip > 0.8);
    const identification::FrictionFit f = identification::fit_friction(runs, runs.front().surface);
    CAPTURE(f.of("c2").value, f.of("c3").value);
    CHECK(std::abs(f.of("c2").value - 110.0) < 4.0 * f.of("c2").deviation);
    CHECK(std::abs(f.of("c3").value - 0.6) < 4.0 * f.of("c3").deviation);
}

TEST_CASE("a road of another shape than eq. (4) is identified as it is", "[STUDY-100]") {
    constexpr std::array<rig::MagicFormula, 4> kRoads{{{.B = 12.0, .C = 1.6, .D = 1.0, .E = 0.0},
                                                       {.B = 9.0, .C = 1.75, .D = 0.7, .E = -0.8},
                                                       {.B = 18.0, .C = 1.4, .D = 0.85, .E = 0.3},
                                                       {.B = 11.0, .C = 1.65, .D = 0.5, .E = 0.6}}};
    for (const rig::MagicFormula& road : kRoads) {
        CAPTURE(road.B, road.C, road.E);
        std::vector<Run> runs;
        for (const char* name : {"slow_braking", "heavy"}) {
            endurance::EnduranceSetup setup = identification_test::setup(name);
            setup.scenario.rig.rig.surface.magic = road;
            runs.push_back(run(setup, 3));
        }
        const identification::FrictionFit f = identification::fit_friction(runs, runs.front().surface);
        REQUIRE(f.curve.magic.has_value());
        CHECK(f.misfit < 1.3);
        for (double slip = 0.005; slip < f.largest_slip; slip += 0.005)
            CHECK(rig::friction(f.curve, slip).mu == Approx(rig::friction(road, slip).mu).epsilon(0.01));
    }
}

TEST_CASE("a road that changed between two stops is said to fit neither curve", "[STUDY-100]") {
    std::vector<Run> runs;
    for (const char* name : {"slow_braking", "heavy"}) {
        endurance::EnduranceSetup setup = identification_test::setup(name);
        setup.scenario.rig.rig.surface.magic = rig::MagicFormula{.B = 12.0, .C = 1.6, .D = runs.empty() ? 1.0 : 0.85, .E = 0.0};
        runs.push_back(run(setup, 3));
    }
    const identification::FrictionFit f = identification::fit_friction(runs, runs.front().surface);
    CHECK(f.misfit > identification::kMaxMisfit);
    identification::Identified found;
    found.surfaces.push_back(f);
    CHECK_THAT(identification::to_table(found), ContainsSubstring("warning: " + f.surface + ": readings are"));
}

TEST_CASE("landings below the peak alone are refused with numbers", "[STUDY-100]") {
    const std::vector<Run> runs{run(identification_test::setup("slow_braking"), 11)};
    CHECK_THROWS_WITH(identification::fit_friction(runs, runs.front().surface), ContainsSubstring("slip is held up to") && !ContainsSubstring("nan"));
}

TEST_CASE("the free radius is as certain as it says", "[STUDY-100]") {
    const endurance::EnduranceSetup setup = identification_test::setup("heavy");
    constexpr int kSeeds = 30;
    double square = 0.0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const auto motion = Motion::of(run(setup, seed), kAge_s);
        REQUIRE(motion);
        const double error = motion->free_radius_m() - setup.scenario.rig.rig.wheel.free_radius_m;
        square += std::pow(error / motion->free_radius_deviation_m(), 2.0) / kSeeds;
    }
    // Chi-square of 30: 0.56 to 1.57 hold 95 %, 0.43 to 1.95 hold 99.8 %.
    CHECK(square > 0.43);
    CHECK(square < 1.95);
}
