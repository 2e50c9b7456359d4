// The slip law term by term, what it must not do at its limits, and when its reference retreats.
#include "firmware/control/slip_law.hpp"

#include <algorithm>
#include <cmath>

#include "tests/catch.hpp"
#include "tests/control/law_vectors.hpp"

using namespace antiskid::control;
using control_test::balanced;
using control_test::fixed_config;
using control_test::kPeriod_s;
using control_test::rate_per_Pa;

namespace {

constexpr float kCeiling_Pa = 20.7e6F;
constexpr float kBalance_Pa = 8e6F;

Estimate at_rest(const float v_mps, const float slip, const float wheel_pole_radps = 0.0F) {
    Estimate e = balanced(v_mps, slip, kBalance_Pa);
    e.wheel_pole_radps = wheel_pole_radps;
    return e;
}

/// A law with its reference at `slip`, its integral at zero.
SlipLaw settled(const SlipConfig& config, const float slip, const float v_mps = 40.0F) {
    SlipLaw law(config, kPeriod_s);
    const Estimate e = at_rest(v_mps, slip);
    law.start(e);
    static_cast<void>(law.pressure_Pa(e, slip, kCeiling_Pa));
    return law;
}

SlipConfig exact_law() {
    SlipConfig c = fixed_config().slip;
    c.low_speed_mps = 0.0F;
    return c;
}

/// The reference after `periods` at a slip and a pole of the wheel.
float run(SlipLaw& law, const float wheel_pole_radps, const float slip, const int periods) {
    const Estimate e = at_rest(40.0F, slip, wheel_pole_radps);
    for (int i = 0; i < periods; ++i) static_cast<void>(law.pressure_Pa(e, 0.2F, kCeiling_Pa));
    return law.reference();
}

}  // namespace

TEST_CASE("in balance at the reference the law asks for the balance", "[CTL-040]") {
    const float v = GENERATE(10.0F, 40.0F, 60.0F);
    SlipLaw law = settled(exact_law(), 0.2F, v);
    for (int i = 0; i < 1000; ++i) REQUIRE(law.pressure_Pa(at_rest(v, 0.2F), 0.2F, kCeiling_Pa) == Approx(kBalance_Pa).epsilon(1e-6));
    CHECK(law.reference() == Approx(0.2));
    CHECK(law.scheduled_reference() == Approx(0.2));
}

TEST_CASE("each term is worth its gain, scheduled with speed", "[CTL-040]") {
    const float v = GENERATE(6.0F, 20.0F, 60.0F);
    SlipLaw law = settled(exact_law(), 0.2F, v);
    Estimate e = at_rest(v, 0.2F);
    const double per_Pa = rate_per_Pa(e);
    const auto asked = [&] {
        SlipLaw copy = law;
        return static_cast<double>(copy.pressure_Pa(e, 0.2F, 1e12F));
    };
    const double base = 8e6;
    SECTION("proportional") {
        e.late_slip = 0.19F;
        CHECK(asked() - base == Approx(100.0 * 0.01 / per_Pa).epsilon(1e-3));
        e.late_slip = 0.21F;
        CHECK(asked() - base == Approx(-100.0 * 0.01 / per_Pa).epsilon(1e-3));
    }
    SECTION("proportional with the wheel's pole, where that is stable") {
        e.late_slip = 0.19F;
        e.wheel_pole_radps = 1000.0F;
        CHECK(asked() - base == Approx(400.0 * 0.01 / per_Pa).epsilon(1e-3));
        e.wheel_pole_radps = -10.0F;
        CHECK(asked() - base == Approx(100.0 * 0.01 / per_Pa).epsilon(1e-3));
    }
    SECTION("derivative: the slip rate that pressure and road torque make") {
        e.late_pressure.pressure_Pa = 9e6F;
        CHECK(asked() - base == Approx(-4.0 * 1e6).epsilon(1e-3));
    }
    SECTION("second derivative") {
        e.late_pressure.rate_Paps = 1e8F;
        CHECK(asked() - base == Approx(-0.005 * 1e8).epsilon(1e-3));
    }
    SECTION("feed-forward of the road torque after the delay, and its share of the derivative") {
        e.late_balance_Pa = 7.5e6F;
        CHECK(asked() == Approx(7.5e6 - 4.0 * 0.5e6).epsilon(1e-4));
        e.late_pressure.pressure_Pa = 7.5e6F;
        CHECK(asked() == Approx(7.5e6).epsilon(1e-4));
    }
    SECTION("integral") {
        e.late_slip = 0.19F;
        for (int i = 0; i < 500; ++i) static_cast<void>(law.pressure_Pa(e, 0.2F, 1e12F));
        e.late_slip = 0.2F;
        CHECK(asked() - base == Approx(200.0 * 0.01 * 0.5 / per_Pa).epsilon(2e-3));
    }
    SECTION("all of them together no more than the largest slip rate") {
        e.late_slip = -0.5F;
        CHECK(asked() - base == Approx(20.0 / per_Pa).epsilon(1e-3));
    }
}

TEST_CASE("a wheel that hardly slips is brought up along the chord of friction, faster the less it slips", "[CTL-040]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    const auto asked = [&](const float slip, const float late_slip, const float road_radps2) {
        SlipLaw copy = law;
        Estimate e = at_rest(40.0F, slip);
        e.late_slip = late_slip;
        e.road_radps2 = road_radps2;
        return (static_cast<double>(copy.pressure_Pa(e, 0.2F, 1e12F)) - 8e6) * rate_per_Pa(e);  // 1/s
    };
    // r tau / (lambda v) = 0.32 * 500 / (0.015 * 40) = 266.67 1/s; half of it at half of the earliest peak. Error 0.01.
    CHECK(asked(0.015F, 0.19F, 500.0F) == Approx((100.0 + 0.5 * 266.667) * 0.01).epsilon(1e-3));
    CHECK(asked(0.03F, 0.19F, 500.0F) == Approx(1.0).epsilon(1e-3));
    CHECK(asked(0.2F, 0.19F, 500.0F) == Approx(1.0).epsilon(1e-3));
    // Slip counts as 0.01 at the least, and a road that pulls back as none.
    CHECK(asked(0.0F, 0.19F, 50.0F) == Approx((100.0 + 0.32 * 50.0 / (0.01 * 40.0)) * 0.01).epsilon(1e-3));
    CHECK(asked(-0.1F, 0.19F, -50.0F) == Approx(1.0).epsilon(1e-3));
    // The largest slip rate, 40 without slip, 20 from the earliest peak on.
    CHECK(asked(0.0F, -0.5F, 5000.0F) == Approx(40.0).epsilon(1e-3));
    CHECK(asked(0.015F, -0.5F, 5000.0F) == Approx(30.0).epsilon(1e-3));
    CHECK(asked(0.03F, -0.5F, 5000.0F) == Approx(20.0).epsilon(1e-3));
    SECTION("an observed pole that is larger counts alone") {
        Estimate e = at_rest(40.0F, 0.015F, 1000.0F);
        e.late_slip = 0.19F;
        e.road_radps2 = 500.0F;
        CHECK((static_cast<double>(law.pressure_Pa(e, 0.2F, 1e12F)) - 8e6) * rate_per_Pa(e) == Approx(400.0 * 0.01).epsilon(1e-3));
    }
}

TEST_CASE("the integral does not wind up at the ceiling", "[CTL-040]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    SlipLaw never = law;
    // The demand holds the pressure at 3 MPa, the wheel hardly slips: for 5 s the law wants more than it may have.
    const Estimate held = balanced(40.0F, 0.03F, 3e6F);
    for (int i = 0; i < 5000; ++i) REQUIRE(law.pressure_Pa(held, 0.2F, 3e6F) == 3e6F);
    const Estimate e = at_rest(40.0F, 0.2F);
    CHECK(law.pressure_Pa(e, 0.2F, kCeiling_Pa) == never.pressure_Pa(e, 0.2F, kCeiling_Pa));
}

TEST_CASE("the integral does not wind up at no pressure", "[CTL-040]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    SlipLaw never = law;
    Estimate skid = balanced(40.0F, 0.9F, 0.5e6F);
    skid.slip = 0.2F;  // that the reference retreats is another matter
    for (int i = 0; i < 5000; ++i) REQUIRE(law.pressure_Pa(skid, 0.2F, kCeiling_Pa) == 0.0F);
    const Estimate e = at_rest(40.0F, 0.2F);
    CHECK(law.pressure_Pa(e, 0.2F, kCeiling_Pa) == never.pressure_Pa(e, 0.2F, kCeiling_Pa));
}

TEST_CASE("at a limit the integral still moves inwards", "[CTL-040]") {
    // Wound up on purpose, then held at the ceiling with the error reversed: it must come back.
    SlipLaw law = settled(exact_law(), 0.2F);
    Estimate e = at_rest(40.0F, 0.19F);
    for (int i = 0; i < 2000; ++i) static_cast<void>(law.pressure_Pa(e, 0.2F, 1e12F));
    e.late_slip = 0.2001F;
    const float wound = law.pressure_Pa(e, 0.2F, 1e12F);
    REQUIRE(wound > kBalance_Pa + 1e4F);
    for (int i = 0; i < 20'000; ++i) static_cast<void>(law.pressure_Pa(e, 0.2F, kBalance_Pa));
    CHECK(law.pressure_Pa(e, 0.2F, 1e12F) < wound - 100.0F);
}

TEST_CASE("the integral goes by the error where that leads away from a limit, and rests where it leads into it", "[CTL-040]") {
    // 1/s, after half a second at that slip.
    const auto after = [](const float late_slip, const float ceiling_Pa, const float rate_Paps = 0.0F) {
        SlipLaw law = settled(exact_law(), 0.2F);
        Estimate e = at_rest(40.0F, 0.2F);
        e.late_slip = late_slip;
        e.late_pressure.rate_Paps = rate_Paps;
        for (int i = 0; i < 500; ++i) static_cast<void>(law.pressure_Pa(e, 0.2F, ceiling_Pa));
        const Estimate there = at_rest(40.0F, 0.2F);
        return (static_cast<double>(law.pressure_Pa(there, 0.2F, 1e12F)) - 8e6) * rate_per_Pa(there);
    };
    const double moved = 200.0 * 0.001 * 0.5;
    CHECK(after(0.199F, kCeiling_Pa) == Approx(moved).epsilon(0.01));
    CHECK(after(0.201F, kCeiling_Pa) == Approx(-moved).epsilon(0.01));
    CHECK(after(0.19F, 5e6F) == Approx(0.0).margin(1e-3));
    CHECK(after(0.201F, 5e6F) == Approx(-moved).epsilon(0.01));
    // The pressure rises so fast that the law asks for none, whatever the slip.
    CHECK(after(0.9F, kCeiling_Pa) == Approx(0.0).margin(1e-3));
    CHECK(after(0.201F, kCeiling_Pa, 1e10F) == Approx(0.0).margin(1e-3));
    CHECK(after(0.199F, kCeiling_Pa, 1e10F) == Approx(moved).epsilon(0.01));
}

TEST_CASE("a change of set-point moves the request at a limited rate", "[CTL-040]") {
    SlipLaw law = settled(exact_law(), 0.1F);
    const Estimate e = at_rest(40.0F, 0.1F);
    float before = law.pressure_Pa(e, 0.1F, kCeiling_Pa);
    // One period of reference rate through the proportional gain, and the little that the integral adds.
    const double max = 100.0 * 50.0 * 1e-3 / rate_per_Pa(e) * 1.02;
    for (const float set_point : {0.24F, 0.05F, 0.5F, 0.0F}) {
        for (int i = 0; i < 20; ++i) {
            const float now = law.pressure_Pa(e, set_point, 1e12F);
            if (now > 0.0F && before > 0.0F) {
                REQUIRE(std::abs(static_cast<double>(now - before)) <= max);
            }
            before = now;
        }
        CHECK(law.reference() == Approx(set_point).margin(1e-6));
    }
}

TEST_CASE("a demand that falls and rises again changes nothing but the ceiling", "[CTL-040]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    SlipLaw undisturbed = law;
    const Estimate e = at_rest(40.0F, 0.2F);
    for (int i = 0; i < 300; ++i) {
        // A triangle from full demand to none and back; the wheel itself is held where it is.
        const float share = std::abs(static_cast<float>(i) - 150.0F) / 150.0F;
        const float ceiling = kCeiling_Pa * share;
        const float given = law.pressure_Pa(e, 0.2F, ceiling);
        REQUIRE(given <= ceiling);
        REQUIRE(given == Approx(std::min(ceiling, kBalance_Pa)).epsilon(1e-6));
    }
    for (int i = 0; i < 300; ++i) static_cast<void>(undisturbed.pressure_Pa(e, 0.2F, kCeiling_Pa));
    CHECK(law.pressure_Pa(e, 0.2F, kCeiling_Pa) == Approx(undisturbed.pressure_Pa(e, 0.2F, kCeiling_Pa)).epsilon(1e-6));
}

TEST_CASE("below the low speed the reference falls with speed", "[CTL-040]") {
    const SlipConfig config = fixed_config().slip;  // 24 m/s, floor 8 m/s, slip 0.14
    const auto in_force = [&config](const float v, const float reference) {
        SlipLaw law = settled(config, reference, v);
        for (int i = 0; i < 100; ++i) static_cast<void>(law.pressure_Pa(at_rest(v, reference), reference, kCeiling_Pa));
        CHECK(law.scheduled_reference() == law.reference());  // that is no retreat
        return law.reference();
    };
    CHECK(in_force(60.0F, 0.24F) == Approx(0.24F));
    CHECK(in_force(24.0F, 0.24F) == Approx(0.24F));
    CHECK(in_force(16.0F, 0.24F) == Approx(0.19F).epsilon(1e-4));
    CHECK(in_force(12.0F, 0.24F) == Approx(0.165F).epsilon(1e-4));
    CHECK(in_force(8.0F, 0.24F) == Approx(0.14F));
    CHECK(in_force(5.0F, 0.24F) == Approx(0.14F));
    // A lower set-point is never raised.
    for (const float v : {60.0F, 16.0F, 5.0F}) CHECK(in_force(v, 0.10F) == Approx(0.10F));
}

TEST_CASE("low_speed_mps = 0 is the paper's exact law at every speed", "[CTL-040]") {
    for (const float v : {60.0F, 16.0F, 5.0F, 0.5F}) {
        SlipLaw law = settled(exact_law(), 0.24F, v);
        for (int i = 0; i < 100; ++i) static_cast<void>(law.pressure_Pa(at_rest(v, 0.24F), 0.24F, kCeiling_Pa));
        CHECK(law.reference() == Approx(0.24F));
    }
}

TEST_CASE("the law takes over at the slip that it finds", "[CTL-040]") {
    SlipLaw law(exact_law(), kPeriod_s);
    law.start(at_rest(40.0F, 0.35F));
    CHECK(law.reference() == 0.35F);
    law.start(at_rest(40.0F, -0.2F));
    CHECK(law.reference() == 0.0F);
    CHECK(law.scheduled_reference() == 0.0F);
    law.start(at_rest(40.0F, 0.05F));
    static_cast<void>(law.pressure_Pa(at_rest(40.0F, 0.05F), 0.24F, kCeiling_Pa));
    CHECK(law.reference() == Approx(0.05 + 50.0 * 1e-3));
}

TEST_CASE("a law that starts again is as one that starts for the first time", "[CTL-040]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    SlipLaw fresh(exact_law(), kPeriod_s);
    // Its integral wound up, and a road that restored: the share of the reference stays whole.
    Estimate e = at_rest(40.0F, 0.2F, 500.0F);
    e.late_slip = 0.195F;
    for (int i = 0; i < 500; ++i) static_cast<void>(law.pressure_Pa(e, 0.2F, 1e12F));
    REQUIRE(law.pressure_Pa(at_rest(40.0F, 0.2F), 0.2F, 1e12F) > kBalance_Pa + 5e4F);
    law.start(at_rest(40.0F, 0.05F));
    fresh.start(at_rest(40.0F, 0.05F));
    CHECK(law.scheduled_reference() == 0.05F);
    for (int i = 0; i < 300; ++i) {
        const Estimate runs_away = at_rest(40.0F, 0.2F, -40.0F);
        REQUIRE(law.pressure_Pa(runs_away, 0.2F, 1e12F) == fresh.pressure_Pa(runs_away, 0.2F, 1e12F));
        REQUIRE(law.reference() == fresh.reference());
        REQUIRE(law.scheduled_reference() == fresh.scheduled_reference());
    }
    CHECK(law.reference() < 0.199F);
}

TEST_CASE("the filtered pole starts at that of the wheel which the law finds", "[CTL-040]") {
    SlipLaw law(exact_law(), kPeriod_s);
    law.start(at_rest(40.0F, 0.2F, -60.0F));
    // 45 1/s faster than is held, from the first period on.
    CHECK(run(law, -60.0F, 0.2F, 100) == Approx(0.2 * (1.0 - 0.2 * 45.0 / 30.0 * 0.1)).epsilon(1e-4));
}

TEST_CASE("the reference retreats while the wheel runs away, and comes back", "[CTL-040]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    CHECK(run(law, -14.0F, 0.2F, 1000) == Approx(0.2));  // held
    // 20 1/s faster than is held: 0.2 * 20 / 30 of the reference a second, once the filter is there.
    const float before = run(law, -35.0F, 0.2F, 300);
    CHECK(before - run(law, -35.0F, 0.2F, 1000) == Approx(0.2 * 0.2 * 20.0 / 30.0).epsilon(0.02));
    CHECK(law.scheduled_reference() == Approx(0.2));
    // Never faster than its rates, and never to nothing.
    const float at = run(law, -60.0F, 0.2F, 300);
    CHECK(at - run(law, -60.0F, 0.2F, 100) <= 1.0F * 0.2F * 0.1F + 1e-4F);
    CHECK(run(law, -60.0F, 0.2F, 10'000) == Approx(0.2 * 0.03 / 0.5));
    const float low = run(law, 500.0F, 0.05F, 200);
    CHECK(run(law, 500.0F, 0.05F, 1000) - low == Approx(0.2 * 0.2).epsilon(0.01));
    CHECK(run(law, 500.0F, 0.05F, 10'000) == Approx(0.2));
}

TEST_CASE("a slip that stays at its reference is held, whatever the pole seems to be", "[CTL-040]") {
    SlipConfig c = exact_law();
    c.max_held_slip_error = 0.01F;
    SlipLaw law = settled(c, 0.2F);
    CHECK(run(law, -60.0F, 0.2F, 2000) == Approx(0.2));
    CHECK(run(law, -60.0F, 0.2095F, 2000) == Approx(0.2));  // on either side
    CHECK(run(law, -60.0F, 0.1905F, 2000) == Approx(0.2));
    CHECK(run(law, -60.0F, 0.2105F, 2000) < 0.15F);
    // The way back asks for no rest.
    CHECK(run(law, 500.0F, 0.05F, 10'000) == Approx(0.2));
    // Down to a slip below it the reference follows no further than to where that is at rest.
    CHECK(run(law, -60.0F, 0.15F, 5000) == Approx(0.16).margin(2e-3));
}

TEST_CASE(
    "slip beyond 0.05 above the reference in force takes it back in proportion, whatever the pole seems to "
    "be",
    "[CTL-040]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    CHECK(run(law, 500.0F, 0.25F, 1000) == Approx(0.2));
    CHECK(run(law, 500.0F, 0.35F, 1) == Approx(0.2 * (1.0 - (10.0 * 0.1 - 0.2) * 1e-3)).epsilon(1e-5));
    // The reference falls away from the slip, so ever faster: with x = slip - 0.05 - 0.2 share, x' = 0.2 (10 x - 0.2).
    SlipLaw locking = settled(exact_law(), 0.2F);
    CHECK(run(locking, 500.0F, 0.65F, 100) == Approx(0.6 - (0.02 + (0.4 - 0.02) * std::exp(2.0 * 0.1))).epsilon(0.01));
    CHECK(locking.scheduled_reference() == Approx(0.2));
}

TEST_CASE("no reference retreats to less than the share that takes the largest one to the earliest peak of friction", "[CTL-040]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    CHECK(run(law, 500.0F, 0.9F, 1000) == Approx(0.2 * 0.03 / 0.5));
    SlipLaw follows = settled(exact_law(), 0.1F);
    for (int i = 0; i < 1000; ++i) static_cast<void>(follows.follow_Pa(at_rest(40.0F, 0.9F), 0.1F, kCeiling_Pa));
    CHECK(follows.reference() == Approx(0.1 * 0.03 / 0.5));
}

TEST_CASE("slip that swings about the reference is not paid back by what lies below it", "[CTL-040]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    for (int swing = 0; swing < 50; ++swing) {
        static_cast<void>(run(law, 500.0F, 0.5F, 5));
        static_cast<void>(run(law, 500.0F, 0.0F, 15));
    }
    CHECK(law.reference() < 0.1F);
}

TEST_CASE("a reference that has retreated stays so when the law starts again, until the runway is forgotten", "[CTL-040]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    const float retreated = run(law, 0.0F, 0.61F, 100);
    REQUIRE(retreated < 0.15F);
    law.start(at_rest(40.0F, 0.2F));
    CHECK(run(law, 0.0F, 0.2F, 10) == Approx(retreated).margin(1e-3));
    law.start(at_rest(40.0F, 0.0F));
    law.forget_runway();
    CHECK(run(law, 0.0F, 0.05F, 10) == Approx(0.2));
}

TEST_CASE("a reference that somebody else has found falls at low speed, and retreats from slip above it alone", "[CTL-340]") {
    const SlipConfig config = fixed_config().slip;
    SlipLaw law(config, kPeriod_s);
    Estimate e = at_rest(40.0F, 0.245F, -40.0F);
    law.start(e);
    for (int i = 0; i < 2000; ++i) static_cast<void>(law.follow_Pa(e, 0.2F, kCeiling_Pa));
    CHECK(law.reference() == 0.2F);
    CHECK(law.scheduled_reference() == 0.2F);
    SlipLaw retreats(config, kPeriod_s);
    retreats.start(e);
    CHECK(run(retreats, -40.0F, 0.245F, 2000) < 0.15F);
    e.slip = 0.35F;
    static_cast<void>(law.follow_Pa(e, 0.2F, kCeiling_Pa));
    CHECK(law.reference() == Approx(0.2 * (1.0 - (10.0 * 0.1 - 0.2) * 1e-3)).epsilon(1e-5));
    e.slip = 0.2F;
    for (int i = 0; i < 200; ++i) static_cast<void>(law.follow_Pa(e, 0.2F, kCeiling_Pa));
    CHECK(law.reference() == 0.2F);
    e.late_v_mps = 12.0F;
    for (int i = 0; i < 2000; ++i) static_cast<void>(law.follow_Pa(e, 0.2F, kCeiling_Pa));
    CHECK(law.reference() == falling_reference(config, 0.2F, 12.0F));
    CHECK(law.reference() < 0.2F);
}
