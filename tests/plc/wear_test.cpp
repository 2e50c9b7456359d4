#include "plant_sim/wear/stand_in_law.hpp"

#include "tests/catch.hpp"
#include "tests/plc/operator.hpp"

namespace {

constexpr wear::StandInParameters kLaw{.friction = 0.25,
                                       .bedding_in = 0.05,
                                       .bedding_in_J = 30e6,
                                       .slow_loss = 0.03,
                                       .wear_out = 0.05,
                                       .wear_out_J = 25e6,
                                       .life_J = 488e6,
                                       .deviation = 0.003,
                                       .least = 0.14};

}  // namespace

TEST_CASE("the stand-in for wear falls fast, then slowly, then wears out", "[RIG-250]") {
    const wear::StandInLaw law(kLaw);
    const auto mean = [&law](double E) { return law.mean_friction(E, 0.0); };
    CHECK(mean(0.0) == Approx(0.30).margin(1e-6));
    CHECK(mean(488e6) == Approx(0.17).margin(1e-6));
    const auto slope = [&mean](double E) { return (mean(E + 1e6) - mean(E)) / 1e6; };
    for (double E = 0.0; E < 488e6; E += 5e6) CHECK(slope(E) < 0.0);
    CHECK(slope(0.0) < 5.0 * slope(200e6));
    CHECK(slope(480e6) < 5.0 * slope(200e6));
    CHECK(mean(600e6) == 0.14);
    CHECK(law.mean_friction(100e6, 2.0) - mean(100e6) == Approx(0.006));
    CHECK(law.mean_friction(480e6, -100.0) == 0.14);
}

TEST_CASE(
    "scatter follows from seed and energy: a resumed campaign gets the friction that an unbroken one gets",
    "[RIG-251]") {
    using plc::Bench;
    using plc_test::Operator;
    plc::ServedRigOptions options = plc::load_served_rig("config", Bench::endurance);
    REQUIRE(options.friction);
    Operator unbroken(Bench::endurance, options, 5);
    REQUIRE(plc_test::maneuver(unbroken, 30.0, 18.0));
    const double first = unbroken.rig.mean_friction();
    options.taken_J = unbroken.rig.cumulative_energy_J();
    REQUIRE(plc_test::maneuver(unbroken, 30.0, 18.0));
    const double second = unbroken.rig.mean_friction();
    CHECK(first != second);
    Operator resumed(Bench::endurance, options, 5);
    REQUIRE(plc_test::maneuver(resumed, 30.0, 18.0));
    CHECK(resumed.rig.mean_friction() == second);
    Operator other(Bench::endurance, options, 6);
    REQUIRE(plc_test::maneuver(other, 30.0, 18.0));
    CHECK(other.rig.mean_friction() != second);
}

TEST_CASE("the campaign's scatter has the given deviation", "[RIG-251]") {
    plc::ServedRigOptions options = plc::load_served_rig("config", plc::Bench::endurance);
    std::vector<double> draws;
    options.friction = [&draws](double, double draw) {
        draws.push_back(draw);
        return 0.3;
    };
    // One touchdown at rest each, from another energy.
    for (int i = 0; i < 400; ++i) {
        options.taken_J = 0.975e6 * i;
        plc_test::Operator op(plc::Bench::endurance, options, 9);
        op.wish({.advance = true});
        REQUIRE(op.until([&op] { return op.rig.wheel_on_rim(); }, 5.0));
    }
    double sum = 0.0;
    double squares = 0.0;
    for (const double d : draws) {
        sum += d;
        squares += d * d;
    }
    CHECK(sum / 400.0 == Approx(0.0).margin(0.2));
    CHECK(std::sqrt(squares / 400.0) == Approx(1.0).epsilon(0.15));
}
