/// The served rig's brake wears by the model, from touchdown to lift-off.
#include "tests/catch.hpp"
#include "tests/plc/operator.hpp"

namespace {

using plc::Bench;
using plc_test::maneuver;
using plc_test::Operator;

Operator worn(Bench bench, const wear::BrakeState& state, std::uint64_t seed = 5) {
    plc::ServedRigOptions options = plc::load_served_rig("config", bench);
    options.brake.emplace(plc_test::loaded(bench).wear, wear::ConditionalRule{}, state);
    return {bench, options, seed};
}

}  // namespace

TEST_CASE("friction of each maneuver is the model's at the energy taken so far; lift-off ends it", "[RIG-300]") {
    const auto bench = GENERATE(Bench::landing, Bench::endurance);
    Operator op = worn(bench, {.seed = 5, .maneuvers = 7, .c_e_J = 50e6});
    wear::BrakeState expected = op.rig.brake()->state();
    double energy_J = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double friction = op.rig.brake()->next_friction();
        REQUIRE(maneuver(op, 30.0, 16.0));
        CHECK(op.rig.mean_friction() == friction);
        const double now_J = op.rig.rig().wheel().energy_brake_J;
        CHECK(now_J > energy_J);
        // Before lift-off, plus the little that the discs took after it.
        const wear::BrakeState& state = op.rig.brake()->state();
        CHECK(state.maneuvers == ++expected.maneuvers);
        CHECK(state.c_e_J == Approx(50e6 + now_J).epsilon(1e-9));
        CHECK(op.rig.cumulative_energy_J() == Approx(50e6 + now_J).epsilon(1e-12));
        energy_J = now_J;
    }
}

TEST_CASE("a brake that is taken up again meets the friction of one that never was put down", "[RIG-300]") {
    Operator whole = worn(Bench::endurance, {.seed = 5});
    REQUIRE(maneuver(whole, 30.0, 18.0));
    const wear::BrakeState kept = whole.rig.brake()->state();
    REQUIRE(maneuver(whole, 30.0, 18.0));
    Operator resumed = worn(Bench::endurance, kept, 77);
    REQUIRE(maneuver(resumed, 30.0, 18.0));
    CHECK(resumed.rig.mean_friction() == whole.rig.mean_friction());
    Operator taken_up = worn(Bench::endurance, {.seed = 5});
    REQUIRE(maneuver(taken_up, 20.0, 18.0));
    taken_up.rig.set_brake_state(kept);
    CHECK(taken_up.rig.cumulative_energy_J() == kept.c_e_J);
    REQUIRE(maneuver(taken_up, 30.0, 18.0));
    CHECK(taken_up.rig.mean_friction() == whole.rig.mean_friction());
    Operator other = worn(Bench::endurance, {.seed = 6, .maneuvers = kept.maneuvers, .c_e_J = kept.c_e_J});
    REQUIRE(maneuver(other, 30.0, 18.0));
    CHECK(other.rig.mean_friction() != whole.rig.mean_friction());
}

TEST_CASE("a brake worn beyond all use keeps a friction curve above zero, and no rig fails over it", "[RIG-300]") {
    Operator op = worn(Bench::endurance, {.seed = 5, .maneuvers = 0, .c_e_J = 1e12});
    REQUIRE(op.rig.brake()->next_friction() == wear::kMinFriction);
    op.wish({.drive = true, .speed_mps = 10.0});
    REQUIRE(op.until([&op] { return op.v() > 9.9; }, 60.0));
    op.wish({.advance = true, .load = true});
    REQUIRE(op.until([&op] { return op.rig.wheel_on_rim(); }, 10.0));
    const rig::FrictionCurve& curve = op.plant.rig.friction_curve;
    CHECK(op.rig.mean_friction() == rig::min_mean_friction(curve));
    CHECK(rig::min_friction(curve, op.rig.mean_friction()) == Approx(0.01).margin(1e-12));
}

TEST_CASE("a rig without a wearing brake keeps the friction that it was given", "[RIG-300]") {
    Operator op(Bench::endurance);
    REQUIRE(maneuver(op, 30.0, 18.0));
    CHECK(op.rig.mean_friction() == 0.30);
    CHECK_THROWS_AS(op.rig.set_brake_state({}), std::invalid_argument);
}
